// The slope of the free surface that drives a node, at margins.
#include <algorithm>
#include <cmath>

#include "analytic_scene.h"
#include "catch.h"
#include "solver/depth_averaged.h"
#include "solver/surface_gradient.h"

using namespace frana;

TEST_CASE("A film has the slope of its bed on every node, margins too, where the bed bends by more than the film is deep",
          "[surface]") {
    // A tenth of a millimetre on a bed that bends by 0.86 m a cell, and rises by as little as 3.5 m.
    const double cell = 24.0, depth = 1e-4;
    Scene scene = verify::scene_on(30, 24, cell, [](double x, double) { return 7.5e-4 * x * x; });
    verify::fill(scene, [&](double x, double y) { return x > 120 && x < 360 && y > 120 && y < 360 ? depth : 0.0; }, {1});
    DepthAveraged simulation(scene);
    simulation.advance(1e9);
    const Flow& flow = simulation.flow();
    double worst = 0.0;
    int margins = 0;
    for (Index j = 2; j < 22; ++j)
        for (Index i = 2; i < 28; ++i) {
            const Index k = flow.grid.at(i, j);
            const std::uint8_t flags = flow.nodes.flags[k];
            if (!(flags & kWet)) continue;
            margins += (flags & kMargin) != 0;
            const double slope = surface_gradient(flow, k, 1, flags & kWideX, flow.bed.slope_x[k]);
            worst = std::max(worst, std::abs(slope - flow.bed.slope_x[k]));
        }
    CHECK(margins == 13 * 13 - 9 * 9);  // two layers
    CHECK(worst <= depth / cell);  // its own depth may fall over a cell
}
