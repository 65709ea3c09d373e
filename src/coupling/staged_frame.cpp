// What a run in stages shows: fields of columns and points together, and of the nodes that both stand on.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "coupling/staged_run.h"
#include "terrain/bed_points.h"

namespace frana {
namespace {

/// Writes over a scalar at all nodes.
template <class At>
void each_node(double* values, Index count, At&& at) {
    for (Index k = 0; k < count; ++k) values[k] = at(k);
}

}  // namespace

Frame StagedRun::frame() {
    if (!points_) return columns_->frame();
    Frame frame = columns_->frame();
    store_.begin();
    timed_("frame", [&] {
        const Status now = status_;
        const double mach = largest_mach_;
        accumulate(frame.status);  // of the columns at the points' time
        frame.status = status_;
        frame.status.step = now.step;
        status_ = now, largest_mach_ = mach;
        particle_fields(frame);
        node_fields(frame);
        if (watch_) frame.faces = watch_->patched(*points_);
    });
    return frame;
}

/// Columns retain what they have of the fields that both share; stress is xx, yy, zz, xy, yz, xz.
void StagedRun::particle_fields(Frame& frame) {
    const std::vector<Field> columns = std::move(frame.particles);
    frame.particles.clear();
    const Index before = columns.empty() ? 0 : columns.front().count, more = points_->status().points;
    const Index count = before + more;
    const auto take = [&](const char* name) {
        const auto found =
            std::find_if(columns.begin(), columns.end(), [&](const Field& field) { return field.name == name; });
        expect(found != columns.end(), "columns have the quantities that points share");
        double* const values = store_.zeros(frame.particles, found->name, found->unit, found->components, count);
        std::copy_n(found->data, before * found->components, values);
        return values + before * found->components;
    };
    double *position = take("position"), *velocity = take("velocity"), *speed = take("speed"), *depth = take("depth"),
           *elevation = take("elevation"), *surface = take("surface"), *pressure = take("pressure"),
           *mass = take("mass"), *volume = take("volume"), *id = take("id");
    double* const model = store_.zeros(frame.particles, "model", "1", 1, count) + before;
    double* const stress = store_.zeros(frame.particles, "stress", "Pa", 6, count) + 6 * before;
    const MaterialPoints& q = points_->body().points;
#pragma omp parallel for schedule(static)
    for (Index p = 0; p < more; ++p) {
        const Vec3 x = points_->position(p), v = points_->velocity(p);
        const Sym3 s = points_->stress(p);
        std::copy_n(x.data(), 3, position + 3 * p);
        std::copy_n(v.data(), 3, velocity + 3 * p);
        s.write(stress + 6 * p);
        speed[p] = v.norm();
        const double ground = bed_elevation(scene_.bed, x[0], x[1]);
        elevation[p] = std::isfinite(ground) ? ground : x[2];
        depth[p] = map_.at({x[0], x[1]}).depth;
        surface[p] = elevation[p] + depth[p];
        pressure[p] = -s.trace() / 3.0;
        mass[p] = q.mass[p];
        volume[p] = q.j[p] * q.rest_volume[p];
        id[p] = static_cast<double>(q.id[p]);
        model[p] = 1.0;
    }
}

/// Depths and pressures of both add; velocities are those of their common momentum.
void StagedRun::node_fields(Frame& frame) {
    const Index count = map_.grid().size();
    std::vector<Field> columns = std::move(frame.nodes);
    frame.nodes.clear();
    double *depth = nullptr, *elevation = nullptr, *surface = nullptr;
    const double* depth_of_columns = nullptr;
    for (const Field& field : columns) {
        double* const values = store_.raw(frame.nodes, field.name, field.unit, field.components, count);
        std::copy_n(field.data, count * field.components, values);
        const auto more = [&](const auto& at) { each_node(values, count, [&](Index k) { return values[k] + at(k); }); };
        const auto most = [&](double NodePeak::*peak) {
            each_node(values, count, [&](Index k) { return std::max(values[k], map_.peak(k).*peak); });
        };
        if (field.name == "depth") depth = values, depth_of_columns = field.data;
        if (field.name == "elevation") elevation = values;
        if (field.name == "surface") surface = values;
        if (field.name == "depth" || field.name == "surface") more([&](Index k) { return map_.depth(k); });
        if (field.name == "thickness") more([&](Index k) { return map_.depth(k) * map_.cosine(k); });
        if (field.name == "pressure") more([&](Index k) { return map_.pressure(k); });
        if (field.name == "peak_depth") most(&NodePeak::depth);
        if (field.name == "peak_speed") most(&NodePeak::speed);
        if (field.name == "peak_pressure") most(&NodePeak::pressure);
        if (field.name == "peak_dynamic_pressure") most(&NodePeak::dynamic_pressure);
        if (field.name == "arrival_time")
            each_node(values, count, [&](Index k) {
                const double here = map_.peak(k).arrival_time(map_.footprint_depth());
                return values[k] < 0.0 ? here : here < 0.0 ? values[k] : std::min(values[k], here);
            });
        if (field.name == "velocity")
            for (Index k = 0; k < count; ++k) {
                const double before = depth_of_columns[k], all = depth[k];
                const Vec3 v = map_.velocity(k);
                for (Index c = 0; c < 3 && all > 0.0; ++c)
                    values[3 * k + c] = (before * values[3 * k + c] + (all - before) * v[c]) / all;
            }
        if (field.name == "speed")
            each_node(values, count, [&](Index k) {
                const double all = depth[k], before = depth_of_columns[k];
                return all > 0.0 ? (before * values[k] + (all - before) * map_.velocity(k).norm()) / all : 0.0;
            });
    }
    if (ended_) return;
    const std::array<Index, 4>& w = scene_.solid->window;
    for (Index j = w[1]; j <= w[3]; ++j)
        for (Index i = w[0]; i <= w[2]; ++i) {
            const Index k = j * map_.grid().nx + i;
            if (std::isnan(elevation[k])) continue;
            elevation[k] = ground_at(i, j);
            surface[k] = elevation[k] + depth[k];
        }
}

}  // namespace frana
