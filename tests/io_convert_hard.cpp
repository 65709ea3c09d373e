// `frana convert` where it is less easy: uneven terrain, runs that are being written, numbers that are none.
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkXMLPolyDataWriter.h>
#include <atomic>

#include <cmath>
#include <limits>
#include <thread>

#include "catch.h"
#include "convert_run.h"
#include "read_polydata.h"

namespace fs = std::filesystem;
using Catch::Contains;
using namespace convert_run;

namespace {

Numbers vtk_numbers(const fs::path& file, const char* name) {
    const auto cloud = test::polydata(file);
    vtkDataArray* const array = cloud->GetPointData()->GetArray(name);
    REQUIRE(array);
    Numbers numbers;
    for (vtkIdType k = 0; k < array->GetNumberOfTuples(); ++k)
        for (int c = 0; c < array->GetNumberOfComponents(); ++c) numbers.push_back(array->GetComponent(k, c));
    return numbers;
}

}  // namespace

TEST_CASE("On uneven terrain points climb as the run says that its particles do, from VTK files and from run.h5",
          "[convert]") {
    const FreshFolder folder;
    const std::string run =
        std::string("run ") + FRANA_SOURCE_DIR "/cases/maungawhau/case.toml --quiet --until 4 " +
        "--out out --set grid.cell=10 --set output.every=2 --set 'output.formats=[\"vtk\",\"xdmf\"]'";
    REQUIRE(call_frana(folder.path(), run).code == 0);
    REQUIRE(call_frana(folder.path(), "convert out --time 4 --spacing 1000 --out vtk.h5").code == 0);
    fs::remove(folder.path() / "out/particles.pvd");
    REQUIRE(call_frana(folder.path(), "convert out --time 4 --spacing 1000 --out xdmf.h5").code == 0);
    const Numbers of_run = vtk_numbers(folder.path() / "out/particles/particles_000002.vtp", "velocity");
    double fastest = 0.0, steepest = 0.0;
    for (std::size_t k = 0; k < of_run.size(); ++k) fastest = std::max(fastest, std::abs(of_run[k]));
    for (std::size_t k = 2; k < of_run.size(); k += 3) steepest = std::max(steepest, std::abs(of_run[k]));
    REQUIRE(steepest > 0.1 * fastest);
    for (const char* name : {"vtk.h5", "xdmf.h5"}) {
        const Numbers of_points = hdf5_numbers(folder.path() / name, "velocity");
        REQUIRE(of_points.size() == of_run.size());  // one layer each
        double worst = 0.0;
        for (std::size_t k = 0; k < of_run.size(); ++k) worst = std::max(worst, std::abs(of_points[k] - of_run[k]));
        CHECK(worst <= 4.0 * std::numeric_limits<double>::epsilon() * fastest);  // a slope and back
    }
}

TEST_CASE("A run that is being written can be converted all the while", "[convert]") {
    const FreshFolder folder;
    const PlaneCase scene;
    scene.write("[output]\nevery = 0.01\nformats = [\"xdmf\"]\n");
    Outcome run;
    std::atomic<bool> done{false};
    std::thread writer([&] {
        run = scene.frana("run CASE --out out --quiet --threads 1 --set time.end=2");
        done = true;
    });
    int converted = 0;
    while (converted < 12 && !done) {  // however long a loaded machine takes to begin
        if (!fs::exists(scene.folder() / "out/run.xdmf")) {
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
            continue;
        }
        const Outcome outcome = call_frana(
            folder.path(), "convert " + (scene.folder() / "out").string() + " --time 0.1 --spacing 1 --out a.csv");
        // Until the frame at 0.1 s is there, its time is past the last one.
        if (outcome.err.find("is past the last frame") != std::string::npos) continue;
        CAPTURE(converted, outcome.err);
        CHECK(outcome.code == 0);
        ++converted;
    }
    writer.join();
    CHECK(run.code == 0);
    CHECK(converted > 0);
}

TEST_CASE("A frame with a number that is none is refused by name", "[convert]") {
    const fs::path copy = finished_run().folder() / "not_a_number";
    fs::copy(finished_run().folder() / "out", copy, fs::copy_options::recursive);
    const fs::path frame = copy / "particles/particles_000002.vtp";
    const auto cloud = test::polydata(frame);
    cloud->GetPointData()->GetArray("depth")->SetComponent(3, 0, std::numeric_limits<double>::quiet_NaN());
    vtkNew<vtkXMLPolyDataWriter> writer;
    writer->SetFileName(frame.string().c_str());
    writer->SetInputData(cloud);
    REQUIRE(writer->Write() == 1);
    CHECK_THAT(refused("not_a_number --time 1 --spacing 1 --out n.csv").err,
               Contains("particles.pvd: depth of particle ") && Contains(" is nan; expected a finite number"));
    CHECK_FALSE(fs::exists(finished_run().folder() / "n.csv"));
}

TEST_CASE("Two windows that share an edge hold each particle once", "[convert]") {
    const Numbers all = hdf5_numbers(convert("all.h5", "--time 0 --spacing 9"), "column");
    const Numbers position = hdf5_numbers(finished_run().folder() / "all.h5", "position");
    const double edge = position[0];  // of a particle, so that it lies on the edge
    const auto held = [&](const std::string& window) {
        return hdf5_numbers(convert("part.h5", "--time 0 --spacing 9 --window " + window), "column").size();
    };
    CHECK(held(fmt::format("-1e4,-1e4,{:.17g},1e4", edge + 5.0)) < all.size());
    CHECK(held(fmt::format("-1e4,-1e4,{:.17g},1e4", edge + 5.0)) +
              held(fmt::format("{:.17g},-1e4,1e4,1e4", edge + 5.0)) ==
          all.size());
}

TEST_CASE("The run's own files are not overwritten, and the way back takes none of the way there", "[convert]") {
    CHECK(refused("out --time 1 --spacing 1 --out out/run.h5").err ==
          "--out out/run.h5: is a file of the run itself; expected another name; choose one\n");
    convert("there.h5");
    CHECK_THAT(refused("out --points there.h5 --back rasters --window 0,0,1,1").err,
               Contains("found both ways at once"));
}
