// The pressure that particles have on their bed when they become 3D points.
#include "analytic_scene.h"
#include "catch.h"
#include "coupling/start_pressure.h"

using namespace frana;
using namespace frana::test;

namespace {

constexpr double kSlope = 0.4;  // dZ/dx

/// Particles on a grid over a plane bed, of the depth h(x), from x = 1 to 8 m; bed_pressure is not filled.
FlowParticles particles(const Scene& scene, const std::function<double(double x)>& depth, double spacing) {
    FlowParticles c;
    for (double y = 0.5 * spacing; y < 3.0; y += spacing)
        for (double x = 1.0 + 0.5 * spacing; x < 8.0; x += spacing) {
            if (!(depth(x) > 0.0)) continue;
            c.x.push_back(x), c.y.push_back(y);
            c.bed.push_back(kSlope * x);
            c.depth.push_back(depth(x));
        }
    c.vx = c.vy = c.mass = c.volume = c.bed_pressure = c.id = std::vector<double>(c.count(), 1.0);
    take_slopes(c, scene.bed);
    return c;
}

Scene slope() {
    return scene_on(11, 4, 1.0, [](double x, double) { return kSlope * x; });
}

/// Largest and least bed pressure over rho g h.
std::pair<double, double> share(const FlowParticles& c, const Scene& scene) {
    double low = 1e9, high = -1e9;
    for (std::size_t k = 0; k < c.count(); ++k) {
        const double s = c.bed_pressure[k] / (scene.density * scene.gravity * c.depth[k]);
        low = std::min(low, s), high = std::max(high, s);
    }
    return {low, high};
}

}  // namespace

TEST_CASE("A lake bears its whole weight on a slope, a sheet cos^2 of it, up to their margins", "[stages]") {
    const Scene scene = slope();
    const double cos2 = 1.0 / (1.0 + kSlope * kSlope);
    for (const double spacing : {1.0, 0.5, 0.25}) {
        CAPTURE(spacing);
        FlowParticles lake = particles(
            scene, [](double x) { return 3.0 - kSlope * x; }, spacing);
        take_start_pressure(lake, scene);
        CHECK(share(lake, scene).first == Approx(1.0).epsilon(1e-12));
        CHECK(share(lake, scene).second == Approx(1.0).epsilon(1e-12));
        FlowParticles sheet = particles(
            scene, [](double) { return 0.7; }, spacing);
        take_start_pressure(sheet, scene);
        CHECK(share(sheet, scene).first == Approx(cos2).epsilon(1e-12));
        CHECK(share(sheet, scene).second == Approx(cos2).epsilon(1e-12));
    }
}

TEST_CASE("The pressure at the start lies between a lake's and a sheet's, whatever the surface", "[stages]") {
    const Scene scene = slope();
    const double cos2 = 1.0 / (1.0 + kSlope * kSlope);
    const double half = 1.0 / (1.0 + 0.5 * kSlope * kSlope);  // surface half as steep as the bed
    for (const auto& [rise, expected] : {std::pair{-2.0, 1.0}, {-0.5 * kSlope, half}, {3.0, cos2}}) {
        CAPTURE(rise);
        const double r = rise;
        FlowParticles c = particles(
            scene, [&](double x) { return (r < 0.0 ? 20.0 : 1.0) + r * x; }, 0.5);
        take_start_pressure(c, scene);
        CHECK(share(c, scene).first == Approx(expected).epsilon(1e-12));
        CHECK(share(c, scene).second == Approx(expected).epsilon(1e-12));
    }
    FlowParticles one = particles(
        scene, [](double x) { return x < 1.3 ? 1.0 : 0.0; }, 0.5);
    one.x.resize(1);
    for (auto* list : {&one.y, &one.bed, &one.depth, &one.vx, &one.vy, &one.mass, &one.volume, &one.bed_pressure,
                       &one.id, &one.slope_x, &one.slope_y})
        list->resize(1);
    take_start_pressure(one, scene);
    CHECK(share(one, scene).first == Approx(cos2).epsilon(1e-12));  // nothing is known of its surface
}

TEST_CASE("A particle alone has a pressure wherever it stands, and one of two in a row has", "[stages]") {
    const Scene scene = slope();
    for (int n = 1; n < 400; ++n) {
        const double x = 1.0 + 0.0071 * n, y = 1.0 + 0.0053 * n;
        FlowParticles c = particles(
            scene, [](double at) { return at < 1.3 ? 1.0 : 0.0; }, 0.5);
        const std::size_t count = n % 2 ? 1 : 2;
        for (auto* list : {&c.x, &c.y, &c.bed, &c.depth, &c.vx, &c.vy, &c.mass, &c.volume, &c.bed_pressure, &c.id,
                           &c.slope_x, &c.slope_y})
            list->resize(count);
        for (std::size_t k = 0; k < count; ++k) c.x[k] = x + 0.1 * static_cast<double>(k), c.y[k] = y;
        take_start_pressure(c, scene);
        CAPTURE(x, y);
        for (std::size_t k = 0; k < count; ++k) CHECK(std::isfinite(c.bed_pressure[k]));
    }
}
