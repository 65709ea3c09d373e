// What a run in stages shows: fields of particles and points together, and of the nodes that both stand on.
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "coupling/staged_run.h"
#include "mpm/flow_fields.h"
#include "terrain/bed_points.h"
#include "terrain/part_of.h"

namespace frana {

Frame StagedRun::frame() {
    if (!points_) return terrain_->frame();
    Frame frame = terrain_->frame();
    store_.begin();
    timed_("frame", [&] {
        const Status now = status_;
        const double mach = largest_mach_;
        accumulate(frame.status);  // of the particles at the points' time
        frame.status = status_;
        frame.status.step = now.step;
        status_ = now, largest_mach_ = mach;
        particle_fields(frame);
        node_fields(frame);
        if (watch_) frame.faces = watch_->patched(*points_);
    });
    return frame;
}

/// Particles retain what they have of the fields that both share; stress is xx, yy, zz, xy, yz, xz.
void StagedRun::particle_fields(Frame& frame) {
    const std::vector<Field> particles = std::move(frame.particles);
    frame.particles.clear();
    const Index before = particles.empty() ? 0 : particles.front().count, more = points_->status().points;
    const Index count = before + more;
    ParticleFields shared(store_, frame.particles, count);
    for (const Field& field : frame.particles) {
        const auto found =
            std::find_if(particles.begin(), particles.end(), [&](const Field& of) { return of.name == field.name; });
        expect(found != particles.end(), "particles have the quantities that points share");
        std::copy_n(found->data, before * found->components, const_cast<double*>(field.data));  // made just now
    }
    double* const model = store_.zeros(frame.particles, "model", "1", 1, count) + before;
    double* const stress = store_.zeros(frame.particles, "stress", "Pa", 6, count) + 6 * before;
    const MaterialPoints& q = points_->body().points;
#pragma omp parallel for schedule(static)
    for (Index p = 0; p < more; ++p) {
        const Vec3 x = points_->position(p), v = points_->velocity(p);
        const Sym3 s = points_->stress(p);
        s.write(stress + 6 * p);
        const double ground = bed_elevation(scene_.bed, x[0], x[1]), bed = std::isfinite(ground) ? ground : x[2];
        const double steep = std::hypot(1.0, bed_steepness(scene_.bed, x[0], x[1]));
        shared.set(before + p, {x[0], x[1], x[2], bed, map_.at({x[0], x[1]}).depth, steep, v[0], v[1], v[2], v.norm(),
                                -s.trace() / 3.0, q.mass[p], q.j[p] * q.rest_volume[p], q.id[p]});
        model[p] = 1.0;
    }
}

/// The nodes that a frame shows, of those of the scene; some may lie beyond.
NodeBox StagedRun::box_of_frame(const Frame& frame) const {
    const std::optional<NodeBox> shown = box_of(frame.grid, scene_.bed.geometry);
    expect(shown && common(*shown, map_.nodes()) == map_.nodes(), "a frame shows all nodes that points can give to");
    return *shown;
}

/// Depths and pressures of both add; velocities are those of their common momentum. Only nodes that points can give to
/// change, where they are: in the memory of the particles' frame, which nobody else has and their next one writes anew.
void StagedRun::node_fields(Frame& frame) {
    const NodeBox& box = map_.nodes();
    const NodeBox shown = box_of_frame(frame);
    const auto place = [&](Index i, Index j) { return (j - shown.j0) * shown.nx + i - shown.i0; };
    const auto each = [&](const char* name, const auto& change) {
        const Field* const field = frame.node(name);
        if (!field) return;
        auto* const values = const_cast<double*>(field->data);
        Index m = 0;
        for (Index j = box.j0; j < box.j0 + box.ny; ++j)
            for (Index i = box.i0; i < box.i0 + box.nx; ++i, ++m) change(values + place(i, j) * field->components, m);
    };
    const auto more = [&](const char* name, const auto& at) {
        each(name, [&](double* value, Index m) { *value += at(m); });
    };
    const auto most = [&](const char* name, double NodePeak::*peak) {
        each(name, [&](double* value, Index m) { *value = std::max(*value, map_.peak(m).*peak); });
    };
    std::vector<double> before;  // of particles
    before.reserve(static_cast<std::size_t>(box.nx * box.ny));
    each("depth", [&](double* depth, Index m) { before.push_back(*depth), *depth += map_.depth(m); });
    const auto depths = [&](Index m) {
        const double of_particles = before[static_cast<std::size_t>(m)];
        return std::pair(of_particles, of_particles + map_.depth(m));
    };
    more("surface", [&](Index m) { return map_.depth(m); });
    more("thickness", [&](Index m) { return map_.depth(m) * map_.cosine(m); });
    more("pressure", [&](Index m) { return map_.pressure(m); });
    most("peak_depth", &NodePeak::depth);
    most("peak_speed", &NodePeak::speed);
    most("peak_pressure", &NodePeak::pressure);
    most("peak_dynamic_pressure", &NodePeak::dynamic_pressure);
    each("arrival_time", [&](double* time, Index m) {
        const double here = map_.peak(m).arrival_time(map_.footprint_depth());
        *time = *time < 0.0 ? here : here < 0.0 ? *time : std::min(*time, here);
    });
    each("velocity", [&](double* value, Index m) {
        const auto [of_particles, all] = depths(m);
        const Vec3 v = map_.velocity(m);
        for (Index c = 0; c < 3 && all > 0.0; ++c)
            value[c] = (of_particles * value[c] + (all - of_particles) * v[c]) / all;
    });
    each("speed", [&](double* speed, Index m) {
        const auto [of_particles, all] = depths(m);
        *speed = all > 0.0 ? (of_particles * *speed + (all - of_particles) * map_.velocity(m).norm()) / all : 0.0;
    });
    if (ended_) return;
    each("elevation", [&](double* elevation, Index m) {
        if (!std::isnan(*elevation)) *elevation = ground_at(box.i0 + m % box.nx, box.j0 + m / box.nx);
    });
    const double* const elevation = frame.node("elevation")->data;
    const double* const depth = frame.node("depth")->data;
    each("surface", [&](double* surface, Index m) {
        const Index i = box.i0 + m % box.nx, j = box.j0 + m / box.nx, k = place(i, j);
        if (stands_in_window(i, j)) *surface = elevation[k] + depth[k];
    });
}

}  // namespace frana
