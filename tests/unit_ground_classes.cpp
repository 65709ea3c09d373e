// Classes of ground for the table of snow's friction, and scenes that take their friction from it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <variant>

#include "catch.h"
#include "scene/build_scene.h"
#include "scene/ground_classes.h"
#include "scene/salm_table.h"
#include "slope_case.h"

using namespace frana;
using namespace frana::test;
using Catch::Contains;

namespace {

enum : std::uint8_t { kFlat, kOpen, kChannelled, kGully };

const GridGeometry grid{41, 31, 500, 800, 5};
constexpr double middle = 875.0;  // y of the grid's middle row

Raster terrain(const std::function<double(double, double)>& height) { return sampled(grid, height); }

/// All nodes' classes but of a band that the smoothing reaches over a bend of the synthetic ground.
void check_all(const Raster& bed, std::uint8_t expected) {
    const auto classes = ground_classes(bed, {});
    CHECK(static_cast<std::size_t>(std::count(classes.begin(), classes.end(), expected)) == classes.size());
}

/// A case on slope_gis() with its friction told by keys under [material.bed].
std::string with_bed(const std::string& keys, const std::string& law = "voellmy") {
    return "[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\ndepth = 2\n[time]\nend = 20\n"
           "[material.bed]\nlaw = \"" +
           law + "\"\n" + keys;
}

Scene scene_of(const std::string& text, const FakeGis& gis) {
    return build_scene(CaseFile::parse(text, "slide/case.toml"), gis);
}

std::string problem_of(const std::string& text) {
    return only_problem([&] { scene_of(text, slope_gis()); });
}

}  // namespace

TEST_CASE("Planes are open slopes, or flat where they are gentle, up to their edges", "[scene]") {
    check_all(terrain([](double x, double y) { return 2000.0 - 0.5 * x + 0.1 * y; }), kOpen);
    check_all(terrain([](double x, double) { return 2000.0 - 0.17 * x; }), kFlat);  // 9.6 degrees
    check_all(terrain([](double x, double) { return 2000.0 - 0.18 * x; }), kOpen);  // 10.2 degrees
    check_all(terrain([](double, double) { return 2000.0; }), kFlat);
}

TEST_CASE("A trough down a slope is channelled, a sharper one a gully, a ridge is convex", "[scene]") {
    const auto bent = [](double a) {
        return terrain([a](double x, double y) { return 3000.0 - 0.5 * x + a * (y - middle) * (y - middle); });
    };
    // On the axis the contour has the curvature 2 a / slope; the mean of squares adds a constant to a parabola.
    for (const double curvature : {0.004, 0.02, -0.004}) {
        const Raster bed = bent(0.5 * 0.5 * curvature);
        CHECK(plan_curvature(bed, 20, 15) == Approx(curvature).epsilon(1e-9));
        CHECK(plan_curvature(smoothed(bed, 50.0), 20, 15) == Approx(curvature).epsilon(1e-9));
        const std::uint8_t expected = curvature < 0 ? kFlat : curvature < 0.01 ? kChannelled : kGully;
        CHECK(ground_classes(bed, {})[15 * 41 + 20] == expected);
    }
    CHECK(ground_classes(bent(0.5 * 0.5 * 0.0015), {})[15 * 41 + 20] == kOpen);
}

TEST_CASE("A hollow cone has the curvature of its contours, whatever the direction", "[scene]") {
    const Raster bed = terrain([](double x, double y) { return 0.4 * std::hypot(x - 300.0, y - 600.0); });
    for (const auto& [i, j] : {std::pair<Index, Index>{5, 5}, {30, 10}, {20, 25}}) {
        const double radius = std::hypot(grid.x(i) - 300.0, grid.y(j) - 600.0);
        CHECK(plan_curvature(bed, i, j) == Approx(1.0 / radius).epsilon(1e-3));  // (cell / radius)^2 is 2e-4
    }
}

TEST_CASE("Nodata does not bend the adjacent ground", "[scene]") {
    Raster bed = terrain([](double x, double y) { return 2000.0 - 0.5 * x + 0.1 * y; });
    for (Index i = 18; i < 23; ++i) bed.at(i, 15) = Raster::nodata;
    check_all(bed, kOpen);
}

TEST_CASE("Ground is averaged over the length that is given, of cells that it cuts over a part", "[scene]") {
    // Of a single node that is higher, its row and column have the parts of the square's sides that lie on cells.
    for (const double cell : {5.0, 10.0, 30.0, 49.0, 50.0, 60.0}) {
        CAPTURE(cell);
        Raster bed = Raster::filled({21, 21, 0.0, 0.0, cell}, 0.0);
        bed.at(10, 10) = 1.0;
        const Raster mean = smoothed(bed, 50.0);
        for (Index d = 0; d <= 8; ++d) {
            const double half = std::max(25.0, 0.5 * cell), middle = cell * static_cast<double>(d);
            const double on_cell =
                std::max(0.0, std::min(half, middle + 0.5 * cell) - std::max(-half, middle - 0.5 * cell));
            CHECK(mean.at(10 + d, 10) == Approx(on_cell / (2.0 * half) * cell / (2.0 * half)).margin(1e-15));
        }
        double sum = 0.0;
        for (const double value : mean.values) sum += value;
        CHECK(sum == Approx(1.0).epsilon(1e-14));
    }
}

TEST_CASE("The sentence on the classes of ground says over what length they are taken", "[scene]") {
    const auto says = [](const std::string& length, const std::string& part) {
        const Scene scene = scene_of(with_bed("table = \"voellmy-salm\"\n" + length), slope_gis());
        return std::any_of(scene.log.begin(), scene.log.end(),
                           [&](const std::string& line) { return line.find(part) != std::string::npos; });
    };
    CHECK(says("", "terrain averaged over 50 m"));
    CHECK(says("curvature_length = 6\n", "terrain averaged over 6 m"));
    CHECK(says("curvature_length = 5\n", "terrain as its cells of 5 m have it"));
}

TEST_CASE("A scene has the table's mu and xi of its nodes, and says so", "[scene]") {
    const FakeGis gis = slope_gis();
    const Scene scene = scene_of(with_bed("table = \"voellmy-salm\"\nreturn_period = 100\nvolume_class = \"small\"\n"
                                          "altitude_limits = [150, 5000]\n"),
                                 gis);
    REQUIRE(scene.friction);
    CHECK(scene.friction->keys == std::vector<std::string>{"mu", "xi"});
    const auto grounds = ground_classes(scene.bed, {});
    bool low = false, mid = false;
    for (std::size_t k = 0; k < scene.bed.values.size(); ++k) {
        const std::size_t altitude = scene.bed.values[k] >= 150.0 ? 1 : 0;
        (altitude == 0 ? low : mid) = true;
        const auto law = std::get<bed::Voellmy>(scene.friction->laws.at(k));
        REQUIRE(law.mu == salm::mu[1][2][grounds[k]][altitude]);
        REQUIRE(law.xi == salm::xi[1][grounds[k]][altitude]);
    }
    CHECK((low && mid));
    CHECK(std::any_of(scene.log.begin(), scene.log.end(), [](const std::string& line) {
        return line.find("choice of frana's") != std::string::npos &&
               line.find("size small, 100 years") != std::string::npos;
    }));
}

TEST_CASE("Without a class the released volume tells the size, and zones win over the table", "[scene]") {
    FakeGis gis = slope_gis();
    const auto mu_of = [&](const std::string& keys, const std::string& more) {
        const Scene scene = scene_of(with_bed("table = \"voellmy-salm\"\n" + keys + more), gis);
        std::vector<double> mu;
        for (std::size_t k = 0; k < scene.bed.values.size(); ++k)
            mu.push_back(std::get<bed::Voellmy>(scene.friction->laws.at(k)).mu);
        return mu;
    };
    CHECK(mu_of("", "") == mu_of("volume_class = \"tiny\"\n", ""));  // 3000 m3
    CHECK(mu_of("", "") != mu_of("volume_class = \"small\"\n", ""));
    const auto zoned = mu_of("", "[[material.zone]]\nabove = -1000\nmu = 0.123\n");
    CHECK(static_cast<std::size_t>(std::count(zoned.begin(), zoned.end(), 0.123)) == zoned.size());
}

TEST_CASE("A size of snow that is not that of the volume is remarked upon", "[scene][remarks]") {
    // 3000 m3 are released, 1500 m2 with 2 m.
    const auto remark_with = [](const std::string& size, const std::string& more) {
        const std::string bed = "table = \"voellmy-salm\"\nvolume_class = \"" + size + "\"\n";
        for (const std::string& line : scene_of(with_bed(bed) + more, slope_gis()).log)
            if (line.find("volume_class") != std::string::npos) return line;
        return std::string();
    };
    const auto inflow = [](int volume) {
        return fmt::format(
            "[[inflow]]\nname = \"t\"\nline = [[1150, 2050], [1150, 2080]]\nvelocity = 8\npeak = 200\n"
            "volume = {}\n",
            volume);
    };
    CHECK(remark_with("tiny", "").empty());
    CHECK_THAT(
        remark_with("small", ""),
        Contains(
            "found \"small\" (5000 to 25000 m3), not \"tiny\" (below 5000 m3); expected the class of the 3000 m3"));
    CHECK(remark_with("small", inflow(4000)).empty());
    CHECK_THAT(remark_with("small", inflow(57000)),
               Contains("not \"large\" (60000 m3 or more)") && Contains("60000 m3 that"));
}

TEST_CASE("The size is that of the volume which is released, to the digit", "[scene]") {
    // Of the outline's 1500 m2 two thirds are 5 m deep, between middles of pixels: 5000 m3 and a litre, less, or more.
    FakeGis gis = slope_gis();
    const auto size_with = [&](double more) {
        gis.rasters["thick.tif"] = sampled({40, 30, 1002.5, 2002.5, 5.0}, [&](double x, double) {
            return x > 1050 && x < 1080 ? 5.0 + more : x > 1080 && x < 1100 ? 0.1 : 0.0;
        });
        std::string text = with_bed("table = \"voellmy-salm\"\n");
        text.replace(text.find("depth = 2"), 9, "depth = \"thick.tif\"");
        const Scene scene = scene_of(text, gis);
        double volume = 0.0;
        for (const double part : scene.particles.volume) volume += part;
        const auto said = [&](const char* size) {
            return std::any_of(scene.log.begin(), scene.log.end(), [&](const std::string& line) {
                return line.find(fmt::format("size {} (", size)) != std::string::npos;
            });
        };
        REQUIRE(said("tiny") != said("small"));
        return std::pair(volume, said("small"));
    };
    const double at_limit = (5000.0 - 0.1 * 600.0) / 900.0 - 5.0;
    const auto below = size_with(at_limit - 1e-4), above = size_with(at_limit + 1e-4);
    CHECK((below.first == Approx(5000.0 - 0.09) && above.first == Approx(5000.0 + 0.09)));
    CHECK((!below.second && above.second));
}

TEST_CASE("Rasters of the table's numbers are the table, bit for bit", "[scene]") {
    FakeGis gis = slope_gis();
    const Scene by_it = scene_of(with_bed("table = \"voellmy-salm\"\n"), gis);
    for (const char* name : {"mu", "xi"}) {
        Raster raster = by_it.bed;
        raster.values = bed::parameter_on_nodes(by_it.friction->laws, name);
        gis.rasters[std::string(name) + ".tif"] = raster;
    }
    const Scene by_hand = scene_of(with_bed("mu = \"mu.tif\"\nxi = \"xi.tif\"\n"), gis);
    for (const char* name : {"mu", "xi"})
        CHECK(bed::parameter_on_nodes(by_it.friction->laws, name) ==
              bed::parameter_on_nodes(by_hand.friction->laws, name));
    CHECK(by_it.friction->laws.place == by_hand.friction->laws.place);
}

TEST_CASE("What does not go with the table is said in a sentence", "[scene]") {
    const auto only = [](const std::string& keys) { return problem_of(with_bed(keys)); };
    const std::string table = "table = \"voellmy-salm\"\n";
    CHECK_THAT(only(table + "return_period = 50\n"), Contains("found 50") && Contains("10, 30, 100 or 300 years"));
    CHECK_THAT(only(table + "altitude_limits = [1500, 1000]\n"), Contains("found 1000 after 1500"));
    CHECK_THAT(only(table + "curvature_limits = [0.0, 0.02, 0.01]\n"), Contains("expected numbers that grow"));
    CHECK_THAT(only(table + "mu = 0.2\n"),
               Contains("material.bed.mu: found 0.2 with material.bed.table = \"voellmy-salm\""));
    CHECK_THAT(only(table + "volume_class = \"huge\"\n"), Contains("volume_class"));
    CHECK_THAT(only("mu = 0.2\nxi = 400\nreturn_period = 30\n"), Contains("return_period"));
    CHECK_THAT(problem_of(with_bed(table, "coulomb")), Contains("expected law = \"voellmy\""));
}
