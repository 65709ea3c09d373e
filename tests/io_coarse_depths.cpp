// Depths of rasters whose pixels are larger than the cells: what is loose, and what lies below a surface.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>

#include "base/atomic_file.h"
#include "catch.h"
#include "fresh_folder.h"
#include "io/gdal_reader.h"
#include "scene/build_scene.h"

using namespace frana;

namespace {

constexpr double kWide = 10.0, kBlockDepth = 9.0;
constexpr int kAcross = 30, kAlong = 10;

void write_coarse(const std::filesystem::path& file, const std::function<double(double x, double y)>& value) {
    std::string text = fmt::format("ncols {}\nnrows {}\nxllcorner 0\nyllcorner 0\ncellsize {}\nNODATA_value -9999\n",
                                   kAcross, kAlong, kWide);
    for (int row = kAlong - 1; row >= 0; --row)
        for (int column = 0; column < kAcross; ++column)
            text += fmt::format("{} ", value((column + 0.5) * kWide, (row + 0.5) * kWide));
    write_text(file, text);
}

/// A block 9 m deep on 10 x 4 pixels. A place on an edge of pixels belongs to the one east or north of it.
double block_at(double x, double y) { return x >= 100 && x < 200 && y >= 30 && y < 70 ? kBlockDepth : 0.0; }
/// The share of a node's square that is on the block.
double share_of_block(double x, double y, double cell) {
    const auto within = [&](double middle, double low, double high) {
        return std::max(0.0, std::min(middle + 0.5 * cell, high) - std::max(middle - 0.5 * cell, low)) / cell;
    };
    return within(x, 100.0, 200.0) * within(y, 30.0, 70.0);
}
double ground_at(double x, double y) { return 300.0 - 0.3 * x + 2.0 * std::sin(0.1 * x) * std::cos(0.07 * y); }

/// The block as a file of each kind, on cells that may be smaller than its pixels.
struct CoarseFiles {
    FreshFolder folder;
    CoarseFiles() {
        write_coarse(folder.path() / "dem.asc", ground_at);
        write_coarse(folder.path() / "loose.asc", block_at);
        write_coarse(folder.path() / "surface.asc",
                     [](double x, double y) { return ground_at(x, y) + block_at(x, y); });
    }
    Scene scene(double cell, const std::string& rest) const {
        const std::string text = fmt::format(
            "terrain.dem = \"dem.asc\"\ngrid.cell = {}\nmaterial.density = 1500.0\nmaterial.bed = {{ law = "
            "\"coulomb\", mu = 0.3 }}\ntime = {{ end = 1.0 }}\n{}",
            cell, rest);
        return build_scene(CaseFile::parse(text, folder.path() / "case.toml", {}), GdalReader());
    }
};

}  // namespace

// Interpolated across the step, loose ground was 5.6 m deep in place of 9 m, and 3.4 m on rock beside it.
TEST_CASE("Loose ground on cells smaller than its pixels is as deep as they, and ends where they do",
          "[erosion][scene]") {
    const CoarseFiles files;
    const double cell = GENERATE(10.0, 5.0, 4.0, 3.0, 2.5);
    const Scene scene = files.scene(
        cell, "erodible = { law = \"growth\", growth = 0.001, depth = \"loose.asc\" }\n[[release]]\ndepth = 1.0\n");
    const Raster& loose = scene.erodible->depth;
    const GridGeometry& g = loose.geometry;
    double volume = 0.0;
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) {
            CAPTURE(cell, g.x(i), g.y(j));
            CHECK(loose.at(i, j) == Approx(kBlockDepth * share_of_block(g.x(i), g.y(j), cell)).margin(1e-8));
            volume += cell * cell * loose.at(i, j);
        }
    // Cells that do not divide the pixels gave the block another volume before.
    CHECK(volume == Approx(kBlockDepth * 40 * kWide * kWide).epsilon(1e-8));
}

TEST_CASE("Below a surface on pixels of the elevation model lies what its pixels say, on smaller cells as well",
          "[scene]") {
    const CoarseFiles files;
    const double cell = GENERATE(10.0, 5.0, 4.0, 2.5);
    const Scene scene = files.scene(cell, "[[release]]\nsurface = \"surface.asc\"\n");
    const Seeds& seeds = scene.particles;
    double volume = 0.0;
    for (const double part : seeds.volume) volume += part;
    CAPTURE(cell);
    // Pixels of up to 300 m have 24 bits: each is right to 1.5e-5 m.
    CHECK(volume ==
          Approx(kBlockDepth * 40 * kWide * kWide).epsilon(4e-6));  // from 34 390 to 37 197 by cubic interpolation
    CHECK(*std::max_element(seeds.depth.begin(), seeds.depth.end()) == Approx(kBlockDepth).epsilon(4e-6));
}

// Pixels have 24 bits. Waves are between their values, and a part of a terrain has the same depths as all of it.
TEST_CASE("A wave of loose ground stays within its pixels, which keep their volume", "[erosion][scene]") {
    const CoarseFiles files;
    const auto wave = [](double x, double y) { return 2.0 + std::sin(0.06 * x) * std::cos(0.1 * y); };
    write_coarse(files.folder.path() / "wave.asc", wave);
    const std::string rest =
        "erodible = {{ law = \"growth\", growth = 0.001, depth = \"wave.asc\" }}\n{}[[release]]\ndepth = 1.0\n";
    const Raster all = files.scene(2.5, fmt::format(rest, "")).erodible->depth;
    const auto at = [&](int column, int row) { return wave((column + 0.5) * kWide, (row + 0.5) * kWide); };
    for (int row = 1; row + 1 < kAlong; ++row)
        for (int column = 1; column + 1 < kAcross; ++column) {
            double low = INFINITY, high = -INFINITY, sum = 0.0;
            for (int b = -1; b <= 1; ++b)
                for (int a = -1; a <= 1; ++a)
                    low = std::min(low, at(column + a, row + b)), high = std::max(high, at(column + a, row + b));
            for (Index j = 4 * row; j < 4 * row + 4; ++j)
                for (Index i = 4 * column; i < 4 * column + 4; ++i) {
                    sum += all.at(i, j);
                    REQUIRE(all.at(i, j) >= low - 2e-7);
                    REQUIRE(all.at(i, j) <= high + 2e-7);
                }
            REQUIRE(sum / 16.0 == Approx(at(column, row)).epsilon(1e-7));
        }
    CHECK(all.at(60, 20) != all.at(61, 20));  // no steps of pixels
    const Raster part = files.scene(2.5, fmt::format(rest, "terrain.window = [55, 25, 245, 75]\n")).erodible->depth;
    for (Index j = 0; j < part.geometry.ny; ++j)
        for (Index i = 0; i < part.geometry.nx; ++i) {
            const Index a = std::lround((part.geometry.x(i) - all.geometry.x0) / 2.5),
                        b = std::lround((part.geometry.y(j) - all.geometry.y0) / 2.5);
            REQUIRE(part.at(i, j) == Approx(all.at(a, b)).epsilon(1e-12));
        }
}
