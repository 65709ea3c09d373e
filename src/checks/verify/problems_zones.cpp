// A block that slides from one friction onto another, at any angle to the grid: how fast it comes, and where it stops.
#include <algorithm>
#include <cmath>

#include "checks/verify/library.h"
#include "checks/verify/slide.h"

namespace frana::verify {
namespace {

/// All along the slope. The border of the zones is at 0, the block starts `way` above it.
struct TwoZones {
    double slope_deg = 25.0, before = 0.2, behind = 0.6, way = 100.0, gravity = 9.81;

    double slope() const { return slope_deg * M_PI / 180; }
    double acceleration(double mu) const { return gravity * (std::sin(slope()) - mu * std::cos(slope())); }
    /// src/shallow/THEORY.md (77)
    double border_speed() const { return std::sqrt(2 * acceleration(before) * way); }
    double stop() const { return way * (std::tan(slope()) - before) / (behind - std::tan(slope())); }
    double time() const { return border_speed() / acceleration(before) - border_speed() / acceleration(behind); }
};

std::vector<Residual> zone_residuals() {
    const TwoZones zones;
    const double lost =
        zones.gravity * std::cos(zones.slope()) * (zones.before * zones.way + zones.behind * zones.stop());
    const double fall = zones.gravity * std::sin(zones.slope()) * (zones.way + zones.stop());
    return {{"printed speed at the border", zones.border_speed() - 21.761017, 5.1e-7},
            {"printed way behind it", zones.stop() - 199.194400, 5.1e-7},
            {"work of friction over that of gravity", lost / fall - 1, 1e-14}};
}

/// A border of zones along nodes' rows lies halfway between them.
constexpr double kBorder = 0.5;  // [cells]

/// The nodes of each zone have its Coulomb friction.
std::shared_ptr<const Friction> friction_of(const TwoZones& zones, const GridGeometry& grid, const Slide& slide) {
    std::vector<bed::Coulomb> laws;
    for (Index j = 0; j < grid.ny; ++j)
        for (Index i = 0; i < grid.nx; ++i) {
            const bool before = slide.along(grid.x(i), grid.y(j)) < kBorder * grid.cell;
            laws.push_back({before ? zones.before : zones.behind});
        }
    return std::make_shared<const Friction>(Friction{bed::law_map(laws), {"mu"}, {}});
}

struct Slid {
    double stop, speed, drift;
};

/// A blob of some cells: its parts cross the border one after the other, and so it is no rigid block until cells are
/// small.
Slid slide_over(const TwoZones& zones, const Setup& setup, double turn_deg, Measurement& m) {
    const double cosine = std::cos(zones.slope()), cell = 100.0 / static_cast<double>(setup.cells);
    const Function plane = [t = std::tan(zones.slope())](double s, double) { return -t * s; };
    Slide slide{cell, turn_deg * M_PI / 180, kBorder * cell - zones.way * cosine, (zones.stop() + 20.0) * cosine};
    slide.per_side = setup.per_side;
    Scene scene = slide.scene(plane);
    scene.friction = friction_of(zones, scene.bed.geometry, slide);
    Trial trial(std::move(scene), setup);
    const BlobState start = blob_state(trial, slide, plane);
    double fastest = 0.0;
    trial.run_to(1.2 * zones.time(), [&](const Status& now) { fastest = std::max(fastest, now.mean_speed); });
    const BlobState end = blob_state(trial, slide, plane);
    m = trial.measure();
    return {(end.along - start.along) / cosine - zones.way, fastest, std::abs(end.across - start.across)};
}

Measurement run_zone_block(const Setup& setup) {
    const TwoZones zones;
    Measurement m;
    double turned = 0.0, drift = 0.0;
    for (const double turn : {27.0, 45.0}) {
        const Slid slid = slide_over(zones, setup, turn, m);
        turned = std::max(turned, std::abs(slid.stop / zones.stop() - 1));
        drift = std::max(drift, slid.drift);
    }
    const Slid slid = slide_over(zones, setup, 0.0, m);
    m.add("stop_error", slid.stop / zones.stop() - 1);
    m.add("speed_error", slid.speed / zones.border_speed() - 1);
    m.add("turned_error", turned);
    m.add("cross_drift", drift, "m");
    return m;
}

}  // namespace

std::vector<Problem> zone_problems() {
    Problem block{"zone_block",
                  "thin block on 25 degrees from mu 0.2 onto 0.6, turned 0 to 45 degrees: stops 199.2 m behind",
                  {25, 50, 100, 200},
                  zone_residuals,
                  run_zone_block};
    block.order_of = "turned_error";
    block.gates = {{100, "stop_error", 5e-4, "a tenth of a cell of 1 m"},
                   {100, "turned_error", 4e-3, "half of what a border does that lies half a cell off"},
                   {100, "speed_error", 4e-3, "first order: the block crosses the border in its own length"},
                   {0, "mass_error", 1e-13, "round-off"}};
    return {block};
}

}  // namespace frana::verify
