// `frana ensemble` on a block whose runout is known by its energy line.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>

#include "base/atomic_file.h"
#include "catch.h"
#include "io/gdal_reader.h"
#include "program.h"

namespace fs = std::filesystem;

namespace {

constexpr double kCell = 5.0, kSlope = 0.1, kSpeed = 15.0, kGravity = 9.81;
constexpr double kFront = 32.5;              ///< of the block at the start [m]
constexpr double kLeast = 0.2, kMost = 0.5;  ///< friction is uniform between the two
constexpr int kColumns = 40, kSamples = 60;

/// A film between walls on a plane that falls to the east; so thin that its own pressure moves it by no pixel. All of it
/// starts at the same speed, so that it slides as one block. Its motion on the map is u^2 (1 + S^2) / 2 + g S L = g mu L:
/// the energy line falls by mu on each metre of the map, whatever the slope.
class Block {
public:
    Block() {
        std::ostringstream dem;
        dem << "ncols " << kColumns << "\nnrows 6\nxllcorner 0\nyllcorner 0\ncellsize 5\nNODATA_value -9999\n";
        for (int row = 0; row < 6; ++row)
            for (int i = 0; i < kColumns; ++i) dem << 100.0 - kSlope * kCell * i << (i + 1 < kColumns ? ' ' : '\n');
        write("dem.asc", dem.str());
        write("block.geojson", R"({"type": "Polygon", "coordinates": [[[12.5, 2.5], [32.5, 2.5], [32.5, 27.5],
                                   [12.5, 27.5], [12.5, 2.5]]]})");
        write("case.toml", R"(
[terrain]
dem = "dem.asc"
[[release]]
outline = "block.geojson"
depth = 0.001
velocity = [15.0, 0.0]
[material.bed]
law = "coulomb"
mu = 0.3
[boundary]
sides = "wall"
[time]
end = 20.0
[output]
footprint_depth = 0.0002
)");
        write("many.toml", R"(
[ensemble]
case = "case.toml"
method = "lhs"
samples = 60
fields = ["peak_depth"]
exceed = { peak_depth = [0.0005] }
[[ensemble.vary]]
key = "material.bed.mu"
range = [0.2, 0.5]
)");
    }
    void write(const std::string& name, const std::string& text) const { frana::write_text(path(name), text); }
    fs::path path(const std::string& name) const { return folder_.path() / name; }
    Outcome frana(const std::string& arguments) const { return call_frana(folder_.path(), arguments); }

private:
    FreshFolder folder_;
};

/// Probability that the block slides farther than `length`.
double farther_than(double length) {
    if (length <= 0.0) return 1.0;
    const double mu = kSlope + kSpeed * kSpeed * (1.0 + kSlope * kSlope) / (2.0 * kGravity * length);
    return std::clamp((mu - kLeast) / (kMost - kLeast), 0.0, 1.0);
}

}  // namespace

TEST_CASE("a block with friction of unknown size exceeds each place as its energy line says", "[ensemble]") {
    const Block block;
    const Outcome done = block.frana("ensemble many.toml --out many --quiet");
    CHECK(done.err.empty());
    REQUIRE(done.code == 0);
    std::vector<std::string> log;
    const frana::Raster map = frana::GdalReader().read_raster(
        block.path("many/rasters/probability_peak_depth_0.0005.tif"), {0.0, 0.0, kColumns * kCell, 30.0}, "", log);
    REQUIRE(map.geometry.nx == kColumns);
    constexpr double slice = 1.0 / kSamples + 1e-6;  // one of a Latin hypercube's, in one key
    int between = 0;
    for (frana::Index j = 0; j < map.geometry.ny; ++j)
        for (frana::Index i = 5; i < kColumns; ++i) {  // from within the block at its start
            const double shown = map.at(i, j), length = map.geometry.x(i) - kFront;
            const double p = std::isnan(shown) ? 0.0 : shown;  // no data where no run came
            CAPTURE(i, j, length, p);
            CHECK(p <= farther_than(length - kCell) + slice);  // a pixel: what a particle on its far side covers
            CHECK(p >= farther_than(length + kCell) - slice);
            between += p > 0.05 && p < 0.95;
        }
    CHECK(between > 40);  // 29 to 116 m are 17 pixels in each of six rows
}
