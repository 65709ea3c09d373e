// The files that only states read: survey on the terrain, profiles through time.
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkFieldData.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "catch.h"
#include "compare/outline.h"
#include "compare/overlap.h"
#include "frame_maker.h"
#include "fresh_folder.h"
#include "read_polydata.h"
#include "vtk_io/pvd.h"
#include "vtk_io/survey_vtp.h"
#include "vtk_io/writers.h"

using namespace frana;
using test::polydata;
namespace fs = std::filesystem;

namespace {

/// A plane z = 100 + x + 2 y on 10 x 8 nodes, 2 m apart, the first at (1, 1): pixels from (0, 0) to (20, 16).
Raster plane() {
    Raster bed = Raster::filled({10, 8, 1.0, 1.0, 2.0}, 0.0);
    for (Index j = 0; j < 8; ++j)
        for (Index i = 0; i < 10; ++i) bed.at(i, j) = 100.0 + bed.geometry.x(i) + 2.0 * bed.geometry.y(j);
    return bed;
}

/// Length of a line in the map.
double length_of_cell(vtkPolyData* data, vtkIdType cell) {
    vtkIdList* points = data->GetCell(cell)->GetPointIds();
    double sum = 0.0, a[3], b[3];
    for (vtkIdType k = 0; k + 1 < points->GetNumberOfIds(); ++k) {
        data->GetPoint(points->GetId(k), a);
        data->GetPoint(points->GetId(k + 1), b);
        sum += std::hypot(b[0] - a[0], b[1] - a[1]);
    }
    return sum;
}

}  // namespace

TEST_CASE("the survey's pixels are what they are: in both, simulated only, surveyed only") {
    const FreshFolder folder;
    const Raster bed = plane();
    Raster depth = bed;
    for (double& value : depth.values) value = 0.0;
    for (Index j = 2; j < 6; ++j)
        for (Index i = 1; i < 5; ++i) depth.at(i, j) = 1.0;  // [2, 10] x [4, 12]
    // [6, 15] x [4, 8]: columns 3 to 6 in full, of column 7 a half; without a hole [6, 8] x [4, 6], pixel (3, 2).
    const Rings survey = {{{6, 4}, {15, 4}, {15, 8}, {6, 8}}, {{6, 4}, {6, 6}, {8, 6}, {8, 4}}};
    write_survey(folder.path(), bed, depth, 0.5, survey);

    const auto areas = polydata(folder.path() / "survey_areas.vtp");
    std::array<int, 4> count{};
    double surveyed = 0.0;
    for (vtkIdType cell = 0; cell < areas->GetNumberOfCells(); ++cell) {
        count.at(static_cast<std::size_t>(areas->GetCellData()->GetArray("agreement")->GetTuple1(cell)))++;
        surveyed += areas->GetCellData()->GetArray("surveyed_share")->GetTuple1(cell) * 4.0;
    }
    CHECK(count[0] == 0);
    CHECK(count[1] == 3);       // columns 3 and 4, rows 2 and 3, but for the hole
    CHECK(count[2] == 16 - 3);  // of 16 simulated ones
    CHECK(count[3] == 6);       // columns 5, 6 and the half of 7, two rows
    CHECK(surveyed == 9.0 * 4.0 - 4.0);
    for (vtkIdType k = 0; k < areas->GetNumberOfPoints(); ++k) {
        double p[3];
        areas->GetPoint(k, p);
        const double inside_x = std::clamp(p[0], 1.0, 19.0), inside_y = std::clamp(p[1], 1.0, 15.0);
        CHECK(std::abs(p[2] - (100.0 + inside_x + 2.0 * inside_y)) < 1e-12 * p[2]);  // a plane, bilinear: round-off
    }
}

TEST_CASE("the survey's outlines are closed, on the terrain, and leave out what lies outside of it") {
    const FreshFolder folder;
    const Raster bed = plane();
    Raster depth = bed;
    for (double& value : depth.values) value = 0.0;
    depth.at(4, 4) = 1.0;  // one pixel, 8 m around
    const Rings survey = {{{2, 2}, {12, 2}, {12, 10}, {2, 10}}, {{-30, 4}, {-20, 4}, {-20, 8}}};
    write_survey(folder.path(), bed, depth, 0.5, survey);
    const auto lines = polydata(folder.path() / "survey_outlines.vtp");
    REQUIRE(lines->GetNumberOfCells() == 2);  // of the ring beside the terrain there is nothing
    vtkDataArray* extent = lines->GetCellData()->GetArray("extent");
    CHECK(extent->GetTuple1(0) == 1);
    CHECK(extent->GetTuple1(1) == 2);
    CHECK(std::abs(length_of_cell(lines, 0) - 8.0) < 1e-12);
    CHECK(std::abs(length_of_cell(lines, 1) - 36.0) < 1e-12);
    for (vtkIdType k = 0; k < lines->GetNumberOfPoints(); ++k) {
        double p[3];
        lines->GetPoint(k, p);
        CHECK(std::abs(p[2] - (100.0 + p[0] + 2.0 * p[1])) < 1e-12 * p[2]);
    }
}

TEST_CASE("profiles hold what the frame has at their stations, and the first frame's surface") {
    const FreshFolder folder;
    const GridGeometry grid = FrameMaker::utm(20, 15);
    const double west = grid.x0, south = grid.y0, cell = grid.cell;
    const std::vector<ProfileLine> profiles = {
        {"a", {{west + 2.3 * cell, south + 2 * cell}, {west + 9 * cell, south + 7 * cell}}},
        {"b", {{west + 3 * cell, south + 3 * cell}, {west + 3 * cell, south + 9 * cell}}}};
    const auto writer = make_profile_writer(folder.path(), profiles);
    std::vector<double> first_surfaces, first_beds;
    for (const double time : {0.0, 2.5}) {
        FrameMaker maker(time > 0.0 ? 1 : 0, time, 100, grid);
        writer->observe(maker.frame);
        const auto data = polydata(folder.path() / fmt::format("profiles/profiles_{:06d}.vtp", time > 0.0 ? 1 : 0));
        REQUIRE(data->GetNumberOfCells() == 2);
        CHECK(data->GetFieldData()->GetArray("TimeValue")->GetTuple1(0) == time);
        auto* names = vtkStringArray::SafeDownCast(data->GetFieldData()->GetAbstractArray("profile_names"));
        REQUIRE(names);
        CHECK(names->GetValue(1) == "b");
        vtkIdType point = 0;
        for (std::size_t line = 0; line < profiles.size(); ++line) {
            CHECK(data->GetCellData()->GetArray("profile")->GetTuple1(static_cast<vtkIdType>(line)) ==
                  static_cast<double>(line));
            for (const Station& station : stations(profiles[line].line, 0.5 * cell)) {
                const Sample flow = sample(maker.frame, station.point);
                const auto holds = [&](const char* name, double wanted) {
                    CAPTURE(name, point);
                    CHECK(data->GetPointData()->GetArray(name)->GetTuple1(point) == static_cast<float>(wanted));
                };
                holds("distance", station.distance);
                holds("elevation", flow.elevation);
                holds("depth", flow.depth);
                holds("surface", flow.elevation + flow.depth);
                holds("velocity_along", flow.velocity.dot(station.along));
                if (time == 0.0)
                    first_surfaces.push_back(flow.elevation + flow.depth), first_beds.push_back(flow.elevation);
                holds("initial_surface", first_surfaces.at(static_cast<std::size_t>(point)));
                holds("initial_elevation", first_beds.at(static_cast<std::size_t>(point)));
                ++point;
            }
        }
        CHECK(point == data->GetNumberOfPoints());
    }
    CHECK(read_pvd(folder.path() / "profiles.pvd").size() == 2);
}
