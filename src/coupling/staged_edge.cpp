// What particles and points show each other at the window's edge. Points feel the particles beyond it as they feel
// points: their mass, motion and hydrostatic pressure. Particles feel how high points stand.
#include <algorithm>
#include <cmath>

#include "coupling/staged_run.h"
#include "coupling/start_pressure.h"
#include "mpm/stencil.h"

namespace frana {
namespace {

/// Adds to nodes along an axis. Beyond walls it adds to the mirror node. To a node on a wall it adds its own mirror
/// part too, as particles deposit there. Beyond open sides nothing.
struct Along {
    Index node[3];
    double w[3];

    Along(double u, Index count, bool walls) {
        const Quadratic s(u);
        for (int n = 0; n < 3; ++n) {
            Index k = s.base + n;
            w[n] = s.w[n];
            if (walls && k < 0) k = -k;
            if (walls && k >= count) k = 2 * (count - 1) - k;
            if (walls && (k == 0 || k == count - 1) && k == s.base + n) w[n] *= 2.0;
            if (k < 0 || k >= count) k = 0, w[n] = 0.0;
            node[n] = k;
        }
    }
};

}  // namespace

/// Their volume without pressure over the area of a cell, by quadratic shape functions as particles have by default.
/// One thread: there are many steps of points in one of particles.
void StagedRun::show_points() {
    timed_("edge", [&] {
        const GridGeometry& g = depth_averaged().flow().grid.geometry();
        const MaterialPoints& q = points_->body().points;
        const bool walls = are_closed(scene_.sides);
        const double scale = 1.0 / (scene_.density * g.cell * g.cell);
        std::vector<double>& depth = points_depth_;
        const auto nodes = static_cast<std::size_t>(g.size());
        if (depth.size() != nodes) depth.assign(nodes, 0.0);
        const NodeAt origin = terrain_->origin();
        const NodeBox& box = map_.nodes();  // elsewhere points give nothing
        for (Index j = box.j0 + origin.j; j < box.j0 + origin.j + box.ny; ++j)
            std::fill_n(depth.begin() + (j * g.nx + box.i0 + origin.i), box.nx, 0.0);
        for (Index p = 0; p < q.count(); ++p) {
            const Vec3 x = points_->position(p);
            const Along u((x[0] - g.x0) / g.cell, g.nx, walls), v((x[1] - g.y0) / g.cell, g.ny, walls);
            for (int j = 0; j < 3; ++j)
                for (int i = 0; i < 3; ++i)
                    depth[static_cast<std::size_t>(v.node[j] * g.nx + u.node[i])] +=
                        scale * q.mass[p] * u.w[i] * v.w[j];
        }
        depth_averaged().set_adjacent(depth);
    });
}

/// Those on their way into the window first, in their order; then those around it. And the gradients of their
/// velocities. Particles farther on are faster. Without the gradients the nodes that both sides share would take that
/// for a force.
FlowParticles StagedRun::particles_at_edge(std::vector<Mat2>& gradients) const {
    const GridGeometry& g = depth_averaged().flow().grid.geometry();
    Seeds seeds;
    std::vector<Mat2> domains;
    const auto add = [&](double x, double y, double vx, double vy, double mass, double depth, const Edges& edges) {
        seeds.x.push_back(g.x0 + g.cell * x), seeds.y.push_back(g.y0 + g.cell * y);
        seeds.vx.push_back(vx), seeds.vy.push_back(vy);
        seeds.volume.push_back(mass / scene_.density), seeds.depth.push_back(std::max(depth, 0.0));
        domains.push_back(domain_of(edges, g.cell));
    };
    gradients.clear();
    for (const Departed& particle : pending_) {
        add(particle.x, particle.y, particle.vx, particle.vy, particle.mass, particle.depth, particle.edges);
        gradients.push_back(Mat2(particle.gradient.data()));
    }
    const NodeAt origin = terrain_->origin();
    const GridGeometry& begin = scene_.bed.geometry;
    const auto at_edge = [&](double x, double y) {
        const Index i = static_cast<Index>(std::floor(x + 0.5)) - origin.i,
                    j = static_cast<Index>(std::floor(y + 0.5)) - origin.j;
        if (i < 0 || j < 0 || i >= begin.nx || j >= begin.ny) return false;
        return at_edge_[static_cast<std::size_t>(j * begin.nx + i)] != 0;
    };
    const Particles& c = depth_averaged().flow().particles;
    c.with_real([&](auto real) {
        const auto& held = c.carried<decltype(real)>();
        for (Index p = 0; p < c.count(); ++p) {
            if (!at_edge(c.x[p], c.y[p])) continue;
            add(c.x[p], c.y[p], held.vx[p], held.vy[p], c.mass[p], held.depth[p], edges_of(held, p));
            Mat2 gradient;
            gradient << held.cxx[p], held.cxy[p], held.cyx[p], held.cyy[p];
            gradients.push_back(gradient);
        }
    });
    FlowParticles particles = particles_of(seeds, scene_, {});
    if (!scene_.scheme.paper_pressure) particles.domain = std::move(domains);
    take_start_pressure(particles, scene_);
    return particles;
}

/// They are the points that they will be beyond the edge, but each with the particle's velocity at its place. What
/// widens sinks, as it does in nature, in proportion to the height above the bed.
GhostParticles StagedRun::ghosts_of(const FlowParticles& particles, const std::vector<Mat2>& gradients) const {
    const GridGeometry& g = scene_.bed.geometry;
    FlowParticles parts =
        in_parts(particles, scene_.solid->spacing, g.cell, scene_.bed, {g.x0, g.y0, g.x_max(), g.y_max()});
    look_ahead(parts, scene_.bed, kAhead * scene_.solid->cell);
    const std::vector<std::size_t> part_of = parts_of_seeds(parts, *scene_.solid);
    GhostParticles ghosts{
        seeds_of(parts, *scene_.solid), {}, depth_averaged().status().time, depth_averaged().status().dt};
    for (std::size_t k = 0; k < part_of.size(); ++k) {
        const std::size_t part = part_of[k], particle = static_cast<std::size_t>(parts.id[part]);
        const Mat2& c = gradients[particle];
        const Vec2 slope(parts.slope_x[part], parts.slope_y[part]);
        Mat3 gradient = Mat3::Zero();
        gradient.topLeftCorner<2, 2>() = c;
        if (scene_.solid->along_bed) gradient.bottomLeftCorner<1, 2>() = slope.transpose() * c;
        gradient(2, 2) = -c.trace();
        const Vec3 x = ghosts.seeds.position[k];
        ghosts.seeds.velocity[k] +=
            gradient * Vec3(x[0] - particles.x[particle], x[1] - particles.y[particle], x[2] - parts.bed[part]);
        ghosts.gradient.push_back(gradient);
    }
    return ghosts;
}

void StagedRun::show_particles() {
    timed_("edge", [&] {
        std::vector<Mat2> gradients;
        const FlowParticles particles = particles_at_edge(gradients);
        points_->set_adjacent(ghosts_of(particles, gradients));
        map_.set_adjacent(particles);
    });
}

}  // namespace frana
