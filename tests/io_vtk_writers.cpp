// What VTK's own readers find in the files of the VTK writers.
#include <vtkBase64OutputStream.h>
#include <vtkCellArray.h>
#include <vtkDataSetAttributes.h>
#include <vtkFieldData.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>
#include <vtkXMLImageDataReader.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLPolyDataWriter.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <sstream>
#include <vector>

#include "base/error.h"
#include "catch.h"
#include "frame_maker.h"
#include "fresh_folder.h"
#include "small_disk.h"
#include "vtk_io/base64_stream.h"
#include "vtk_io/pvd.h"
#include "vtk_io/writers.h"
#include "vtk_read.h"

using namespace frana;
using Catch::Matchers::Contains;
namespace fs = std::filesystem;

namespace {

/// Bit for bit what a conversion to the array's own type gives; counts differences instead of one check a
/// value.
Index differences(const Field& field, vtkDataArray* array) {
    Index count = 0;
    for (Index k = 0; k < field.count * field.components; ++k) {
        const double found = array->GetComponent(k / field.components, static_cast<int>(k % field.components));
        const double wanted =
            array->GetDataType() == VTK_FLOAT ? static_cast<double>(static_cast<float>(field.data[k])) : field.data[k];
        count += std::memcmp(&found, &wanted, sizeof found) != 0;
    }
    read_back.array(field.count * field.components);
    return count;
}

std::string unit_of(vtkDataSet* data, const std::string& name) {
    auto* text = vtkStringArray::SafeDownCast(data->GetFieldData()->GetAbstractArray((name + "_unit").c_str()));
    return text && text->GetNumberOfValues() == 1 ? std::string(text->GetValue(0)) : "(none)";
}

void check_same(const Field& field, vtkDataSet* data) {
    CAPTURE(field.name);
    vtkDataArray* array = data->GetPointData()->GetArray(field.name.c_str());
    REQUIRE(array);
    REQUIRE(array->GetNumberOfTuples() == field.count);
    REQUIRE(array->GetNumberOfComponents() == field.components);
    CHECK(differences(field, array) == 0);
    CHECK(unit_of(data, field.name) == field.unit);
}

void check_particles(const Frame& frame, const fs::path& file) {
    const auto reader = read<vtkXMLPolyDataReader>(file);
    vtkPolyData* cloud = reader->GetOutput();
    const Field& position = *frame.particle("position");
    REQUIRE(cloud->GetNumberOfPoints() == position.count);
    REQUIRE(cloud->GetNumberOfVerts() == position.count);
    REQUIRE(cloud->GetNumberOfCells() == position.count);
    REQUIRE(cloud->GetFieldData()->GetArray("TimeValue"));
    CHECK(cloud->GetFieldData()->GetArray("TimeValue")->GetComponent(0, 0) == frame.status.time);
    CHECK(unit_of(cloud, "position") == "m");
    if (position.count == 0) return;
    CHECK(cloud->GetPoints()->GetDataType() == VTK_DOUBLE);
    CHECK(differences(position, cloud->GetPoints()->GetData()) == 0);
    vtkIdType wrong = 0;
    for (vtkIdType c = 0; c < cloud->GetNumberOfCells(); ++c)
        wrong += cloud->GetCellType(c) != VTK_VERTEX || cloud->GetCell(c)->GetPointId(0) != c;
    CHECK(wrong == 0);
    CHECK(cloud->GetPointData()->GetNumberOfArrays() == static_cast<int>(frame.particles.size()) - 1);
    for (const Field& field : frame.particles)
        if (&field != &position) check_same(field, cloud);
}

void check_image(const GridGeometry& grid, vtkImageData* image) {
    int dimensions[3];
    image->GetDimensions(dimensions);
    CHECK(dimensions[0] == grid.nx);
    CHECK(dimensions[1] == grid.ny);
    CHECK(dimensions[2] == 1);
    // The header is decimal text: 1e-9 m is the last digit that double keeps of 6e6 m.
    CHECK(image->GetOrigin()[0] == Approx(grid.x0).margin(2e-9).epsilon(0));
    CHECK(image->GetOrigin()[1] == Approx(grid.y0).margin(2e-9).epsilon(0));
    CHECK(image->GetOrigin()[2] == 0.0);
    CHECK(image->GetSpacing()[0] == Approx(grid.cell).epsilon(1e-15));
    CHECK(image->GetSpacing()[1] == Approx(grid.cell).epsilon(1e-15));
}

void check_grid(const Frame& frame, const fs::path& file) {
    const auto reader = read<vtkXMLImageDataReader>(file);
    vtkImageData* image = reader->GetOutput();
    check_image(frame.grid, image);
    CHECK(image->GetFieldData()->GetArray("TimeValue")->GetComponent(0, 0) == frame.status.time);
    CHECK(image->GetPointData()->GetNumberOfArrays() == static_cast<int>(frame.nodes.size()));
    for (const Field& field : frame.nodes) check_same(field, image);
}

/// The .pvd can be parsed, and every file it names exists and can be read.
std::vector<PvdEntry> check_series(const fs::path& pvd) {
    const auto entries = read_pvd(pvd);
    for (const PvdEntry& entry : entries) {
        CAPTURE(entry.file);
        CHECK(fs::exists(pvd.parent_path() / entry.file));
    }
    return entries;
}

}  // namespace

TEST_CASE("VTK reads the particles back bit for bit", "[io][vtk]") {
    const FreshFolder run;
    const auto writer = make_particle_writer(run.path());
    for (const Index count : {Index{0}, Index{1}, Index{2}, Index{4097}}) {
        FrameMaker maker(count, 0.1 * static_cast<double>(count), count, FrameMaker::utm(40, 30));
        if (count > 1) {
            maker.particle_numbers("depth")[0] = 1e-42;  // a denormal of float32
            maker.particle_numbers("depth")[1] = -0.0;
            maker.particle_numbers("mass")[0] = 5e-324;  // the smallest double
            maker.particle_numbers("mass")[1] = 1e300;
            maker.particle_numbers("stress")[2] = -3.4e38;
        }
        writer->observe(maker.frame);
        CAPTURE(count);
        check_particles(maker.frame, run.path() / check_series(run.path() / "particles.pvd").back().file);
    }
}

TEST_CASE("Particle arrays have the number types that the contract names", "[io][vtk]") {
    const FreshFolder run;
    FrameMaker maker(0, 0.0, 5, FrameMaker::utm(3, 3));
    make_particle_writer(run.path())->observe(maker.frame);
    const auto reader = read<vtkXMLPolyDataReader>(run.path() / "particles/particles_000000.vtp");
    vtkPointData* arrays = reader->GetOutput()->GetPointData();
    CHECK(arrays->GetArray("depth")->GetDataType() == VTK_FLOAT);
    CHECK(arrays->GetArray("mass")->GetDataType() == VTK_DOUBLE);
    CHECK(arrays->GetArray("volume")->GetDataType() == VTK_DOUBLE);
    CHECK(arrays->GetArray("id")->GetDataTypeSize() == 8);
    CHECK(arrays->GetArray("id")->GetDataType() != VTK_DOUBLE);
    CHECK(arrays->GetArray("stress")->GetComponentName(2) == std::string("xy"));
}

TEST_CASE("VTK reads the grid back bit for bit, whatever its shape", "[io][vtk]") {
    const FreshFolder run;
    const auto writer = make_grid_writer(run.path());
    Index number = 0;
    const std::vector<std::pair<Index, Index>> shapes{{1, 1}, {1, 7}, {9, 1}, {2, 2}, {133, 71}};
    for (const auto& [nx, ny] : shapes) {
        FrameMaker maker(number, 0.5 * static_cast<double>(number), 0, FrameMaker::utm(nx, ny));
        maker.node_numbers("depth")[0] = 1e-40;
        writer->observe(maker.frame);
        CAPTURE(nx, ny);
        check_grid(maker.frame, run.path() / check_series(run.path() / "grid.pvd").back().file);
        ++number;
    }
}

TEST_CASE("Nodes without terrain are hidden and leave no NaN in the grid file", "[io][vtk]") {
    const FreshFolder run;
    FrameMaker maker(0, 0.0, 0, FrameMaker::utm(20, 10));
    const double lowest =
        *std::min_element(maker.node_numbers("elevation").begin(), maker.node_numbers("elevation").end());
    maker.cut_corner();
    make_grid_writer(run.path())->observe(maker.frame);
    const auto reader = read<vtkXMLImageDataReader>(run.path() / "grid/grid_000000.vti");
    vtkPointData* arrays = reader->GetOutput()->GetPointData();
    vtkDataArray* ghosts = arrays->GetArray(vtkDataSetAttributes::GhostArrayName());
    vtkDataArray* elevation = arrays->GetArray("elevation");
    REQUIRE(ghosts);
    Index hidden = 0;
    for (Index k = 0; k < 200; ++k) {
        const bool outside = k % 20 >= 10 && k / 20 >= 5;
        hidden += ghosts->GetComponent(k, 0) == vtkDataSetAttributes::HIDDENPOINT;
        CHECK((ghosts->GetComponent(k, 0) != 0.0) == outside);
        CHECK((arrays->GetArray("outside")->GetComponent(k, 0) == 1.0) == outside);
        CHECK(std::isfinite(elevation->GetComponent(k, 0)));
    }
    CHECK(hidden == 50);
    CHECK(elevation->GetRange()[0] >= static_cast<float>(lowest));
}

TEST_CASE("A NaN inside the terrain stops the grid writer and leaves no file", "[io][vtk]") {
    const FreshFolder run;
    FrameMaker maker(0, 0.0, 3, FrameMaker::utm(4, 4));
    maker.node_numbers("depth")[5] = std::numeric_limits<double>::quiet_NaN();
    CHECK_THROWS_WITH(make_grid_writer(run.path())->observe(maker.frame), Contains("depth of item 5 is nan"));
    CHECK_FALSE(fs::exists(run.path() / "grid.pvd"));
    maker.particle_numbers("depth")[1] = 1e39;  // finite, yet more than float32 can hold
    CHECK_THROWS_AS(make_particle_writer(run.path())->observe(maker.frame), NumericsError);
    CHECK_FALSE(fs::exists(run.path() / "particles.pvd"));
}

TEST_CASE("After every frame the series name only files that exist, with exact times", "[io][vtk]") {
    const FreshFolder run;
    const auto particles = make_particle_writer(run.path());
    const auto grid = make_grid_writer(run.path());
    std::vector<double> times;
    for (Index number = 0; number < 12; ++number) {
        times.push_back(static_cast<double>(number) / 3.0);  // no short decimal text stands for these
        FrameMaker maker(number, times.back(), 10, FrameMaker::utm(8, 6));
        particles->observe(maker.frame);
        grid->observe(maker.frame);
        for (const char* name : {"particles.pvd", "grid.pvd"}) {
            const auto entries = check_series(run.path() / name);
            REQUIRE(entries.size() == times.size());
            for (std::size_t k = 0; k < times.size(); ++k) CHECK(entries[k].time == times[k]);
        }
    }
    Index strangers = 0;
    for (const auto& file : fs::recursive_directory_iterator(run.path()))
        strangers += file.path().filename().string().find("tmp") != std::string::npos;
    CHECK(strangers == 0);
}

TEST_CASE("A frame number seen twice replaces its file and its line", "[io][vtk]") {
    const FreshFolder run;
    const auto writer = make_grid_writer(run.path());
    FrameMaker first(0, 1.0, 0, FrameMaker::utm(5, 5)), second(0, 2.0, 0, FrameMaker::utm(6, 5));
    writer->observe(first.frame);
    writer->observe(second.frame);
    const auto entries = check_series(run.path() / "grid.pvd");
    REQUIRE(entries.size() == 1);
    CHECK(entries[0].time == 2.0);
    check_grid(second.frame, run.path() / entries[0].file);
}

TEST_CASE("A full disk is an error with path and reason, and the files before it stay good", "[io][vtk]") {
    const FreshFolder run;
    const auto particles = make_particle_writer(run.path());
    const auto grid = make_grid_writer(run.path());
    FrameMaker maker(0, 0.0, 20000, FrameMaker::utm(150, 150));
    particles->observe(maker.frame);
    grid->observe(maker.frame);
    maker.frame.number = 1;
    {
        const SmallDisk disk(20000);
        CHECK_THROWS_AS(particles->observe(maker.frame), UserError);
        CHECK_THROWS_WITH(grid->observe(maker.frame), Contains("grid_000001.vti") && Contains("cannot be written"));
    }
    CHECK(check_series(run.path() / "particles.pvd").size() == 1);
    CHECK(check_series(run.path() / "grid.pvd").size() == 1);
    CHECK_FALSE(fs::exists(run.path() / "grid/grid_000001.vti"));
    check_grid(maker.frame, run.path() / "grid/grid_000000.vti");
}

TEST_CASE("A folder that cannot be made is an error with path and reason", "[io][vtk]") {
    const FreshFolder run;
    std::ofstream(run.path() / "grid") << "a file where a folder should be";
    FrameMaker maker(0, 0.0, 1, FrameMaker::utm(3, 3));
    CHECK_THROWS_WITH(make_grid_writer(run.path())->observe(maker.frame),
                      Contains((run.path() / "grid").string()) && Contains("cannot be made"));
    CHECK_THROWS_WITH(make_particle_writer(run.path() / "no" / std::string(300, 'x'))->observe(maker.frame),
                      Contains("File name too long"));
}

TEST_CASE("Our base64 has the letters of VTK's, whatever the pieces that it comes in", "[io][vtk]") {
    std::vector<unsigned char> bytes(1000);
    for (std::size_t k = 0; k < bytes.size(); ++k) bytes[k] = static_cast<unsigned char>(k * k * 31 + 7 * k);
    const auto letters = [&](vtkOutputStream* stream, std::size_t length, std::size_t piece) {
        std::ostringstream text;
        stream->SetStream(&text);
        stream->StartWriting();
        for (std::size_t at = 0; at < length; at += piece)
            stream->Write(bytes.data() + at, std::min(piece, length - at));
        stream->EndWriting();
        return text.str();
    };
    vtkNew<vtkBase64OutputStream> theirs;
    vtkNew<Base64Stream> ours;
    for (const std::size_t length : {0, 1, 2, 3, 4, 5, 6, 7, 999, 1000})
        for (const std::size_t piece : {1, 2, 3, 4, 5, 7, 64, 1000}) {
            CAPTURE(length, piece);
            CHECK(letters(ours, length, piece) == letters(theirs, length, piece));
        }
}

TEST_CASE("A file in our base64 is the file that VTK alone writes", "[io][vtk]") {
    const FreshFolder run;
    FrameMaker maker(0, 1.5, 40000, FrameMaker::utm(40, 30));
    make_particle_writer(run.path())->observe(maker.frame);
    const fs::path file = run.path() / "particles/particles_000000.vtp";
    const auto reader = read<vtkXMLPolyDataReader>(file);
    vtkNew<vtkXMLPolyDataWriter> theirs;
    vtkNew<WithBase64Stream<vtkXMLPolyDataWriter>> ours;
    std::vector<std::string> texts;
    for (vtkXMLPolyDataWriter* writer : {theirs.Get(), static_cast<vtkXMLPolyDataWriter*>(ours.Get())}) {
        writer->SetInputDataObject(reader->GetOutput());
        writer->WriteToOutputStringOn();
        writer->SetDataModeToBinary();
        REQUIRE(writer->Write() == 1);
        texts.push_back(writer->GetOutputString());
    }
    CHECK(texts[0].size() > 1000000);
    CHECK((texts[0] == texts[1]));  // without a megabyte in the message
}
