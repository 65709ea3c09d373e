// A bed law that was added as src/README.md says: a case names it, and the depth-averaged solver runs by it.
#include <cmath>
#include <variant>

#include "base/constants.h"
#include "base/error.h"
#include "catch.h"
#include "scene/scene_parts.h"
#include "shallow/depth_averaged.h"

using namespace frana;

namespace {

// The library is compiled without the added law, and it has to find what a scene holds where it expects it.
template <class... Laws>
constexpr bool same_layout(const std::variant<Laws...>*) {
    using Without = std::variant<bed::None, bed::Coulomb, bed::Voellmy, bed::Manning, bed::Bingham, bed::Pouliquen>;
    return sizeof(std::variant<Laws...>) == sizeof(Without) && alignof(std::variant<Laws...>) == alignof(Without) &&
           sizeof...(Laws) == std::variant_size_v<Without> + 1;
}
static_assert(same_layout(static_cast<const BedLaw*>(nullptr)));

constexpr double kDegree = constants::kPi / 180.0;

CaseFile case_with(const std::string& keys) {
    return CaseFile::parse(
        "[terrain]\ndem = \"dem.tif\"\n[[release]]\ndepth = 1\n[time]\nend = 5\n[material.bed]\n" + keys, "case.toml");
}

/// A disc on a plane, so thin that its pressure has nothing to push: a block.
Scene block(const CaseFile& file, double slope) {
    Scene scene;
    set_physics(file, scene);
    GridGeometry grid;
    grid.nx = 41, grid.ny = 25, grid.cell = 1.0;
    scene.bed = Raster::filled(grid, 0.0);
    for (Index j = 0; j < grid.ny; ++j)
        for (Index i = 0; i < grid.nx; ++i) scene.bed.at(i, j) = -std::tan(slope) * grid.x(i);
    Seeds& seeds = scene.particles;
    for (double y = 8.25; y < 16.0; y += 0.5)
        for (double x = 8.25; x < 16.0; x += 0.5) {
            if (std::hypot(x - 12.0, y - 12.0) > 4.0) continue;
            constexpr double kDepth = 2e-7, kSize = 0.5;
            seeds.x.push_back(x), seeds.y.push_back(y), seeds.vx.push_back(0.0), seeds.vy.push_back(0.0);
            seeds.depth.push_back(kDepth), seeds.size.push_back(kSize), seeds.volume.push_back(kDepth * kSize * kSize);
        }
    return scene;
}

/// Means over all particles: place along the map [m], speed along the bed [m/s].
struct Mean {
    double x = 0.0, speed = 0.0;
};
Mean mean_of(Simulation& simulation) {
    const Frame frame = simulation.frame();
    const auto* place = frame.particle("position");
    Mean mean;
    for (Index p = 0; p < place->count; ++p)
        mean.x += place->data[3 * p], mean.speed += frame.particle("speed")->data[p];
    mean.x /= static_cast<double>(place->count), mean.speed /= static_cast<double>(place->count);
    return mean;
}

}  // namespace

TEST_CASE("An added bed law has its word, its keys and their checks in the table of keys", "[toy_law]") {
    CHECK(describe("material.bed.law").find("pouliquen is mu(I); viscous is a toy") != std::string::npos);
    CHECK(describe("drag_rate") ==
          "material.bed.drag_rate [1/s]\n    rate at which drag slows it\n    value:   a number above 0 [1/s] or the "
          "name "
          "of a raster\n    default: 0.5\n    only with material.bed.law = viscous\n"
          "material.zone.drag_rate [1/s]\n    rate at which drag slows it\n    value:   a number above 0 [1/s]\n"
          "    default: as without the zone\n");
    CHECK(describe("material.bed.mu").find("coulomb, voellmy, manning, bingham, viscous") != std::string::npos);
    CHECK_THROWS_WITH(case_with("law = \"viscous\"\nmu = 0.1\ndrag_rate = -1\n"),
                      Catch::Contains("material.bed.drag_rate: found -1; expected a number above 0 [1/s]"));
    CHECK_THROWS_WITH(case_with("law = \"viscous\"\n"), Catch::Contains("material.bed.law = \"viscous\" needs"));
    CHECK_THROWS_WITH(case_with("law = \"coulomb\"\nmu = 0.1\ndrag_rate = 1\n"),
                      Catch::Contains("material.bed.law = \"coulomb\" does not use it"));
}

TEST_CASE("An added bed law has its parameters from the case, or their defaults", "[toy_law]") {
    Scene scene;
    set_physics(case_with("law = \"viscous\"\nfriction_angle_deg = 45\n"), scene);
    REQUIRE(std::holds_alternative<bed::Viscous>(scene.bed_law));
    CHECK(std::get<bed::Viscous>(scene.bed_law).mu == std::tan(45.0 * constants::kPi / 180.0));
    CHECK(std::get<bed::Viscous>(scene.bed_law).rate == 0.5);
    CHECK(friction_at_rest(scene.bed_law) == std::tan(45.0 * constants::kPi / 180.0));
}

TEST_CASE("A block on a plane follows an added bed law's closed form", "[toy_law]") {
    constexpr double kMu = 0.1, kRate = 0.8, kEnd = 5.0, kSlope = 25.0 * kDegree;
    DepthAveraged run(block(case_with("law = \"viscous\"\nmu = 0.1\ndrag_rate = 0.8\n"), kSlope));
    const double start = mean_of(run).x;
    double longest = 0.0;
    while (run.status().time < kEnd) {
        const double before = run.status().time;
        run.advance(kEnd);
        longest = std::max(longest, run.status().time - before);
    }
    const double pull = 9.81 * (std::sin(kSlope) - kMu * std::cos(kSlope)), grown = 1.0 - std::exp(-kRate * kEnd);
    const Mean end = mean_of(run);
    // The thin disc's pressure and margins leave 1e-8 of it, as block_coulomb of tests/verification.txt shows.
    CHECK(end.speed == Approx(pull / kRate * grown).epsilon(1e-8));
    // Places go by the speed in the middle of a step: short of the way by at most dt^2 / 24 of the change of acceleration.
    const double way = pull / kRate * (kEnd - grown / kRate) * std::cos(kSlope);
    CHECK(std::abs(end.x - start - way) <= longest * longest / 24.0 * pull * grown * std::cos(kSlope) + 1e-8 * way);
}

TEST_CASE("A block on a plane no steeper than an added law's friction stays at rest", "[toy_law]") {
    DepthAveraged run(block(case_with("law = \"viscous\"\nmu = 0.5\n"), 25.0 * kDegree));
    const double start = mean_of(run).x;
    while (run.status().time < 1.0) run.advance(1.0);
    CHECK(mean_of(run).x == start);
    CHECK(mean_of(run).speed == 0.0);
}
