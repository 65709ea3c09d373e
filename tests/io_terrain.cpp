// The ground that frana_terrain makes for the cases, read back from its files as the program reads it.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "catch.h"
#include "io/gdal_reader.h"

using namespace frana;

namespace {

std::filesystem::path made(const std::string& name) { return std::filesystem::path(FRANA_SOURCE_DIR) / "cases" / name; }

Raster read(const std::string& name) {
    std::vector<std::string> log;
    return GdalReader().read_dem(made(name), {}, log);
}

/// Largest difference from a formula over all nodes.
template <class Formula>
double difference(const Raster& raster, const Formula& f) {
    double largest = 0.0;
    const GridGeometry& grid = raster.geometry;
    for (Index j = 0; j < grid.ny; ++j)
        for (Index i = 0; i < grid.nx; ++i)
            largest = std::max(largest, std::abs(raster.at(i, j) - f(grid.x(i), grid.y(j))));
    return largest;
}

double volume(const Raster& depth) {
    double sum = 0.0;
    for (const double h : depth.values) sum += h;
    return sum * depth.geometry.cell * depth.geometry.cell;
}

/// Coordinates pass through a file as multiples of a cell: off by a few ulp, times the slope of the formula.
constexpr double kRounding = 1e-11;

}  // namespace

TEST_CASE("The lakes' beds are those of Fois et al. (2024), eq. 34, on 50 x 50 cells of [0, 10]^2", "[terrain]") {
    const Raster hill = read("lake_at_rest/data/z1.tif"), step = read("lake_at_rest/data/z2.tif");
    for (const Raster* bed : {&hill, &step}) {
        CHECK(bed->geometry.nx == 51);
        CHECK(bed->geometry.ny == 51);
        CHECK(bed->geometry.x0 == Approx(0.0).margin(1e-12));
        CHECK(bed->geometry.x_max() == Approx(10.0));
        CHECK(bed->geometry.y_max() == Approx(10.0));
    }
    CHECK(difference(hill, [](double x, double y) {
              return 5.0 * std::exp(-0.4 * ((x - 5) * (x - 5) + (y - 5) * (y - 5)));
          }) < kRounding);
    // Beside the rim, the nodes on which lie at 4 and 8 only up to rounding.
    CHECK(difference(step, [](double x, double y) { return x > 3.9 && x < 8.1 && y > 3.9 && y < 8.1 ? 4.0 : 0.0; }) ==
          0.0);
}

TEST_CASE("The obstacle's bed is eq. 37 of Fois et al. (2024), and its release is symmetric", "[terrain]") {
    const Raster bed = read("obstacle/data/dem.tif");
    CHECK(bed.geometry.nx == 151);
    CHECK(bed.geometry.ny == 21);
    CHECK(difference(bed, [](double x, double y) {
              return 60 - x / 3 + 15 * std::exp(-((x - 50) * (x - 50) + (y - 10) * (y - 10)) / 7);
          }) < kRounding);
    std::vector<std::string> log;
    const Polygons release = GdalReader().read_polygons(made("obstacle/data/release.geojson"), "", log);
    REQUIRE(release.parts.size() == 1);
    double lowest = 1e9, highest = -1e9;
    for (const Vec2& corner : release.parts[0].rings[0]) {
        lowest = std::min(lowest, corner.y());
        highest = std::max(highest, corner.y());
    }
    CHECK(lowest + highest == 20.0);
}

TEST_CASE("The rock slide has the paper's volume, depth, length and slope", "[terrain]") {
    const Raster bed = read("bindo/data/dem.tif"), depth = read("bindo/data/depth.tif");
    CHECK((bed.geometry.nx - 1) * (bed.geometry.ny - 1) == 506250);  // 5.1e5 elements
    CHECK(bed.geometry.x_max() == 1500.0);
    CHECK(bed.geometry.y_max() == 1350.0);
    CHECK(depth.geometry == bed.geometry);
    CHECK(volume(depth) == Approx(1.2e6).epsilon(1e-12));
    double deepest = 0.0, slope = 0.0, area = 0.0;
    Index first = bed.geometry.ny, last = 0;
    for (Index j = 1; j + 1 < bed.geometry.ny; ++j)
        for (Index i = 1; i + 1 < bed.geometry.nx; ++i) {
            const double h = depth.at(i, j);
            if (h <= 0.0) continue;
            deepest = std::max(deepest, h);
            first = std::min(first, j);
            last = std::max(last, j);
            const double x = (bed.at(i + 1, j) - bed.at(i - 1, j)) / (2 * bed.geometry.cell);
            const double y = (bed.at(i, j + 1) - bed.at(i, j - 1)) / (2 * bed.geometry.cell);
            slope += std::atan(std::hypot(x, y));
            area += 1.0;
        }
    CHECK(deepest == Approx(38.0).margin(0.1));  // of the formula, whose top need not be a node
    CHECK(static_cast<double>(last - first) * bed.geometry.cell == Approx(400.0).margin(2 * bed.geometry.cell));
    CHECK(slope / area * 180.0 / 3.14159265358979 == Approx(28.0).margin(0.5));  // the paper says "about 28"
    CHECK(area == Approx(6.9e4 / 4).epsilon(0.01));                              // nodes of 4 m^2; 4 particles each
}

TEST_CASE("The picture for particles is eq. 9 of Fois et al. (2025) on 100 x 100 pixels", "[terrain]") {
    const Raster depth = read("tiff_particles/data/depth.tif"), bed = read("tiff_particles/data/dem.tif");
    CHECK(depth.geometry.nx == 100);
    CHECK(depth.geometry.ny == 100);
    CHECK(difference(depth, [](double x, double y) {
              return 1 + 2 * std::exp(-((x - 50) * (x - 50) + (y - 50) * (y - 50)) / 150);
          }) < kRounding);
    const auto picture = depth.geometry.pixel_extent();
    CHECK(bed.geometry.x0 <= picture[0]);
    CHECK(bed.geometry.x_max() >= picture[2]);
}

TEST_CASE("The avalanche track is 34 degrees steep at its head and level at its end", "[terrain]") {
    const Raster bed = read("avalanche_track/data/dem.tif");
    const double head = (bed.at(0, 0) - bed.at(1, 0)) / bed.geometry.cell;
    CHECK(std::atan(head) * 180.0 / 3.14159265358979 == Approx(34.0).margin(0.1));
    for (Index j = 0; j < bed.geometry.ny; ++j) CHECK(bed.at(bed.geometry.nx - 1, j) == 1000.0);
    const Index middle = bed.geometry.ny / 2;
    CHECK(bed.at(100, middle) < bed.at(100, 0) - 10.0);  // the channel
}

TEST_CASE("Maunga Whau is a grid of 87 x 61 heights, 94 to 195 m, 10 m apart", "[terrain]") {
    const Raster bed = read("maungawhau/dem.asc");
    CHECK(bed.geometry.nx == 87);
    CHECK(bed.geometry.ny == 61);
    CHECK(bed.geometry.cell == 10.0);
    CHECK(bed.geometry.x0 == 0.0);
    CHECK(*std::min_element(bed.values.begin(), bed.values.end()) == 94.0);
    CHECK(*std::max_element(bed.values.begin(), bed.values.end()) == 195.0);
    CHECK(bed.at(0, 60) == 103.0);  // the first value of the source stands in the north-west
}
