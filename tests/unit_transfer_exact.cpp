// The plain transfers against what they must reproduce exactly: fields linear in x and y, and the forces of one point.
#include "analytic_scene.h"
#include "catch.h"
#include "law/bed/bingham.h"
#include "shallow/transfer.h"

using namespace frana;

namespace {

constexpr double kRoundOff = 1e-12;  ///< sums of sixteen terms of some tens

Scene plane() {
    return verify::scene_on(40, 40, 2.0, [](double x, double y) { return 0.3 * x - 0.2 * y; });
}

/// Some points away from the sides, with velocities of their own.
void add_points(Flow& flow) {
    Particles& c = flow.particles;
    c.resize(7);
    for (Index p = 0; p < c.count(); ++p) {
        const double n = static_cast<double>(p);
        c.x[p] = 11.03 + 2.31 * n, c.y[p] = 9.57 + 1.73 * n;
        c.vx[p] = 1.0 + 0.3 * n, c.vy[p] = -0.5 * n;
        c.mass[p] = 1000.0 + n;
        c.depth[p] = 0.5 + 0.1 * n;
        c.r1x[p] = c.r2y[p] = 0.5;
        c.id[p] = p;
    }
    TileSorter().sort(c, flow.grid, {}, flow.active);
}

/// A velocity that is linear in x and y [m].
struct Linear2 {
    double bx, by, xx, xy, yx, yy;
    double vx(double x, double y) const { return bx + xx * x + xy * y; }
    double vy(double x, double y) const { return by + yx * x + yy * y; }
};
constexpr Linear2 kAfter{1.0, -2.0, 0.11, 0.07, -0.05, 0.03}, kBefore{0.4, 0.2, -0.02, 0.05, 0.08, 0.01};

constexpr double kWaveX = 0.02, kWaveY = -0.9;  // over a cell
constexpr double kKept = 0.75;                  // what friction left of the nodes' velocity
void set_nodes(Flow& flow) {
    for_each_work_tile(flow.active, [&](Index, Index tile) {
        for_each_node_of(flow.grid, tile, [&](Index k, Index i, Index j) {
            const double x = 2.0 * static_cast<double>(i), y = 2.0 * static_cast<double>(j);
            flow.nodes.motions()[k] = {kAfter.vx(x, y), kAfter.vy(x, y), 1.0,
                                       kWaveX * static_cast<double>(i) + kWaveY * static_cast<double>(j)};
            flow.nodes.velocity_share[k] = kKept;
            flow.nodes.before[k] = {kBefore.vx(x, y), kBefore.vy(x, y)};
        });
    });
}

}  // namespace

TEST_CASE("Every transfer shifts points by the slope of a two-cell wave", "[transfer]") {
    const Transfer transfer = GENERATE(Transfer::tpic, Transfer::apic, Transfer::pic, Transfer::flip);
    const Shape shape = GENERATE(Shape::linear, Shape::quadratic, Shape::cubic);
    const bool packed = GENERATE(false, true);
    if (transfer == Transfer::apic && shape == Shape::linear) return;
    if (packed && (transfer != Transfer::tpic || shape != Shape::quadratic)) return;
    Scene scene = plane();
    scene.scheme.transfer = transfer;
    scene.scheme.shape = shape;
    scene.scheme.wave_shift = 0.7;
    Flow flow(scene);
    add_points(flow);
    set_nodes(flow);
    const std::vector<double> x(flow.particles.x.begin(), flow.particles.x.end()),
        y(flow.particles.y.begin(), flow.particles.y.end());
    (packed ? make_packed_transfer(scene) : make_plain_transfer(scene))->gather(flow, 0.1);
    for (std::size_t p = 0; p < x.size(); ++p) {
        const double dx = 0.05 * kAfter.vx(2.0 * x[p], 2.0 * y[p]), dy = 0.05 * kAfter.vy(2.0 * x[p], 2.0 * y[p]);
        const double way = std::hypot(dx, dy);
        CHECK(flow.particles.x[p] == Approx(x[p] + dx - 0.7 * kWaveX * way).epsilon(kRoundOff));
        CHECK(flow.particles.y[p] == Approx(y[p] + dy + 0.5 * way).epsilon(kRoundOff));  // the most that is allowed
    }
}

TEST_CASE("Every transfer gathers a linear velocity and its gradient exactly", "[transfer]") {
    const Transfer transfer = GENERATE(Transfer::tpic, Transfer::apic, Transfer::pic, Transfer::flip);
    const Shape shape = GENERATE(Shape::linear, Shape::quadratic, Shape::cubic);
    if (transfer == Transfer::apic && shape == Shape::linear) return;  // its inertia is that of splines
    CAPTURE(static_cast<int>(transfer), static_cast<int>(shape));
    Scene scene = plane();
    scene.scheme.transfer = transfer;
    scene.scheme.shape = shape;
    Flow flow(scene);
    add_points(flow);
    set_nodes(flow);
    TransferKernel::Probe seen;
    make_plain_transfer(scene)->probe(flow, seen);
    const double keep = transfer == Transfer::flip ? scene.scheme.flip_ratio : 0.0;
    const Particles& c = flow.particles;
    for (std::size_t p = 0; p < seen.vx.size(); ++p) {
        const double x = 2.0 * c.x[p], y = 2.0 * c.y[p];
        // FLIP adds what forces changed on the nodes to the point's own velocity, leaves what friction left of the nodes',
        // and takes the rest from the nodes.
        CHECK(seen.vx[p] == Approx(kAfter.vx(x, y) + keep * kKept * (c.vx[p] - kBefore.vx(x, y))).epsilon(kRoundOff));
        CHECK(seen.vy[p] == Approx(kAfter.vy(x, y) + keep * kKept * (c.vy[p] - kBefore.vy(x, y))).epsilon(kRoundOff));
        CHECK(seen.cxx[p] == Approx(kAfter.xx).margin(kRoundOff));
        CHECK(seen.cxy[p] == Approx(kAfter.xy).margin(kRoundOff));
        CHECK(seen.cyx[p] == Approx(kAfter.yx).margin(kRoundOff));
        CHECK(seen.cyy[p] == Approx(kAfter.yy).margin(kRoundOff));
    }
}

TEST_CASE("The paper's pressure is g m h / 2 and its weight g m grad Z", "[transfer]") {
    Scene scene = plane();
    scene.scheme.transfer = Transfer::pic;
    scene.scheme.shape = GENERATE(Shape::linear, Shape::quadratic);
    scene.scheme.paper_pressure = true;
    Flow flow(scene);
    add_points(flow);
    make_plain_transfer(scene)->deposit(flow, 0.1);
    const Particles& c = flow.particles;
    double fx = 0.0, fy = 0.0, fx_x = 0.0, fy_y = 0.0;  // sums of the nodes' forces, and of their moments about (0, 0)
    for (const Index tile : flow.active.work)
        for_each_node_of(flow.grid, tile, [&](Index k, Index i, Index j) {
            const Deposit& node = flow.nodes.deposits()[k];
            fx += node.fx, fy += node.fy;
            fx_x += node.fx * 2.0 * static_cast<double>(i), fy_y += node.fy * 2.0 * static_cast<double>(j);
        });
    // The sum of grad N is 0, that of x_i grad N is 1: eq. 13 of Fois et al. 2024 summed over the nodes.
    double weight = 0.0, push = 0.0, weight_x = 0.0, weight_y = 0.0;
    for (Index p = 0; p < c.count(); ++p) {
        const double gm = scene.gravity * c.mass[p];
        weight += gm, push += 0.5 * gm * c.depth[p];
        weight_x += gm * 2.0 * c.x[p], weight_y += gm * 2.0 * c.y[p];
    }
    CHECK(fx == Approx(-0.3 * weight).epsilon(kRoundOff));
    CHECK(fy == Approx(0.2 * weight).epsilon(kRoundOff));
    CHECK(fx_x == Approx(push - 0.3 * weight_x).epsilon(kRoundOff));
    CHECK(fy_y == Approx(push + 0.2 * weight_y).epsilon(kRoundOff));
}

TEST_CASE("The paper's depth thins by the divergence of the velocity (eq. 30)", "[transfer]") {
    Scene scene = plane();
    scene.scheme.transfer = Transfer::pic;
    scene.scheme.shape = GENERATE(Shape::linear, Shape::quadratic);
    scene.scheme.paper_pressure = true;
    Flow flow(scene);
    add_points(flow);
    const auto transfer = make_plain_transfer(scene);
    transfer->deposit(flow, 0.1);
    set_nodes(flow);
    const Particles before = flow.particles;
    transfer->gather(flow, 0.1);
    for (Index p = 0; p < before.count(); ++p)
        CHECK(flow.particles.depth[p] == Approx(before.depth[p] / (1.0 + 0.1 * (0.11 + 0.03))).epsilon(kRoundOff));
}

TEST_CASE("On 45 degrees a Bingham sheet shears twice as fast as speed and depth of the map say", "[transfer]") {
    // Straight down the fall line: speed along the bed sqrt(2) of the map's, thickness 1 / sqrt(2) of the depth. Across it
    // only the thickness counts.
    const rheology::Bingham law{40.0, 300.0};
    for (const bool down : {true, false}) {
        Scene scene = verify::scene_on(61, 61, 1.0, [](double x, double) { return 100.0 - x; });
        scene.rheology = law;
        verify::fill(scene, [](double x, double y) { return std::hypot(x - 30, y - 30) < 20 ? 0.8 : 0.0; });
        const double a = 0.05, b = 0.02;  // [1/s]
        for (Index p = 0; p < scene.particles.count(); ++p) {
            const double x = scene.particles.x[p] - 30.0, y = scene.particles.y[p] - 30.0;
            scene.particles.vx[p] = (down ? 4.0 : 0.0) + a * x + b * y;
            scene.particles.vy[p] = (down ? 0.0 : 4.0);
        }
        DepthAveraged simulation(scene);
        const Frame frame = simulation.frame();
        const double *x = frame.particle("position")->data, *v = frame.particle("velocity")->data,
                     *h = frame.particle("depth")->data, *stress = frame.particle("stress")->data;
        const double plane = 0.5 * (a * a + a * a) + 0.25 * b * b, floor = scene.scheme.strain_rate_floor;
        int inside = 0;
        for (Index p = 0; p < frame.particle("depth")->count; ++p) {
            if (std::hypot(x[3 * p] - 30.0, x[3 * p + 1] - 30.0) > 10.0) continue;
            const double along = std::sqrt(2.0 * v[3 * p] * v[3 * p] + v[3 * p + 1] * v[3 * p + 1]);
            const double across = h[p] / std::sqrt(2.0);
            const double zeta = bed::bingham_sheet(0.0, 6.0 * law.viscosity * along / (law.yield_stress * across)).plug;
            const double shear = 3.0 / (2.0 + zeta) * along / across;
            const double mu2 =
                2.0 * law.viscosity + law.yield_stress / std::sqrt(plane + 0.25 * shear * shear + floor * floor);
            CHECK(stress[3 * p] == Approx(mu2 * a).epsilon(1e-10));
            CHECK(stress[3 * p + 2] == Approx(mu2 * 0.5 * b).epsilon(1e-10));
            ++inside;
        }
        CHECK(inside > 500);
    }
}
