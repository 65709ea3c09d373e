// terrain.vti, and the reader that gives a run back to figures.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "catch.h"
#include "frame_maker.h"
#include "fresh_folder.h"
#include "vtk_io/reader.h"
#include "vtk_io/writers.h"

using namespace frana;
using Catch::Matchers::Contains;
namespace fs = std::filesystem;

namespace {

Raster plane(Index nx, Index ny, double slope_x, double slope_y) {
    Raster bed = Raster::filled(FrameMaker::utm(nx, ny), 0.0);
    for (Index j = 0; j < ny; ++j)
        for (Index i = 0; i < nx; ++i)
            bed.at(i, j) =
                1000.0 + bed.geometry.cell * (slope_x * static_cast<double>(i) + slope_y * static_cast<double>(j));
    return bed;
}

double worst(const std::vector<double>& values, double wanted) {
    double difference = 0.0;
    for (const double value : values) difference = std::max(difference, std::abs(value - wanted));
    return difference;
}

}  // namespace

TEST_CASE("The slope of a plane is its angle at every node, edges included", "[io][vtk]") {
    const FreshFolder run;
    write_terrain(run.path(), plane(17, 11, 0.3, -0.4));
    const LoadedFrame terrain = read_terrain(run.path());
    CHECK(terrain.units.at("slope") == "degree");
    CHECK(terrain.units.at("elevation") == "m");
    CHECK(terrain.grid.nx == 17);
    CHECK(terrain.grid.ny == 11);
    // float32 keeps 7 digits of 26.57 degrees
    CHECK(worst(terrain.nodes.at("slope"), std::atan(0.5) * 180.0 / std::acos(-1.0)) < 4e-6);
    CHECK(worst(terrain.nodes.at("elevation"), 1000.0) > 10.0);
}

TEST_CASE("Slopes that face north-west are brighter than flat ground, south-east ones darker", "[io][vtk]") {
    const FreshFolder run;
    const auto shade_of = [&run](double slope_x, double slope_y) {
        write_terrain(run.path(), plane(5, 5, slope_x, slope_y));
        return read_terrain(run.path()).nodes.at("hillshade")[12];
    };
    const double flat = shade_of(0, 0), north_west = shade_of(0.3, -0.3), south_east = shade_of(-0.3, 0.3);
    CHECK(flat == Approx(std::sqrt(0.5)).epsilon(1e-6));  // every lamp stands 45 degrees high
    CHECK(north_west > flat);
    CHECK(south_east < flat);
    CHECK(shade_of(-40.0, 40.0) >= 0.0);
    CHECK(shade_of(0.7, -0.7) <= 1.0);
}

TEST_CASE("Holes in the terrain come back as NaN, and only there", "[io][vtk]") {
    const FreshFolder run;
    Raster bed = plane(9, 9, 0.1, 0.0);
    bed.at(4, 4) = bed.at(0, 0) = Raster::nodata;
    write_terrain(run.path(), bed);
    const LoadedFrame terrain = read_terrain(run.path());
    Index holes = 0;
    for (const double z : terrain.nodes.at("elevation")) holes += std::isnan(z);
    CHECK(holes == 2);
    CHECK(std::isnan(terrain.nodes.at("elevation")[4 * 9 + 4]));
    for (const char* name : {"slope", "hillshade"}) CHECK(worst(terrain.nodes.at(name), 0.0) < 90.0);
    // one-sided differences beside the hole: the plane's slope there too
    CHECK(terrain.nodes.at("slope")[4 * 9 + 3] == Approx(std::atan(0.1) * 180.0 / std::acos(-1.0)).epsilon(1e-5));
}

TEST_CASE("Terrain of one node or one row has a flat or one-way slope", "[io][vtk]") {
    const FreshFolder run;
    write_terrain(run.path(), plane(1, 1, 0.3, 0.3));
    CHECK(read_terrain(run.path()).nodes.at("slope")[0] == 0.0);
    write_terrain(run.path(), plane(6, 1, 1.0, 7.0));
    CHECK(worst(read_terrain(run.path()).nodes.at("slope"), 45.0) < 4e-6);
}

TEST_CASE("read_frame gives back what the writers were shown", "[io][vtk]") {
    const FreshFolder run;
    const auto grid = make_grid_writer(run.path());
    const auto particles = make_particle_writer(run.path());
    for (Index number = 0; number < 4; ++number) {
        FrameMaker maker(number, 2.5 * static_cast<double>(number), 100 * number, FrameMaker::utm(31, 17));
        maker.cut_corner();
        grid->observe(maker.frame);
        particles->observe(maker.frame);
    }
    CHECK(frame_times(run.path()) == std::vector<double>{0.0, 2.5, 5.0, 7.5});
    CHECK(nearest_frame(run.path(), 5.4) == 2);
    CHECK(nearest_frame(run.path(), -1.0) == 0);
    CHECK(nearest_frame(run.path(), 1e9) == 3);

    FrameMaker maker(3, 7.5, 300, FrameMaker::utm(31, 17));
    maker.cut_corner();
    const LoadedFrame frame = read_frame(run.path(), -1);
    CHECK(frame.number == 3);
    CHECK(frame.time == 7.5);
    CHECK(frame.grid.nx == 31);
    CHECK(frame.nodes.size() == maker.frame.nodes.size() + 1);  // and "outside"
    CHECK(frame.components.at("velocity") == 3);
    for (const Field& field : maker.frame.nodes) {
        const auto& found = frame.nodes.at(field.name);
        CAPTURE(field.name);
        REQUIRE(static_cast<Index>(found.size()) == field.count * field.components);
        CHECK(frame.units.at(field.name) == field.unit);
        Index different = 0;
        for (std::size_t k = 0; k < found.size(); ++k) {
            const bool both_nan = std::isnan(found[k]) && std::isnan(field.data[k]);
            const bool stand_in = field.name == "surface" && std::isnan(field.data[k]) && std::isfinite(found[k]);
            different += !both_nan && !stand_in && found[k] != static_cast<double>(static_cast<float>(field.data[k]));
        }
        CHECK(different == 0);
    }
    const LoadedFrame some = read_frame(run.path(), -1, {"velocity", "not there"});
    CHECK(some.nodes.size() == 3);  // with the elevation, and where it is not
    CHECK(some.nodes.at("velocity") == frame.nodes.at("velocity"));
    CHECK(std::isnan(some.nodes.at("elevation").back()));
    CHECK(some.names.size() == frame.names.size());
    CHECK(std::count(some.names.begin(), some.names.end(), "depth") == 1);
    CHECK(std::count(some.names.begin(), some.names.end(), "not there") == 0);
    const LoadedParticles cloud = read_particles(run.path(), 3);
    CHECK(cloud.count == 300);
    CHECK(cloud.arrays.at("position") == maker.particle_numbers("position"));
    CHECK(cloud.arrays.at("mass") == maker.particle_numbers("mass"));
    CHECK(cloud.arrays.at("id") == maker.particle_numbers("id"));
    CHECK(cloud.units.at("mass") == "kg");
    CHECK(read_particles(run.path(), 0).count == 0);
}

TEST_CASE("A missing, broken or absent frame is an error that names it", "[io][vtk]") {
    const FreshFolder run;
    CHECK_THROWS_WITH(frame_times(run.path()), Contains("grid.pvd: not found"));
    CHECK_THROWS_WITH(read_terrain(run.path()), Contains("terrain.vti: not found"));
    FrameMaker maker(0, 0.0, 1, FrameMaker::utm(40, 40));
    make_grid_writer(run.path())->observe(maker.frame);
    CHECK_THROWS_WITH(read_frame(run.path(), 5), Contains("has no frame 5"));
    CHECK_THROWS_WITH(read_frame(run.path(), -2), Contains("has no frame -2"));
    fs::resize_file(run.path() / "grid/grid_000000.vti", 900);
    CHECK_THROWS_WITH(read_frame(run.path(), 0), Contains("grid_000000.vti") && Contains("cannot be read"));
    fs::remove(run.path() / "grid/grid_000000.vti");
    CHECK_THROWS_WITH(read_frame(run.path(), 0), Contains("grid_000000.vti: not found"));
}

TEST_CASE("A frame with a damaged header is an error that names it, whatever VTK makes of it", "[io][vtk]") {
    const FreshFolder run;
    FrameMaker maker(0, 0.0, 10, FrameMaker::utm(5, 5));
    make_particle_writer(run.path())->observe(maker.frame);
    const fs::path file = run.path() / "particles/particles_000000.vtp";
    std::string text = text_of(file);
    std::string sentence = "cannot be read";
    const auto replace_first = [&](const std::string& what, const std::string& by) {
        REQUIRE(text.find(what) != text.npos);
        text.replace(text.find(what), what.size(), by);
    };
    SECTION("a type that nobody knows") { replace_first("type=\"String\"", "type=\"Strang\""); }
    SECTION("a type without its name") { replace_first("<DataArray type=", "<DataArray tupe="); }
    SECTION("a block that claims more than any memory has") { replace_first("AQAAAAAAAAAAgAAA", "AQAAAAAAArAAgAAA"); }
    SECTION("vertices of points that are not there") {
        replace_first("NumberOfPoints=\"10\"", "NumberOfPoints=\"4\"");
        sentence = "names point 9, counted from 0, of 4 points";
    }
    std::ofstream(file, std::ios::binary) << text;
    CHECK_THROWS_AS(read_particles(run.path(), 0), UserError);
    CHECK_THROWS_WITH(read_particles(run.path(), 0), Contains("particles_000000.vtp: ") && Contains(sentence));
}
