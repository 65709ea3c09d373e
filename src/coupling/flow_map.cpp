#include "coupling/flow_map.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "scene/stage_reach.h"
#include "terrain/part_of.h"
#include "terrain/places.h"

namespace frana {

FlowMap::FlowMap(const Scene& scene)
    : grid_(scene.bed.geometry),
      box_(nodes_of_points(scene)),
      density_(scene.density),
      gravity_(scene.gravity),
      footprint_depth_(scene.output.footprint_depth),
      open_(scene, box_),
      ground_(part_of(scene.bed, box_).values),
      nodes_(ground_.size()),
      heights_(nodes_.size()),
      peaks_(nodes_.size()) {
    areas_.reserve(nodes_.size());
    steepening_.reserve(nodes_.size());
    for (const double open : open_.at_bed()) {
        const Vec2 place = place_of(static_cast<Index>(areas_.size()));
        areas_.push_back(grid_.cell * grid_.cell * open);
        steepening_.push_back(1.0 + bed_gradient(scene.bed, place.x(), place.y()).squaredNorm());
    }
    double volume = 0.0;
    for (std::size_t p = 0; p < scene.particles.x.size(); ++p) {
        centre_ += scene.particles.volume[p] * Vec2(scene.particles.x[p], scene.particles.y[p]);
        volume += scene.particles.volume[p];
    }
    if (volume > 0.0) centre_ /= volume;
}

double FlowMap::pressure(Index k) const {
    return density_ * gravity_ * depth(k) / steepening_[static_cast<std::size_t>(k)];
}

/// Calls body(node, weight) for those of the four nodes around a map point that the map has. Two loops: by
/// NodeSquare::weight a step took longer.
template <class Body>
void FlowMap::for_each_around(double x, double y, Body&& body) const {
    const NodeSquare at(grid_, x, y);
    for (Index b = 0; b < 2; ++b)
        for (Index a = 0; a < 2; ++a)
            if (const Index k = number(at.i + a, at.j + b); k >= 0)
                body(k, (a ? at.s : 1.0 - at.s) * (b ? at.t : 1.0 - at.t));
}

Sample FlowMap::at(const Vec2& point) const {
    Sample sample;
    Vec3 flux(0, 0, 0);
    for_each_around(point.x(), point.y(), [&](Index k, double w) {
        sample.depth += w * depth(k);
        flux += w * depth(k) * velocity(k);
    });
    if (!(sample.depth > 0.0)) return sample;
    const Vec3 mean = flux / sample.depth;
    sample.velocity = mean.head<2>(), sample.speed = mean.norm();
    return sample;
}

FlowMap::Mean FlowMap::mean_at(const Vec2& point) const {
    Mean mean;
    Vec3 flux(0, 0, 0);
    for_each_around(point.x(), point.y(), [&](Index k, double w) {
        const auto at = static_cast<std::size_t>(k);
        Node all = nodes_[at];
        if (!adjacent_.empty()) all.mass += adjacent_[at].mass, all.momentum += adjacent_[at].momentum;
        const double share = w / (density_ * areas_[at]);
        mean.depth += share * all.mass;
        mean.cosine += w * cosine(k);
        flux += share * all.momentum;
    });
    if (mean.depth > 0.0) mean.speed = flux.norm() / mean.depth;
    return mean;
}

void FlowMap::set_adjacent(const FlowParticles& particles) {
    if (adjacent_.empty()) adjacent_.resize(nodes_.size());
    for (const Index k : adjacent_places_) adjacent_[static_cast<std::size_t>(k)] = Node{};
    adjacent_places_.clear();
    for (std::size_t c = 0; c < particles.count(); ++c) {
        const Vec2 along(particles.vx[c], particles.vy[c]);
        const Vec3 velocity(along.x(), along.y(), along.dot(Vec2(particles.slope_x[c], particles.slope_y[c])));
        const double middle = particles.bed[c] + 0.5 * particles.depth[c];
        for_each_around(particles.x[c], particles.y[c], [&](Index k, double share) {
            const double w = share * open_.narrowing(k, middle);
            Node& node = adjacent_[static_cast<std::size_t>(k)];
            if (node.mass == 0.0) adjacent_places_.push_back(k);
            node.mass += w * particles.mass[c];
            node.momentum += w * particles.mass[c] * velocity;
        });
    }
}

/// Within the pixels of the terrain. Points leave it over open sides a cell farther on.
bool FlowMap::on_pixels(const Vec3& place) const {
    const double u = (place[0] - grid_.x0) / grid_.cell, v = (place[1] - grid_.y0) / grid_.cell;
    return u >= -0.5 && v >= -0.5 && u <= static_cast<double>(grid_.nx) - 0.5 &&
           v <= static_cast<double>(grid_.ny) - 0.5;
}

/// One thread: it takes a hundredth of the steps between two samples.
void FlowMap::sample(const Mpm3d& flow, double time, Peaks peaks) {
    std::fill(nodes_.begin(), nodes_.end(), Node{});
    std::fill(heights_.begin(), heights_.end(), 0.0);
    for (Index p = 0; p < flow.body().points.count(); ++p) {
        const Vec3 x = flow.position(p);
        if (!on_pixels(x)) continue;
        const double mass = flow.body().points.mass[p];
        const Vec3 momentum = mass * flow.velocity(p);
        const double height = height_above_bed(x) + 0.5 * std::cbrt(mass / density_);
        for_each_around(x[0], x[1], [&](Index k, double share) {
            const double w = share * open_.narrowing(k, x[2]);
            Node& node = nodes_[static_cast<std::size_t>(k)];
            node.mass += w * mass;
            node.momentum += w * momentum;
            double& highest = heights_[static_cast<std::size_t>(k)];
            highest = std::max(highest, height);
        });
    }
    note_nodes(time, peaks);
}

/// Infinite where the bed is not known.
double FlowMap::height_above_bed(const Vec3& place) const {
    double bed = 0.0;
    for_each_around(place[0], place[1],
                    [&](Index k, double share) { bed += share * ground_[static_cast<std::size_t>(k)]; });
    return std::isnan(bed) ? INFINITY : place[2] - bed;
}

void FlowMap::note_nodes(double time, Peaks peaks) {
    extent_ = {};
    for (Index k = 0; k < static_cast<Index>(nodes_.size()); ++k) {
        if (!(depth(k) > 0.0)) continue;
        note_piled(k, time);
        const auto at = static_cast<std::size_t>(k);
        const double h = depth(k) + (adjacent_.empty() ? 0.0 : adjacent_[at].mass / (density_ * areas_[at]));
        const NodeState now{h, velocity(k).norm(), density_ * gravity_ * h / steepening_[at], density_};
        if (peaks == Peaks::grow) peaks_[at].note(now, time, footprint_depth_);
        extent_.note(now, footprint_depth_, areas_[static_cast<std::size_t>(k)], (place_of(k) - centre_).norm());
    }
}

void FlowMap::note_piled(Index k, double time) {
    constexpr double kTooMuch = 1.5;  // compression and drops make less
    const double h = depth(k), height = heights_[static_cast<std::size_t>(k)];
    if (h > kTooMuch * height && h > footprint_depth_ && h > piled_.depth)
        piled_ = {h, height, place_of(k).x(), place_of(k).y(), time};
}

std::optional<std::string> FlowMap::remark() const {
    if (!(piled_.depth > 0.0)) return {};
    return fmt::format(
        "3D points lie in one another: at x {:.10g}, y {:.10g}, t = {:.6g} s their volume makes {:.3g} m of depth, but "
        "the highest reaches {:.3g} m above the bed; expected no more than half again that height. In layers of few "
        "points nothing resists such piles. The flow's depth there lies between both: do not design by peak depth and "
        "pressure at such a place, but by means over several cells; run-up may be too low; give a smaller stage.cell",
        piled_.x, piled_.y, piled_.time, piled_.depth, piled_.height);
}

Index FlowMap::fronts(double since, double speed) const {
    Index count = 0;
    for (Index k = 0; k < static_cast<Index>(peaks_.size()); ++k) {
        const NodePeak& peak = peaks_[static_cast<std::size_t>(k)];
        count += peak.covered(footprint_depth_) && peak.arrival >= since && velocity(k).norm() > speed;
    }
    return count;
}

void FlowMap::serialize(Archive& archive) {
    const Archive::Part part(archive, "map");
    constexpr std::size_t kNumbers = 4 + NodePeak::kNumbers;
    std::vector<double> all;
    if (!archive.loading())
        for (std::size_t k = 0; k < nodes_.size(); ++k) {
            const Node& n = nodes_[k];
            all.insert(all.end(), {n.mass, n.momentum[0], n.momentum[1], n.momentum[2]});
            for (const double number : peaks_[k].numbers()) all.push_back(number);
        }
    archive.array("nodes", all);
    archive.numbers("sums", extent_.numbers());
    archive.numbers("piled", {&piled_.depth, &piled_.height, &piled_.x, &piled_.y, &piled_.time});
    if (all.size() != kNumbers * nodes_.size()) Archive::wrong_length("nodes", all.size(), kNumbers * nodes_.size());
    if (!archive.loading()) return;
    for (std::size_t k = 0; k < nodes_.size(); ++k) {
        const double* const v = &all[kNumbers * k];
        nodes_[k] = {v[0], {v[1], v[2], v[3]}};
        peaks_[k] = NodePeak::of(v + 4);
    }
}

}  // namespace frana
