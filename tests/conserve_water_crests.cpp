// Free water at bends of the ground that one cell resolves: it goes over crests, and gains no more than it falls.
#include <cmath>

#include "base/constants.h"
#include "catch.h"
#include "checks/verify/water.h"
#include "water/water_flow.h"

using namespace frana;

namespace {

constexpr double g = constants::kGravity;

/// A pool of 6 cells of 5 m at the level 100 m, a crest, and ground behind it that ends at an open side.
struct Pool {
    double crest;                            ///< above the pool's ground [m]
    std::function<double(double x)> behind;  ///< ground from the crest's cell on, at the distance from its middle [m]
    double over;                             ///< of the lake at the start, above the crest [m]
};

constexpr double kCell = 5.0;
constexpr Index kPool = 6;

WaterScene scene_of(const Pool& pool) {
    const double from = kCell * (kPool + 0.5);  // the crest's middle
    WaterScene s;
    s.grid = verify::cells_over(16, 4, kCell);
    s.bed = [=](double x, double) { return 100.0 + (x < from - 1.0 ? 0.0 : pool.behind(x - from)); };
    s.start = [=](double x, double) { return WaterState{x < from - 1.0 ? pool.crest + pool.over : 0.0}; };
    s.sides = {WaterSide::wall, WaterSide::open, WaterSide::wall, WaterSide::wall};
    return s;
}

/// Level of the lake above the crest after a time [m].
double left_over(WaterFlow& flow, const Pool& pool, double time) {
    while (flow.status().time < time) flow.advance(time);
    return flow.surface(1, 1) - 100.0 - pool.crest;
}

}  // namespace

// It stood there at rest, up to a third of the drop behind the wall.
TEST_CASE("A lake runs over a wall of one cell down to its crest, however deep it falls", "[water][conserve]") {
    const double height = GENERATE(1.0, 3.0, 10.0, 30.0), over = GENERATE(0.1, 0.3);
    CAPTURE(height, over);
    const Pool pool{height, [=](double d) { return d < 1.0 ? height : 0.0; }, over * height};
    WaterFlow flow(scene_of(pool));
    const double time = 600.0, left = left_over(flow, pool, time);
    // A broad crest lets (2/3)^1.5 sqrt(g) h^1.5 pass. The lake is then at (2 L / (that t))^2, if it was high at first.
    const double passes = std::pow(2.0 / 3.0, 1.5) * std::sqrt(g),
                 by_weir = std::pow(2.0 * kPool * kCell / (passes * time), 2);
    CHECK(left > -0.05);          // it swings
    CHECK(left < 4.0 * by_weir);  // half of the weir's discharge would do
    CHECK(std::abs(flow.volume_residual()) < 1e-12 * flow.status().volume_given);
}

// On the lowest cell of the slope 3 mm stood at 27 m/s, with nothing before or behind.
TEST_CASE("Water that runs down behind a crest is no faster than a front after its fall", "[water][conserve]") {
    const double run = GENERATE(1.0, 2.0, 3.0, 5.0, 10.0), over = GENERATE(0.3, 1.5);
    CAPTURE(run, over);
    const Pool pool{3.0, [=](double d) { return std::max(0.0, 3.0 - std::max(0.0, d) / run); }, over};
    WaterFlow flow(scene_of(pool));
    const double front = 2.0 * std::sqrt(g * over), fastest = std::sqrt(front * front + 2.0 * g * 3.0);
    double most = 0.0;
    while (flow.status().time < 1200.0) {
        flow.advance(1200.0);
        for (Index i = 0; i < 16; ++i) {
            const auto at = flow.at(i, 1);
            if (at.depth > 1e-4) most = std::max(most, std::hypot(at.u, at.v));  // a film slides on as a block does
        }
    }
    CHECK(most < fastest);
    CHECK(flow.surface(1, 1) - 103.0 < 0.01);
}

TEST_CASE("Over a crest of more and more cells flows what a broad weir lets pass", "[water][conserve]") {
    const double q = 1.0, head = 1.5 * std::cbrt(q * q / g);  // at the critical depth on the crest
    double last = INFINITY;
    for (const Index per : {1, 2, 4, 8}) {
        const double cell = kCell / static_cast<double>(per);
        WaterScene s;
        s.grid = verify::cells_over(20 * per, 4, cell);
        s.bed = [](double x, double) {
            const double d = std::abs(x - 60.0) - 5.0;  // a crest 10 m long, faces 1 : 2
            return std::max(0.0, 4.0 - 0.5 * std::max(0.0, d));
        };
        s.steep = false;  // as in the formula
        s.start = [](double x, double) {
            return WaterState{x < 55.0 ? 4.0 - std::max(0.0, 4.0 - 0.5 * std::max(0.0, 55.0 - x)) : 0.0};
        };
        s.sides = {WaterSide::wall, WaterSide::open, WaterSide::wall, WaterSide::wall};
        const double all = q * 4.0 * cell;
        WaterSource source{{0.0, 1e6}, {all, all}, {0.1, 0.1}, {}};
        for (Index j = 0; j < 4; ++j) source.places.push_back({2, j, 0.25, Vec2(1.0, 0.0)});
        s.sources = {source};
        WaterFlow flow(s);
        while (flow.status().time < 900.0) flow.advance(900.0);
        const double found = flow.surface(8 * per, 1) - 4.0, error = std::abs(found / head - 1.0);
        CAPTURE(per, found, head);
        CHECK(found > head);
        CHECK(error < last);
        last = error;
    }
    CHECK(last < 0.0625);  // as much as the last cell is of the crest: first order
}
