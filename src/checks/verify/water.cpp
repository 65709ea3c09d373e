#include "checks/verify/water.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace frana::verify {
namespace {

template <class Body>
void for_each_cell(const WaterFlow& flow, Body&& body) {
    const GridGeometry& g = flow.body().grid.geometry();
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) body(i, j);
}

/// All momentum that the water can have had, whichever way it went.
double momentum_scale(const WaterStatus& s) { return std::sqrt(2.0 * s.kinetic * s.volume); }

}  // namespace

GridGeometry cells_over(Index nx, Index ny, double cell) {
    GridGeometry g;
    g.nx = nx, g.ny = ny, g.cell = cell;
    g.x0 = g.y0 = 0.5 * cell;
    return g;
}

double cell_mean(const Function& f, double x, double y, double cell) {
    constexpr int parts = 8;
    double sum = 0.0;
    for (int b = 0; b < parts; ++b)
        for (int a = 0; a < parts; ++a)
            sum += f(x + ((a + 0.5) / parts - 0.5) * cell, y + ((b + 0.5) / parts - 0.5) * cell);
    return sum / (parts * parts);
}

Measurement run_water(WaterFlow& flow, double end, const std::function<void(const WaterFlow&)>& each) {
    const auto start = std::chrono::steady_clock::now();
    double scale = momentum_scale(flow.status());
    while (flow.status().time < end) {
        flow.advance(end);
        scale = std::max(scale, momentum_scale(flow.status()));
        if (each) each(flow);
    }
    Measurement m;
    m.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const WaterStatus& now = flow.status();
    const WaterLedger& l = now.ledger;
    m.steps = now.step;
    for_each_cell(flow, [&](Index i, Index j) { m.particles += flow.at(i, j).depth > 0.0; });
    m.mass_error = std::abs(flow.volume_residual()) / (now.volume_given + l.rained);
    scale += l.ground.norm() + l.walls.norm() + l.friction.norm();
    m.add("momentum_residual", scale > 0.0 ? flow.momentum_residual().norm() / scale : 0.0);
    return m;
}

void add_norms(const WaterFlow& flow, const ExactWater& exact, Measurement& m) {
    const GridGeometry& g = flow.body().grid.geometry();
    double e1 = 0, e2 = 0, em = 0, h1 = 0, h2 = 0, hm = 0, p1 = 0, p2 = 0, q1 = 0, q2 = 0;
    for_each_cell(flow, [&](Index i, Index j) {
        const double x = g.x(i), y = g.y(j), h = exact.depth(x, y);
        const WaterState s = flow.at(i, j);
        const double error = std::abs(s.depth - h);
        e1 += error, e2 += error * error, em = std::max(em, error);
        h1 += h, h2 += h * h, hm = std::max(hm, h);
        if (!exact.u) return;
        const Vec2 q = h * Vec2(exact.u(x, y), exact.v ? exact.v(x, y) : 0.0), miss = s.depth * Vec2(s.u, s.v) - q;
        p1 += miss.norm(), p2 += miss.squaredNorm(), q1 += q.norm(), q2 += q.squaredNorm();
    });
    m.l1_depth = e1 / h1, m.l2_depth = std::sqrt(e2 / h2), m.linf_depth = em / hm;
    if (q1 > 0.0) m.l1_momentum = p1 / q1, m.l2_momentum = std::sqrt(p2 / q2);
}

double energy_of(const WaterFlow& flow) {
    const WaterBody& body = flow.body();
    double potential = 0.0;
    for_each_cell(flow, [&](Index i, Index j) {
        const double h = flow.at(i, j).depth;
        potential += h * (flow.surface(i, j) - 0.5 * h);
    });
    return flow.status().kinetic + body.gravity * body.grid.cell() * body.grid.cell() * potential;
}

}  // namespace frana::verify
