#include "checks/verify/trial.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "observe/budget.h"

namespace frana::verify {
namespace {

/// Calls body(x, y, s) for the lattice's places inside the grid; s is their spacing [m].
template <class Body>
void for_each_place(const Scene& scene, const Lattice& lattice, Body&& body) {
    const GridGeometry& g = scene.bed.geometry;
    const double s = g.cell / lattice.per_side;
    for (Index j = 0; j < (g.ny - 1) * lattice.per_side; ++j)
        for (Index i = 0; i < (g.nx - 1) * lattice.per_side; ++i) {
            const double x = g.x0 + (static_cast<double>(i) + 0.5) * s + lattice.shift_x * g.cell;
            const double y = g.y0 + (static_cast<double>(j) + 0.5) * s + lattice.shift_y * g.cell;
            if (x >= g.x0 && x <= g.x_max() && y >= g.y0 && y <= g.y_max()) body(x, y, s);
        }
}

void add_point(Seeds& seeds, double x, double y, double depth, double volume, double size) {
    seeds.x.push_back(x);
    seeds.y.push_back(y);
    seeds.vx.push_back(0.0);
    seeds.vy.push_back(0.0);
    seeds.volume.push_back(volume);
    seeds.depth.push_back(depth);
    seeds.size.push_back(size);
}

/// Sums |q - q_e| and |q_e| and gives the relative norms.
struct NormSums {
    double e1 = 0, e2 = 0, em = 0, q1 = 0, q2 = 0, qm = 0;
    void add(double error, double size) {
        e1 += error, e2 += error * error, em = std::max(em, error);
        q1 += size, q2 += size * size, qm = std::max(qm, size);
    }
    Norms norms() const { return {e1 / q1, std::sqrt(e2 / q2), em / qm}; }
};

template <class Body>
void for_each_counted(const Frame& frame, const Exact& exact, Body&& body) {
    for (Index j = 0; j < frame.grid.ny; ++j)
        for (Index i = 0; i < frame.grid.nx; ++i) {
            const double x = frame.grid.x(i), y = frame.grid.y(j);
            if (!exact.where || exact.where(x, y)) body(j * frame.grid.nx + i, x, y);
        }
}

}  // namespace

Scene scene_on(Index nx, Index ny, double cell, const Function& bed, double x0, double y0) {
    Scene scene;
    GridGeometry g;
    g.nx = nx;
    g.ny = ny;
    g.cell = cell;
    g.x0 = x0;
    g.y0 = y0;
    scene.bed = Raster::filled(g, 0.0);
    for (Index j = 0; j < ny; ++j)
        for (Index i = 0; i < nx; ++i) scene.bed.at(i, j) = bed(g.x(i), g.y(j));
    return scene;
}

void fill(Scene& scene, const Function& depth, const Lattice& lattice) {
    for_each_place(scene, lattice, [&](double x, double y, double s) {
        const double h = depth(x, y);
        if (h > 0.0) add_point(scene.particles, x, y, h, h * s * s, s);
    });
}

void fill_cut(Scene& scene, const Function& depth, const Lattice& lattice) {
    constexpr int parts = 8;
    for_each_place(scene, lattice, [&](double x, double y, double s) {
        double sum = 0.0;
        for (int b = 0; b < parts; ++b)
            for (int a = 0; a < parts; ++a)
                sum += std::max(0.0, depth(x + ((a + 0.5) / parts - 0.5) * s, y + ((b + 0.5) / parts - 0.5) * s));
        const double mean = sum / (parts * parts);
        if (mean > 0.0) add_point(scene.particles, x, y, mean, mean * s * s, s);
    });
}

void set_preset(Scene& scene, const std::string& preset) {
    scene.scheme.preset = preset == "float" ? "default" : preset;
    if (preset == "float") scene.scheme.precision = Precision::single;
    Scheme& s = scene.scheme;
    if (preset == "fast") s.split_length = 1.0, s.split_min_mass = 0.1;
    if (preset != "paper") return;
    scene.terrain = TerrainModel::shallow;
    scene.curvature = Curvature::none;
    s.shape = Shape::linear;
    s.transfer = Transfer::pic;
    s.cfl = 0.25;
    s.filter = s.viscosity_linear = s.viscosity_quadratic = 0.0;
    s.split = s.merge = s.reset_domains = s.mass_fit = false;
    s.paper_pressure = true;
}

Trial::Trial(Scene scene, const Setup& setup, bool keep_terrain) : scene_(std::move(scene)) {
    const TerrainModel terrain = scene_.terrain;
    const Curvature curvature = scene_.curvature;
    set_preset(scene_, setup.preset);
    if (keep_terrain) scene_.terrain = terrain, scene_.curvature = curvature;
    if (setup.edit) setup.edit(scene_);
    const Scheme& s = scene_.scheme;  // other kernels have no float
    if (s.shape != Shape::quadratic || s.transfer != Transfer::tpic) scene_.scheme.precision = Precision::full;
    simulation_ = std::make_unique<DepthAveraged>(scene_);
    first_ = simulation_->frame().status;  // a frame has the kinetic energy before the first step
}

void Trial::run_to(double end, const std::function<void(const Status&)>& each) {
    const auto start = std::chrono::steady_clock::now();
    while (simulation_->status().time < end) {
        simulation_->advance(end);
        peak_kinetic_ = std::max(peak_kinetic_, simulation_->status().kinetic);
        if (each) each(simulation_->status());
    }
    wall_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void Trial::run_to_rest(double latest) {
    const auto start = std::chrono::steady_clock::now();
    do {
        simulation_->advance(latest);
        peak_kinetic_ = std::max(peak_kinetic_, simulation_->status().kinetic);
    } while (simulation_->status().time < latest && simulation_->status().max_speed_on_map > 0.0);
    wall_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

Measurement Trial::measure(const Exact& exact) {
    const Frame frame = simulation_->frame();
    const Budget budget_now = budget(first_, frame.status);
    Measurement m;
    m.particles = frame.status.particles;
    m.steps = frame.status.step;
    m.wall_seconds = wall_;
    m.mass_error = std::abs(budget_now.mass_error);
    if (peak_kinetic_ > 0.0)  // what creeps turns over its energy many times without ever holding it as motion
        m.energy_error = budget_now.energy_residual /
                         std::max({peak_kinetic_, first_.kinetic, frame.status.dissipated - first_.dissipated});
    if (exact.depth) {
        const Norms depth = depth_norms(frame, exact);
        m.l1_depth = depth.l1, m.l2_depth = depth.l2, m.linf_depth = depth.linf;
    }
    if (exact.depth && exact.u) {
        const Norms momentum = momentum_norms(frame, exact);
        m.l1_momentum = momentum.l1, m.l2_momentum = momentum.l2;
    }
    return m;
}

double Trial::point_mean(const Function& f) const {
    const Particles& c = simulation_->flow().particles;
    const GridGeometry& g = scene_.bed.geometry;
    double sum = 0.0, mass = 0.0;
    for (Index p = 0; p < c.count(); ++p) {
        sum += c.mass[p] * f(g.x0 + g.cell * c.x[p], g.y0 + g.cell * c.y[p]);
        mass += c.mass[p];
    }
    return sum / mass;
}

Norms depth_norms(const Frame& frame, const Exact& exact) {
    const double* h = frame.node("depth")->data;
    NormSums sums;
    for_each_counted(frame, exact, [&](Index k, double x, double y) {
        const double e = exact.depth(x, y);
        sums.add(std::abs(h[k] - e), std::abs(e));
    });
    return sums.norms();
}

Norms momentum_norms(const Frame& frame, const Exact& exact) {
    const double *h = frame.node("depth")->data, *velocity = frame.node("velocity")->data;
    NormSums sums;
    for_each_counted(frame, exact, [&](Index k, double x, double y) {
        const double he = exact.depth(x, y), ue = he > 0.0 ? exact.u(x, y) : 0.0;
        const double ve = he > 0.0 && exact.v ? exact.v(x, y) : 0.0;
        sums.add(std::hypot(h[k] * velocity[3 * k] - he * ue, h[k] * velocity[3 * k + 1] - he * ve),
                 he * std::hypot(ue, ve));
    });
    return sums.norms();
}

}  // namespace frana::verify
