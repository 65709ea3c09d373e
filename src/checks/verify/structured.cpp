#include "checks/verify/structured.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace frana::verify {
namespace {

/// Sum over the points, whose order does not show in it: exact to the last bits (Neumaier 1974).
double mass_of(const StructuredFlow& flow) {
    double sum = 0.0, lost = 0.0;
    for (const double m : flow.body().points.mass) {
        const double next = sum + m;
        lost += std::abs(sum) >= m ? (sum - next) + m : (m - next) + sum;
        sum = next;
    }
    return sum + lost;
}

}  // namespace

void add_block(StructuredScene& scene, const StructuredBlock& block) {
    const double spacing = scene.grid.cell / block.per_side;
    const Index nx = std::lround((block.high.x() - block.low.x()) / spacing),
                ny = std::lround((block.high.y() - block.low.y()) / spacing);
    const double dx = (block.high.x() - block.low.x()) / static_cast<double>(nx),
                 dy = (block.high.y() - block.low.y()) / static_cast<double>(ny);
    for (Index j = 0; j < ny; ++j)
        for (Index i = 0; i < nx; ++i)
            scene.points.add({block.low.x() + (static_cast<double>(i) + 0.5) * dx,
                              block.low.y() + (static_cast<double>(j) + 0.5) * dy, block.velocity.x(),
                              block.velocity.y(), scene.density * block.depth * dx * dy, block.depth, block.cohesion,
                              block.damage});
}

GridGeometry grid_over(const Vec2& low, const Vec2& high, double cell) {
    constexpr double kRoom = 4.0;  // cells
    GridGeometry g;
    g.cell = cell;
    const double i0 = std::floor(low.x() / cell) - kRoom, j0 = std::floor(low.y() / cell) - kRoom;
    g.x0 = i0 * cell, g.y0 = j0 * cell;
    g.nx = static_cast<Index>(std::ceil(high.x() / cell) + kRoom - i0) + 1;
    g.ny = static_cast<Index>(std::ceil(high.y() / cell) + kRoom - j0) + 1;
    return g;
}

void add_channel(StructuredScene& scene, double low, double high) {
    Obstacle right, left;
    right.high.y() = low, left.low.y() = high;
    scene.obstacles.push_back(right), scene.obstacles.push_back(left);
}

Measurement run_structured(StructuredFlow& flow, double end, const std::function<void(const StructuredFlow&)>& each) {
    const auto start = std::chrono::steady_clock::now();
    const StructuredStatus first = flow.status();
    double given = std::sqrt(2.0 * first.kinetic * first.mass);  // of the points, whichever way they go
    const double mass = mass_of(flow);
    while (flow.status().time < end) {
        flow.advance(end);
        given = std::max(given, std::sqrt(2.0 * flow.status().kinetic * first.mass));
        if (each) each(flow);
    }
    const StructuredStatus& now = flow.status();
    Measurement m;
    m.particles = now.points;
    m.steps = now.step;
    m.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    m.mass_error = std::abs(mass_of(flow) + now.mass_left - mass) / mass;
    const StructuredImpulses& i = now.impulse;
    given += i.weight.norm() + i.pressure.norm() + i.friction.norm() + i.obstacles.norm();
    m.add("momentum_residual", given > 0.0 ? flow.momentum_residual().norm() / given : 0.0);
    return m;
}

double length_of(const StructuredFlow& flow) {
    double low = 1e300, high = -1e300;
    for (Index p = 0; p < flow.body().points.count(); ++p) {
        const double x = flow.position(p).x();
        low = std::min(low, x), high = std::max(high, x);
    }
    return high - low;
}

}  // namespace frana::verify
