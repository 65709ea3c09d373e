#include "checks/fuzz/snapshot.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "coupling/structured_run.h"
#include "coupling/walled_particles.h"
#include "mpm/stencil.h"
#include "shallow/depth_averaged.h"

namespace frana::fuzz {
namespace {

bool is_finite(const Field& field, Index n) {
    for (Index c = n * field.components; c < (n + 1) * field.components; ++c)
        if (!std::isfinite(field.data[c])) return false;
    return true;
}

/// Numbers of points, and of nodes that have ground, that are not finite.
Index count_not_finite(const Frame& frame) {
    const Field& ground = *frame.node("elevation");
    Index bad = 0;
    for (const Field& field : frame.particles)
        for (Index p = 0; p < field.count; ++p) bad += !is_finite(field, p);
    for (const Field& field : frame.nodes)
        for (Index n = 0; n < field.count; ++n) bad += is_finite(ground, n) && !is_finite(field, n);
    return bad;
}

PointStates points_of(const Frame& frame) {
    PointStates points;
    const Field &position = *frame.particle("position"), &velocity = *frame.particle("velocity");
    const Field* model = frame.particle("model");  // of runs in stages
    const auto copy = [&](const char* name, std::vector<double>& to) {
        const Field& field = *frame.particle(name);
        to.assign(field.data, field.data + field.count);
    };
    copy("speed", points.speed), copy("mass", points.mass), copy("depth", points.depth), copy("id", points.id);
    for (Index p = 0; p < position.count; ++p) {
        points.x.push_back((position.data[3 * p] - frame.grid.x0) / frame.grid.cell);
        points.y.push_back((position.data[3 * p + 1] - frame.grid.y0) / frame.grid.cell);
        points.z.push_back(position.data[3 * p + 2]);
        points.vx.push_back(velocity.data[3 * p]), points.vy.push_back(velocity.data[3 * p + 1]);
        points.in_3d.push_back(model && model->data[p] == 1.0 ? 1 : 0);
    }
    return points;
}

/// Those with material on them.
std::vector<NodeState> nodes_of(const Frame& frame) {
    std::vector<NodeState> nodes;
    const Field &bed = *frame.node("elevation"), &depth = *frame.node("depth"), &surface = *frame.node("surface"),
                &velocity = *frame.node("velocity"), &speed = *frame.node("speed");
    for (Index n = 0; n < depth.count; ++n) {
        if (depth.data[n] == 0.0) continue;
        nodes.push_back({n % frame.grid.nx, n / frame.grid.nx, true, depth.data[n], bed.data[n], surface.data[n],
                         velocity.data[3 * n], velocity.data[3 * n + 1], speed.data[n], bed.data[n]});
    }
    return nodes;
}

/// Of particles, and of free water where it is more than a film. A number that is none stays the largest.
double fastest_of(const Frame& frame, const PointStates& points) {
    double fastest = 0.0;
    for (Index p = 0; p < points.count(); ++p) {
        const double speed = points.speed[static_cast<std::size_t>(p)];
        if (!points.in_3d[static_cast<std::size_t>(p)] && !(speed <= fastest)) fastest = speed;
    }
    const Field* water = frame.node("water_velocity");
    if (!water && points.count() == 0) water = frame.node("velocity");  // of water alone
    for (Index n = 0; water && n < water->count; ++n) {
        const double* v = water->data + 3 * n;
        const double speed = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        if (!(speed <= fastest)) fastest = speed;
    }
    return fastest;
}

/// Velocity of the nodes around a place, before their next update [m/s].
template <class Shape>
Vec2 velocity_around(const Flow& flow, double x, double y) {
    const Shape along(x), up(y);
    Vec2 sum(0.0, 0.0);
    for (int j = 0; j < Shape::kNodes; ++j)
        for (int i = 0; i < Shape::kNodes; ++i) {
            const Pair& v = flow.nodes.before[flow.grid.at(along.base + i, up.base + j)];
            sum += along.w[i] * up.w[j] * Vec2(v.x, v.y);
        }
    return sum;
}

Vec2 velocity_around(const Flow& flow, double x, double y) {
    switch (flow.scheme.shape) {
        case Shape::linear:
            return velocity_around<Linear>(flow, x, y);
        case Shape::quadratic:
            return velocity_around<Quadratic>(flow, x, y);
        case Shape::cubic:
            return velocity_around<Cubic>(flow, x, y);
    }
    throw InternalError("unknown shape function");
}

/// What the depth-averaged flow has to the last bit: places and velocities as they are carried, all nodes in reach.
void sharpen(const DepthAveraged& simulation, bool steep, Snapshot& shot) {
    const Flow& flow = simulation.flow();
    PointStates& points = shot.points;
    points.x.assign(flow.particles.x.begin(), flow.particles.x.end());
    points.y.assign(flow.particles.y.begin(), flow.particles.y.end());
    flow.particles.with_real([&](auto real) {
        const auto& held = flow.particles.carried<decltype(real)>();
        for (std::size_t p = 0; p < points.mass.size(); ++p) {
            points.vx[p] = held.vx[p], points.vy[p] = held.vy[p], points.depth[p] = held.depth[p];
            const double xx = held.cxx[p], xy = held.cxy[p], yx = held.cyx[p], yy = held.cyy[p];
            points.change.push_back(flow.cell * std::sqrt(xx * xx + xy * xy + yx * yx + yy * yy));
        }
    });
    if (flow.scheme.transfer == Transfer::flip)
        for (std::size_t p = 0; p < points.mass.size(); ++p)
            points.own.push_back(
                (Vec2(points.vx[p], points.vy[p]) - velocity_around(flow, points.x[p], points.y[p])).norm());
    shot.nodes.clear();
    for (const Index tile : flow.active.work)
        for_each_node_of(flow.grid, tile, [&](Index k, Index i, Index j) {
            if (i < 0 || j < 0 || i >= flow.grid.nx() || j >= flow.grid.ny()) return;
            if (!flow.is_in_reach(i, j)) return;  // holds what an earlier step left, which no pass reads
            const Motion& motion = flow.nodes.motions()[k];
            const double vz = steep ? motion.vx * flow.bed.slope_x[k] + motion.vy * flow.bed.slope_y[k] : 0.0;
            const double along = std::sqrt(motion.vx * motion.vx + motion.vy * motion.vy + vz * vz);
            const bool wet = flow.nodes.flags[k] & kWet;
            if (!wet && flow.nodes.depth[k] == 0.0 && along == 0.0) return;
            const double* z = flow.bed.z.data() + k;
            const double foot = std::min({z[0], z[1], z[-1], z[flow.grid.stride()], z[-flow.grid.stride()]});
            shot.nodes.push_back(
                {i, j, wet, flow.nodes.depth[k], z[0], z[0] + flow.nodes.depth[k], motion.vx, motion.vy, along, foot});
        });
}

/// The same of structured particles: what velocity changes across a cell.
void sharpen(const StructuredRun& simulation, Snapshot& shot) {
    const StructuredBody& body = simulation.flow().body();
    const StructuredPoints& q = body.points;
    for (Index p = 0; p < q.count(); ++p)
        shot.points.change.push_back(body.grid.cell() * std::sqrt(q.cxx[p] * q.cxx[p] + q.cxy[p] * q.cxy[p] +
                                                                  q.cyx[p] * q.cyx[p] + q.cyy[p] * q.cyy[p]));
}

}  // namespace

double Snapshot::fastest() const {
    double fastest = max_speed;
    for (const double speed : points.speed) fastest = std::max(fastest, speed);
    return fastest;
}

const DepthAveraged* particles_of(const Simulation& simulation) {
    if (const auto* walled = dynamic_cast<const WalledParticles*>(&simulation)) return &walled->particles();
    return dynamic_cast<const DepthAveraged*>(&simulation);
}

Snapshot snapshot_of(Simulation& simulation, bool steep) {
    Snapshot shot;
    shot.between = simulation.status();
    const Frame frame = simulation.frame();
    shot.now = frame.status;
    shot.points = points_of(frame);
    shot.max_speed = fastest_of(frame, shot.points);
    shot.nodes = nodes_of(frame);
    shot.not_finite = count_not_finite(frame);
    if (const DepthAveraged* particles = particles_of(simulation)) sharpen(*particles, steep, shot);
    if (const auto* particles = dynamic_cast<const StructuredRun*>(&simulation)) sharpen(*particles, shot);
    return shot;
}

}  // namespace frana::fuzz
