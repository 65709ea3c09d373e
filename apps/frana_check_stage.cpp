#include "frana_check_stage.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>
#include <variant>
#include <vector>

#include "compare/runout.h"
#include "convert/profile.h"
#include "coupling/solid_scene.h"
#include "coupling/stage_conversion.h"
#include "scene/flow_start.h"
#include "scene/inflow_facts.h"
#include "terrain/places.h"

namespace frana {
namespace {

/// Material that a stage may get, and how it lies at first.
struct Source {
    double volume = 0.0, area = 0.0;    ///< [m3], [m2]
    double particles = 0.0;             ///< each of which becomes a point at least
    double deepest = 0.0, speed = 0.0;  ///< largest [m], [m/s]

    void add(double volume_here, double depth, double speed_here) {
        volume += volume_here;
        if (depth > 0.0) area += volume_here / depth;
        deepest = std::max(deepest, depth), speed = std::max(speed, speed_here);
    }
};

Source source_of(const Scene& scene) {
    Source source;
    for (const Seeds* seeds : scene.all_particles())
        for (std::size_t p = 0; p < seeds->x.size(); ++p) {
            source.add(seeds->volume[p], seeds->depth[p], std::hypot(seeds->vx[p], seeds->vy[p]));
            ++source.particles;
        }
    for (const Inflow& inflow : scene.inflows) {
        const InflowFacts facts = facts_of(inflow, scene.gravity);
        source.add(facts.volume, std::max(facts.thickness, facts.layer), facts.speed);
    }
    return source;
}

/// Material that came a way covers so many times its first area: an avalanche of 26 000 m3 twice after a kilometre, and
/// that of cases/wall four times.
constexpr double kSpread = 2.0;

/// How deep it lies then [m].
double depth_of_flow(const Source& source, double otherwise) {
    return source.area > 0.0 ? source.volume / (kSpread * source.area) : otherwise;
}

/// Parts of particles are an eighth of a full point at the least.
constexpr double kPartsOfPoint = 8.0;

/// Points of such material. A layer thinner than the spacing is one of points; each is an eighth of a full one at the
/// least, as parts of particles are. And each particle becomes one at least. Those that grow as wide as a cell have
/// split: eight to ten were on a cell of that avalanche.
double points_of_flow(const Source& source, const Scene& scene) {
    constexpr double kOnCell = 8.0;
    const double spacing = scene.solid->spacing, full = source.volume / std::pow(spacing, 3),
                 depth = depth_of_flow(source, spacing), cell = scene.bed.geometry.cell;
    const double layers = static_cast<double>(layer_count(depth, spacing)),
                 split = scene.scheme.split ? kOnCell * kSpread * source.area / (cell * cell) : 0.0;
    return std::max({source.particles, split, full * std::min(kPartsOfPoint, layers * spacing / depth)});
}

/// The points that a window has room for where the material lies as deep as it does at its deepest. Each may be in parts.
double room_for(const Source& source, const Scene& scene) {
    const std::array<double, 4> window = window_of(scene);
    const double spacing = scene.solid->spacing;
    return kPartsOfPoint * (window[2] - window[0]) * (window[3] - window[1]) / (spacing * spacing) *
           std::max(1.0, std::ceil(source.deepest / spacing));
}

double points_of(const Scene& scene, const Source& source) {
    const SolidStage& stage = *scene.solid;
    if (stage.from > 0.0) return std::min(points_of_flow(source, scene), room_for(source, scene));
    const std::vector<std::uint8_t> inside = nodes_in_window(scene);
    const FlowParticles there = particles_of(scene.particles, scene, inside);
    Source later = source;  // what is not there from the start
    later.particles -= static_cast<double>(there.count());
    for (std::size_t k = 0; k < there.count(); ++k) {
        later.volume -= there.volume[k];
        if (there.depth[k] > 0.0) later.area -= there.volume[k] / there.depth[k];
    }
    const double now = forecast_parts(there, stage.spacing, scene.bed.geometry.cell).points;
    constexpr double kRoundOff = 1e-9;
    if (later.volume <= kRoundOff * source.volume) return now;
    return now + std::min(points_of_flow(later, scene), room_for(source, scene));
}

/// A mass on its way down the steepest path, one segment after the other.
class Fall {
public:
    Fall(const Scene& scene, const Source& source) : scene_(scene), depth_(source.deepest), speed_(source.speed) {
        if (const std::optional<Vec2> start = flow_start(scene)) path_ = steepest_path(scene.bed, *start);
        fastest_ = speed_;
    }
    /// The largest speed along the bed up to a time [m/s].
    double fastest_by(double time) {
        while (time_ < time && at_ + 1 < path_.size() && step()) ++at_;
        return fastest_;
    }

private:
    /// Over a segment; false where it comes to rest.
    bool step() {
        const Vec2 &from = path_[at_], &to = path_[at_ + 1];
        const double length = (to - from).norm(), drop = height(from) - height(to);
        if (!(length > 0.0) || !std::isfinite(drop)) return true;
        const double slope = drop / length, c2 = 1.0 / (1.0 + slope * slope), c = std::sqrt(c2),
                     drive = scene_.gravity * slope * c2, before = speed_ * c;  // of the map's speed
        const double free = std::sqrt(std::max(0.0, before * before + 2.0 * drive * length));
        if (!(before + free > 0.0)) return false;
        const double dt = 2.0 * length / (before + free);
        const BedState state{scene_.gravity * c2, depth_ * c, 1.0 / c, c, scene_.gravity, scene_.density};
        const double after = std::visit(
            [&](const auto& law) {
                return double{law.speed_after(state, before, std::max(0.0, before + dt * drive), dt)};
            },
            scene_.bed_law);
        speed_ = after / c, time_ += dt;
        fastest_ = std::max(fastest_, speed_);
        return speed_ > 0.0;
    }
    double height(const Vec2& p) const { return NodeSquare(scene_.bed.geometry, p).value(scene_.bed); }

    const Scene& scene_;
    Polyline path_;
    std::size_t at_ = 0;
    double depth_, speed_, time_ = 0.0, fastest_ = 0.0;
};

/// As choose_start() and solid_scene() have it: what is soft by its keys has its own.
double sound_of(const Scene& scene, double fastest) {
    const SolidStage& stage = *scene.solid;
    const double chosen = stage.sound_speed.value_or(10.0 * std::max(fastest, 0.1));
    if (stage.of_bed) return chosen;
    return std::visit(
        [&](const auto& law) {
            return std::decay_t<decltype(law)>::kAverages ? chosen : law.sound_speed(scene.density);
        },
        stage.law);
}

}  // namespace

StageForecast forecast_stage(const Scene& scene) {
    const SolidStage& stage = *scene.solid;
    const Source source = source_of(scene);
    const double head = 2.0 * scene.gravity * source.deepest;  // of what falls by its own depth
    Fall fall(scene, source);
    const double coming = fall.fastest_by(stage.from), until = stage.until.value_or(scene.end);
    StageForecast result;
    result.points = std::ceil(points_of(scene, source));
    result.sound_speed =
        sound_of(scene, stage.from > 0.0 ? std::sqrt(coming * coming + head) : std::max(coming, std::sqrt(head)));
    result.speed = stage.from > 0.0 ? std::sqrt(coming * coming + head) : coming;
    result.thin = stage.from > 0.0 && depth_of_flow(source, stage.cell) < stage.cell;
    result.steps = std::ceil((until - stage.from) * (result.sound_speed + result.speed) / (stage.cfl * stage.cell));
    return result;
}

}  // namespace frana
