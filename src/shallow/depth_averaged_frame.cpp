// What a depth-averaged run shows of itself: fields of points and nodes at the present time.
#include <algorithm>

#include "base/simd.h"
#include "base/speed_counts.h"
#include "law/rheology/laws.h"
#include "mpm/flow_fields.h"
#include "mpm/stencil.h"
#include "shallow/depth_averaged.h"
#include "shallow/sheet.h"
#include "terrain/places.h"

namespace frana {
namespace {

/// Calls body(storage index, output index) for all nodes of the box that points touch.
template <class Body>
void for_each_output_node(const Flow& flow, const NodeBox& box, Body&& body) {
    for (const Index tile : flow.active.work)
        for_each_node_of(flow.grid, tile, flow.in_reach[tile], [&](Index k, Index i, Index j) {
            const Index a = i - box.i0, b = j - box.j0;
            if (a >= 0 && a < box.nx && b >= 0 && b < box.ny) body(k, b * box.nx + a);
        });
}

/// The same for all nodes, near material or not.
template <class Body>
void for_all_output_nodes(const Flow& flow, const NodeBox& box, Body&& body) {
    for (Index j = 0; j < box.ny; ++j)
        for (Index i = 0; i < box.nx; ++i) body(flow.grid.at(box.i0 + i, box.j0 + j), j * box.nx + i);
}

/// Bed at a point: elevation, its own slope, and that of the smoothed bed. Velocities follow the latter (zero on gentle
/// terrain). It has its curvature where that counts.
struct BedHere {
    double z = 0.0, slope_x = 0.0, slope_y = 0.0, path_x = 0.0, path_y = 0.0, hxx = 0.0, hxy = 0.0, hyy = 0.0;

    /// THEORY (59): g + v'Hv, not below zero [m/s^2].
    double gravity(double g, double vx, double vy) const {
        return std::max(0.0, g + vx * vx * hxx + 2.0 * vx * vy * hxy + vy * vy * hyy);
    }
};
BedHere bed_at(const Flow& flow, bool steep, bool curved, double x, double y) {
    const Quadratic sx(x), sy(y);
    BedHere here;
    for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 3; ++i) {
            const double w = sx.w[i] * sy.w[j];
            const Index k = flow.grid.at(sx.base + i, sy.base + j);
            here.z += w * flow.bed.z[k];
            here.slope_x += w * flow.bed.slope_x[k];
            here.slope_y += w * flow.bed.slope_y[k];
            if (steep) here.path_x += w * flow.bed.smooth[k].x, here.path_y += w * flow.bed.smooth[k].y;
            if (!curved) continue;
            here.hxx += w * flow.bed.hxx[k];
            here.hxy += w * flow.bed.hxy[k];
            here.hyy += w * flow.bed.hyy[k];
        }
    return here;
}

}  // namespace

/// Velocities are half a step behind: nodes are updated by the missing half on a copy, points gather from it. The largest
/// speed is not in it yet.
Status DepthAveraged::catch_up_on_copy() {
    const GridUpdateSums sums = grid_update_->update(flow_, 0.5 * status_.dt, 0.0);
    mirror_motion(flow_);
    transfer_->probe(flow_, probe_);
    Status now = status_;
    now.kinetic = sums.kinetic;
    until_frame_ = since_start_;
    set_totals(until_frame_.add(of_grid_update(sums, 0.5 * status_.dt * stress_power_)), now);
    now.momentum = {0.0, 0.0};
    double speed2 = 0.0;
    for (Index p = 0; p < flow_.particles.count(); ++p) {
        now.momentum[0] += flow_.particles.mass[p] * probe_.vx[p];
        now.momentum[1] += flow_.particles.mass[p] * probe_.vy[p];
        speed2 = std::max(speed2, probe_.vx[p] * probe_.vx[p] + probe_.vy[p] * probe_.vy[p]);
    }
    now.max_speed_on_map = std::sqrt(speed2);
    if (flow_.walls) close_by_walls(now);
    return now;
}

Frame DepthAveraged::frame() {
    Frame frame;
    store_.begin();
    timed_("frame", [&] {
        frame.grid = shown_.of(flow_.grid.geometry());
        frame.status = catch_up_on_copy();
        particle_fields(frame);
        frame.status.max_speed = node_fields(frame);
        if (rheology_.index() != 0) stress_fields(frame);
    });
    return frame;
}

Status DepthAveraged::frame_status() {
    Status now;
    timed_("frame", [&] {
        now = catch_up_on_copy();
        now.max_speed = fastest_node();
    });
    return now;
}

Sample DepthAveraged::at(const Vec2& point) const {
    const GridGeometry& g = flow_.grid.geometry();
    // A point in the outer half pixel shows its edge.
    const double u = std::clamp((point.x() - g.x0) / g.cell, 0.0, static_cast<double>(g.nx - 1));
    const double v = std::clamp((point.y() - g.y0) / g.cell, 0.0, static_cast<double>(g.ny - 1));
    Sample sample;
    const NodeSquare around(g, point);
    for (Index n = 0; n < 4; ++n) {
        const auto [i, j] = around.node(n);
        const double w = around.weight(n);
        const Index k = flow_.grid.at(i, j);
        sample.elevation += w * flow_.bed.z[k];
        if (!flow_.is_in_reach(i, j)) continue;
        const double depth = w * own_depth(k);
        sample.depth += depth;
        sample.velocity += depth * Vec2(flow_.nodes.before[k].x, flow_.nodes.before[k].y);
    }
    if (sample.depth > 0.0) sample.velocity /= sample.depth;  // of what is there: dry nodes have none
    const BedHere bed = bed_at(flow_, steep_, curved_, u, v);
    sample.speed =
        std::hypot(sample.velocity.x(), sample.velocity.y(), sample.velocity.dot(Vec2(bed.path_x, bed.path_y)));
    return sample;
}

/// What counts for the largest speed: not the film at the flow's edge.
static double speed_that_counts(double depth, double footprint_depth, double speed) {
    return depth < kSpeedCounts * footprint_depth ? 0.0 : speed;
}

double DepthAveraged::fastest_node() const {
    const Motion* motions = flow_.nodes.motions();
    double fastest = 0.0;
    for_each_output_node(flow_, shown_, [&](Index k, Index) {
        const double h = own_depth(k);
        if (h <= 0.0) return;
        const BedContact contact = bed_contact(flow_, steep_, curved_, k, motions[k].vx, motions[k].vy);
        fastest = std::max(fastest, speed_that_counts(h, footprint_depth_, contact.speed));
    });
    return fastest;
}

void DepthAveraged::particle_fields(Frame& frame) {
    const Particles& c = flow_.particles;
    const Index count = c.count();
    const GridGeometry& g = flow_.grid.geometry();
    ParticleFields fields(store_, frame.particles, count);
#pragma omp parallel for schedule(static)
    for (Index p = 0; p < count; ++p) {
        const BedHere bed = bed_at(flow_, steep_, curved_, c.x[p], c.y[p]);
        const double h = std::max(probe_.depth[p], 0.0), vx = probe_.vx[p], vy = probe_.vy[p];
        const double slope2 = steep_ ? bed.slope_x * bed.slope_x + bed.slope_y * bed.slope_y : 0.0;
        const double vz = vx * bed.path_x + vy * bed.path_y, path2 = bed.path_x * bed.path_x + bed.path_y * bed.path_y;
        fields.set(p, {g.x0 + c.x[p] * g.cell, g.y0 + c.y[p] * g.cell, bed.z + h, bed.z, h, std::sqrt(1.0 + slope2), vx,
                       vy, vz, std::sqrt(vx * vx + vy * vy + vz * vz),
                       flow_.density * bed.gravity(flow_.gravity, vx, vy) * h / (1.0 + path2), c.mass[p],
                       c.mass[p] / flow_.density, c.id[p]});
    }
}

/// Returns the largest speed that counts.
double DepthAveraged::node_fields(Frame& frame) {
    const Index count = shown_.nx * shown_.ny;
    NodeFields fields(store_, frame.nodes, count);
    double *change = nullptr, *eroded = nullptr, *deposited = nullptr;
    if (erosion_) {
        const auto everywhere = [&](const char* name) { return store_.raw(frame.nodes, name, "m", 1, count); };
        change = everywhere("bed_change");
        eroded = everywhere("eroded_depth");
        deposited = everywhere("deposited_depth");
    }
    for_all_output_nodes(flow_, shown_, [&](Index k, Index n) {
        if (erosion_) {
            change[n] = erosion_->bed_change(k);
            eroded[n] = erosion_->eroded_depth(k);
            deposited[n] = erosion_->deposited_depth(k);
        }
        const double ground =
            has_no_data(flow_.bed.exit[k]) ? std::numeric_limits<double>::quiet_NaN() : flow_.bed.z[k];
        const NodePeak peak{peaks_.depth[k], peaks_.speed[k], peaks_.pressure[k], peaks_.dynamic_pressure[k]};
        fields.stand(n, ground, peak, peaks_.arrival_time(k, footprint_depth_));
    });
    const Motion* motions = flow_.nodes.motions();
    double fastest = 0.0;
    for_each_output_node(flow_, shown_, [&](Index k, Index n) {
        const double h = own_depth(k), vx = motions[k].vx, vy = motions[k].vy;
        if (h <= 0.0) return;
        const double bx = steep_ ? flow_.bed.slope_x[k] : 0.0, by = steep_ ? flow_.bed.slope_y[k] : 0.0;
        const BedContact contact = bed_contact(flow_, steep_, curved_, k, vx, vy);
        const double vz = steep_ ? vx * flow_.bed.smooth[k].x + vy * flow_.bed.smooth[k].y : 0.0;
        fields.flow(n, {h, std::sqrt(1.0 + bx * bx + by * by), vx, vy, vz, contact.speed,
                        contact.pressure * (h / flow_.nodes.depth[k])});
        fastest = std::max(fastest, speed_that_counts(h, footprint_depth_, contact.speed));
    });
    return fastest;
}

/// Stress of the rheology at the points and, mass-weighted, on the nodes. effective_stress adds the depth-averaged
/// pressure: sigma - rho g h / 2 (Fois et al. 2024, before eq. 10).
void DepthAveraged::stress_fields(Frame& frame) {
    const Index count = flow_.particles.count(), nodes = shown_.nx * shown_.ny;
    double* at_points = store_.raw(frame.particles, "stress", "Pa", 3, count);
    double* effective = store_.raw(frame.particles, "effective_stress", "Pa", 3, count);
    double* at_nodes = store_.zeros(frame.nodes, "stress", "Pa", 3, nodes);
    double* effective_nodes = store_.zeros(frame.nodes, "effective_stress", "Pa", 3, nodes);
    if (flow_.rheologies)
        stress_at_points(RheologyOfEachNode{}, at_points);
    else
        std::visit([&](const auto& law) { stress_at_points(law, at_points); }, rheology_);
    stress_on_nodes(at_points);
    const double half_weight = 0.5 * flow_.density * flow_.gravity;
#pragma omp parallel for schedule(static)
    for (Index p = 0; p < count; ++p)
        for (int n = 0; n < 3; ++n)
            effective[3 * p + n] = at_points[3 * p + n] - (n < 2 ? half_weight * std::max(probe_.depth[p], 0.0) : 0.0);
    for_each_output_node(flow_, shown_, [&](Index k, Index to) {
        const StressSum& sum = stress_sums_[k];
        for (int n = 0; n < 3; ++n) {
            if (sum.mass > 0.0) at_nodes[3 * to + n] = sum.stress[n] / sum.mass;
            effective_nodes[3 * to + n] = at_nodes[3 * to + n] - (n < 2 ? half_weight * own_depth(k) : 0.0);
        }
    });
}

template <class Law>
void DepthAveraged::stress_at_points(const Law& law, double* stresses) const {
    if constexpr (!std::is_same_v<Law, rheology::None>) {
        const Particles& c = flow_.particles;
        const Index count = c.count();
        const double velocity_dt = status_.dt > 0.0 ? status_.dt : longest_step();
        const double cap = most_viscosity(flow_, velocity_dt);
        with_rheology_of(law, flow_.rheologies, [&](const auto& rheology) {
#pragma omp parallel for schedule(static)
            for (Index p = 0; p < count; p += 4) {
                const int lanes = static_cast<int>(std::min<Index>(4, count - p));
                const auto four = [&](const auto& array) { return load(&array[p], lanes); };
                const Double4 vx = four(probe_.vx), vy = four(probe_.vy), depth = four(probe_.depth), none = {};
                const Mask4 wet = depth > flow_.dry_depth();
                const PlaneOf<Double4> rate{four(probe_.cxx), four(probe_.cyy),
                                            0.5 * (four(probe_.cxy) + four(probe_.cyx))};
                const Double4 shear =
                    shear_of_four(flow_, four(c.x), four(c.y), lanes, vx, vy, max(depth, all(flow_.dry_depth())));
                const PlaneOf<Double4> sigma = rheology.stress(
                    four(c.x), four(c.y), StrainState<Double4>{rate, shear, flow_.scheme.strain_rate_floor, cap});
                const Double4 xx = select(wet, sigma.xx, none), yy = select(wet, sigma.yy, none),
                              xy = select(wet, sigma.xy, none);
                for (int n = 0; n < lanes; ++n)
                    stresses[3 * (p + n)] = xx[n], stresses[3 * (p + n) + 1] = yy[n], stresses[3 * (p + n) + 2] = xy[n];
            }
        });
    }
}

/// Weighted with mass and shape function, whatever the scheme's: quadratic.
void DepthAveraged::stress_on_nodes(const double* stresses) {
    if (!stress_sums_) stress_sums_ = LazyArray<StressSum>(flow_.grid.size());
    for (const Index tile : flow_.active.work)
        for_each_node_of(flow_.grid, tile, kAllGroups, [&](Index k, Index, Index) { stress_sums_[k] = {}; });
    const Particles& c = flow_.particles;
    for_each_tile_in_turn(flow_.active, [&](Index n) {
        for (Index p = flow_.active.begin[n]; p < flow_.active.begin[n + 1]; ++p) {
            const Quadratic sx(c.x[p]), sy(c.y[p]);
            const double* s = stresses + 3 * p;
            const Double4 value = c.mass[p] * Double4{s[0], s[1], s[2], 1.0};
            for (int j = 0; j < 3; ++j) {
                StressSum* row = &stress_sums_[flow_.grid.at(sx.base, sy.base + j)];
                const Double4 weighted = sy.w[j] * value;
                for (int i = 0; i < 3; ++i) store(row + i, load(row + i) + sx.w[i] * weighted);
            }
        }
    });
}

}  // namespace frana
