// What in-situ works write, read by VTK's own readers and held against the frame's numbers.
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <set>

#include "catch.h"
#include "fake_simulation.h"
#include "frame_maker.h"
#include "fresh_folder.h"
#include "io_gdal_make.h"
#include "vtk_io/insitu.h"
#include "vtk_io/pvd.h"
#include "vtk_read.h"

using namespace frana;
namespace fs = std::filesystem;

namespace {

double time_of(vtkDataSet* data) {
    auto* time = vtkDoubleArray::SafeDownCast(data->GetFieldData()->GetAbstractArray("TimeValue"));
    REQUIRE(time);
    return time->GetValue(0);
}

/// The fake's state at a time.
Frame frame_at(FakeSimulation& simulation, double time) {
    while (simulation.status().time < time) simulation.advance(time);
    return simulation.frame();
}

}  // namespace

TEST_CASE("contours are the circles of the fake's hill, on the surface of the flow", "[insitu]") {
    const FreshFolder folder;
    FakeSimulation simulation;
    const auto work = make_contours(folder.path(), "lines", "depth", {0.5, 1.0});
    work->sample(frame_at(simulation, 0.0), 0);
    work->sample(frame_at(simulation, 0.6), 1);
    const std::vector<PvdEntry> entries = read_pvd(folder.path() / "lines.pvd");
    REQUIRE(entries.size() == 2);
    CHECK(entries[1].time == 0.6);
    CHECK(entries[1].file == "lines/lines_000001.vtp");
    const auto reader = read<vtkXMLPolyDataReader>(folder.path() / entries[1].file);
    vtkPolyData* lines = reader->GetOutput();
    CHECK(time_of(lines) == 0.6);
    auto* unit = vtkStringArray::SafeDownCast(lines->GetFieldData()->GetAbstractArray("level_unit"));
    REQUIRE(unit);
    CHECK(unit->GetValue(0) == "m");
    vtkDataArray* levels = lines->GetCellData()->GetArray("level");
    REQUIRE(levels);
    std::set<double> found;
    for (vtkIdType cell = 0; cell < lines->GetNumberOfCells(); ++cell) {
        const double level = levels->GetComponent(cell, 0);
        found.insert(level);
        vtkNew<vtkIdList> ids;
        lines->GetCellPoints(cell, ids);
        REQUIRE(ids->GetNumberOfIds() > 8);
        for (vtkIdType k = 0; k < ids->GetNumberOfIds(); ++k) {
            double p[3];
            lines->GetPoint(ids->GetId(k), p);
            const double radius = (Vec2(p[0], p[1]) - FakeSimulation::centre(0.6)).norm();
            const double exact = FakeSimulation::width * std::sqrt(2.0 * std::log(FakeSimulation::height / level));
            // a chord on 1 m cells is off by h''/8 in depth, over a slope of at least 0.36: h'' < 0.23 1/m
            CHECK(std::abs(radius - exact) < 0.23 / 8.0 / 0.36);
            // there the depth is the level and the bed is a plane; places on an edge are kept to single precision
            CHECK(p[2] == Approx(FakeSimulation::bed({p[0], p[1]}) + level).margin(1e-4));
        }
    }
    CHECK(found == std::set<double>{0.5, 1.0});
}

TEST_CASE("a contour of a field that the run does not have says so and leaves no file", "[insitu]") {
    const FreshFolder folder;
    FakeSimulation simulation;
    const auto work = make_contours(folder.path(), "lines", "stress_xx", {1.0});
    CHECK_THROWS_WITH(work->sample(simulation.frame(), 0), Catch::Contains("found no field \"stress_xx\" of the grid"));
    CHECK(fs::is_empty(folder.path()));
}

TEST_CASE("a threshold keeps the particles whose values lie in the interval, with all arrays", "[insitu]") {
    const FreshFolder folder;
    const FrameMaker made(3, 1.5, 500, FrameMaker::utm(20, 15));
    const auto work = make_particle_threshold(folder.path(), "some", "velocity_y", {-4.0, -1.5});
    work->sample(made.frame, 0);
    const auto reader = read<vtkXMLPolyDataReader>(folder.path() / "some" / "some_000000.vtp");
    vtkPolyData* cloud = reader->GetOutput();
    CHECK(time_of(cloud) == 1.5);
    const Field &velocity = *made.frame.particle("velocity"), &position = *made.frame.particle("position"),
                &mass = *made.frame.particle("mass");
    vtkDataArray* masses = cloud->GetPointData()->GetArray("mass");
    REQUIRE(masses);
    CHECK(cloud->GetPointData()->GetArray("kept") == nullptr);
    vtkIdType next = 0;
    for (Index p = 0; p < velocity.count; ++p) {
        const double v = velocity.data[3 * p + 1];
        if (v < -4.0 || v > -1.5) continue;
        REQUIRE(next < cloud->GetNumberOfPoints());
        double at[3];
        cloud->GetPoint(next, at);
        for (int c = 0; c < 3; ++c) CHECK(at[c] == position.data[3 * p + c]);
        CHECK(masses->GetComponent(next, 0) == mass.data[p]);
        ++next;
    }
    CHECK(cloud->GetNumberOfPoints() == next);
    CHECK(cloud->GetNumberOfVerts() == next);
    CHECK(next > 100);
    CHECK(next < 400);
}

TEST_CASE("a threshold of particles that have all left is an empty file and a quiet one", "[insitu]") {
    const FreshFolder folder;
    FrameMaker made(0, 1.5, 0, FrameMaker::utm(5, 5));
    const auto work = make_particle_threshold(folder.path(), "none", "velocity_y", {0.1, 1e9});
    CHECK(heard_on_stderr([&] { work->sample(made.frame, 0); }).empty());
    const auto reader = read<vtkXMLPolyDataReader>(folder.path() / "none" / "none_000000.vtp");
    CHECK(reader->GetOutput()->GetNumberOfPoints() == 0);
    CHECK(time_of(reader->GetOutput()) == 1.5);
}

TEST_CASE("a threshold keeps the cells all of whose nodes have terrain and lie in the interval", "[insitu]") {
    const FreshFolder folder;
    FrameMaker made(0, 0.0, 10, FrameMaker::utm(20, 15));
    made.cut_corner();
    const GridGeometry& grid = made.frame.grid;
    const auto work = make_cell_threshold(folder.path(), "dry", "depth", {-1.0, 1.0});
    work->sample(made.frame, 0);
    const auto reader = read<vtkXMLUnstructuredGridReader>(folder.path() / "dry" / "dry_000000.vtu");
    vtkUnstructuredGrid* kept = reader->GetOutput();
    const Field &depth = *made.frame.node("depth"), &bed = *made.frame.node("elevation");
    const auto inside = [&](Index i, Index j) {
        const Index k = j * grid.nx + i;
        return !std::isnan(bed.data[k]) && depth.data[k] <= 1.0;
    };
    std::set<std::pair<Index, Index>> expected, found;
    for (Index j = 0; j + 1 < grid.ny; ++j)
        for (Index i = 0; i + 1 < grid.nx; ++i)
            if (inside(i, j) && inside(i + 1, j) && inside(i, j + 1) && inside(i + 1, j + 1)) expected.insert({i, j});
    vtkDataArray* depths = kept->GetPointData()->GetArray("depth");
    REQUIRE(depths);
    for (vtkIdType cell = 0; cell < kept->GetNumberOfCells(); ++cell) {
        double box[6];
        kept->GetCellBounds(cell, box);
        found.insert({std::lround((box[0] - grid.x0) / grid.cell), std::lround((box[2] - grid.y0) / grid.cell)});
    }
    for (vtkIdType point = 0; point < kept->GetNumberOfPoints(); ++point) {
        double at[3];
        kept->GetPoint(point, at);
        const Index i = std::lround((at[0] - grid.x0) / grid.cell), j = std::lround((at[1] - grid.y0) / grid.cell);
        CHECK(depths->GetComponent(point, 0) == static_cast<double>(static_cast<float>(depth.data[j * grid.nx + i])));
    }
    CHECK(found == expected);
    CHECK(found.size() > 20);
    CHECK(found.size() < static_cast<std::size_t>((grid.nx - 1) * (grid.ny - 1)));
}
