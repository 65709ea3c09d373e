// Where parameters vary spatially. A block slides from one friction onto another, at any angle to the grid. Two layers
// of different viscosity slide past one another.
#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "checks/verify/library.h"
#include "checks/verify/slide.h"

namespace frana::verify {
namespace {

/// All along the slope. The border of the zones is at 0, the block starts `way` above it.
struct TwoZones {
    double slope_deg = 25.0, before = 0.2, behind = 0.6, way = 100.0, gravity = 9.81;

    double slope() const { return slope_deg * constants::kPi / 180.0; }
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

/// A blob of some cells. Its parts cross the border one after the other, and so it is no rigid block until cells are
/// small.
Slid slide_over(const TwoZones& zones, const Setup& setup, double turn_deg, Measurement& m) {
    const double cosine = std::cos(zones.slope()), cell = 100.0 / static_cast<double>(setup.cells);
    const Function plane = [t = std::tan(zones.slope())](double s, double) { return -t * s; };
    Slide slide{cell, turn_deg * constants::kPi / 180.0, kBorder * cell - zones.way * cosine,
                (zones.stop() + 20.0) * cosine};
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
    Measurement quarter;
    m.add("quarter_error", slide_over(zones, setup, 90.0, quarter).stop / slid.stop - 1);
    return m;
}

/// A layer on level ground slides along x, its halves in opposite directions. Each half is a rheology's zone. The speed
/// diffuses as heat does between two bodies in contact. The border has one speed at all times (Carslaw and Jaeger 1959,
/// chapter 2; src/shallow/THEORY.md, section 19).
struct TwoLayers {
    double below = 0.1, above = 0.9;  ///< kinematic viscosity [m^2/s]
    double speed = 0.5;               ///< of the upper half, the lower has its opposite [m/s]

    double border_speed() const {
        return speed * (std::sqrt(above) - std::sqrt(below)) / (std::sqrt(above) + std::sqrt(below));
    }
    double at(double y, double time) const {
        const double nu = y > 0.0 ? above : below, far = y > 0.0 ? speed : -speed;
        return border_speed() + (far - border_speed()) * std::erf(std::abs(y) / std::sqrt(4.0 * nu * time));
    }
};

std::vector<Residual> contact_residuals() {
    const TwoLayers layers;
    const double t = 10.0, d = 1e-3;
    const auto u = [&](double y, double time) { return layers.at(y, time); };
    const auto diffuses = [&](double y, double nu) {
        const double rate = (u(y, t + d) - u(y, t - d)) / (2 * d);
        return rate - nu * (u(y + d, t) - 2 * u(y, t) + u(y - d, t)) / (d * d);
    };
    // Slopes at the border by one-sided differences: the second one cancels the first order.
    const auto slope = [&](double side) {
        return side * (4 * u(side * d, t) - u(2 * side * d, t) - 3 * u(0, t)) / (2 * d);
    };
    return {{"diffusion above", diffuses(1.0, layers.above), 1e-8},
            {"diffusion below", diffuses(-1.0, layers.below), 1e-8},
            {"stress at the border", layers.above * slope(1) - layers.below * slope(-1), 1e-8},
            {"speed at the border", layers.border_speed() - 0.25, 1e-15}};
}

constexpr double kContactWidth = 40.0, kContactEnd = 10.0;  // [m], [s]

/// Steps are so short that no stress is capped. 2 nu dt / cell^2 is below scheme.stress_cap at the speed of flow and waves.
double contact_cfl(const Scene& scene, const TwoLayers& layers, double cell) {
    const double signal = layers.speed + std::sqrt(scene.gravity), longest = 0.2 * cell * cell / (2 * layers.above);
    return signal * longest / cell;
}

Measurement run_zone_contact(const Setup& setup) {
    const TwoLayers layers;
    const double cell = kContactWidth / static_cast<double>(setup.cells), border = (kBorder * cell);
    Scene scene = scene_on(
        setup.cells + 1, setup.cells + 1, cell, [](double, double) { return 0.0; }, -0.5 * kContactWidth,
        -0.5 * kContactWidth);
    scene.gravity = 0.1;  // waves from the ends are slow
    scene.sides = Sides::wall;
    fill(scene, [](double, double) { return 1.0; }, {setup.per_side});
    scene.particles.vx.clear();
    for (const double y : scene.particles.y) scene.particles.vx.push_back(y > border ? layers.speed : -layers.speed);
    scene.particles.vy.assign(scene.particles.y.size(), 0.0);
    std::vector<rheology::Newtonian> laws;
    for (Index j = 0; j < scene.bed.geometry.ny; ++j)
        for (Index i = 0; i < scene.bed.geometry.nx; ++i)
            laws.push_back({scene.density * (scene.bed.geometry.y(j) > border ? layers.above : layers.below)});
    Friction friction;
    friction.rheologies = rheology::law_map(laws);
    scene.friction = std::make_shared<const Friction>(std::move(friction));
    scene.rheology = laws.front();
    Setup own = setup;
    own.edit = [&](Scene& s) {
        s.scheme.cfl = contact_cfl(s, layers, cell);
        if (setup.edit) setup.edit(s);
    };
    Trial trial(std::move(scene), own);
    trial.run_to(kContactEnd);
    Exact exact;
    exact.depth = [](double, double) { return 1.0; };
    exact.u = [&](double, double y) { return layers.at(y - border, kContactEnd); };
    exact.v = [](double, double) { return 0.0; };
    exact.where = [](double x, double y) { return std::abs(x) < 5.0 && std::abs(y) < 15.0; };
    Measurement m = trial.measure(exact);
    double across = 0.0, count = 0.0;  // of the nodes on either side of the border
    const Frame frame = trial.simulation().frame();
    for (Index j = 0; j < frame.grid.ny; ++j)
        for (Index i = 0; i < frame.grid.nx; ++i)
            if (exact.where(frame.grid.x(i), frame.grid.y(j)) && std::abs(frame.grid.y(j) - border) < cell)
                across += frame.node("velocity")->data[3 * (j * frame.grid.nx + i)], count += 1.0;
    double expected = 0.5 * (layers.at(0.5 * cell, kContactEnd) + layers.at(-0.5 * cell, kContactEnd));
    m.add("border_error", across / count / expected - 1);
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
                   {0, "quarter_error", 1e-12, "a quarter of a turn maps the grid onto itself: rounding"},
                   {0, "mass_error", 1e-13, "round-off"}};
    Problem contact{"zone_contact",
                    "halves of a layer that slide past one another, viscosity 1 to 9: the speed of the border",
                    {24, 50, 100},
                    contact_residuals,
                    run_zone_contact};
    contact.order_of = "l1_momentum";
    contact.gates = {{100, "l1_momentum", 0.025, "below first order, since the layers start with a jump; a fifth more"},
                     {100, "border_error", 0.05, "likewise"},
                     {0, "mass_error", 1e-13, "round-off"}};
    return {block, contact};
}

}  // namespace frana::verify
