#include "stages/structured_run.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace frana {
namespace {

Vec2 centre_of(const Seeds& seeds) {
    Vec2 centre(0, 0);
    double volume = 0.0;
    for (std::size_t p = 0; p < seeds.x.size(); ++p) {
        centre += seeds.volume[p] * Vec2(seeds.x[p], seeds.y[p]);
        volume += seeds.volume[p];
    }
    return volume > 0.0 ? Vec2(centre / volume) : centre;
}

StructuredScene started(const Scene& scene, Start start) {
    StructuredScene s = structured_scene(scene);
    if (start == Start::kept) s.points = {};
    return s;
}

/// Distance at which columns of the start are neighbours: 1.1 times as far as they stand apart [m].
double reach_of_neighbours(const Seeds& seeds) {
    double widest = 0.0;
    for (const double size : seeds.size) widest = std::max(widest, size);
    return 1.1 * widest;
}

/// Of a cell: neighbours farther apart have no node in common that is near both (structured_prototype's test).
constexpr double kTorn = 1.5, kLink = 1.25;
constexpr PieceRule kPieces{kLink, 0.9, 0.02};  // of the damage; of the mass

}  // namespace

StructuredRun::StructuredRun(const Scene& scene, Start start)
    : bed_(scene.bed),
      flow_(started(scene, start)),
      map_(flow_.body().grid, centre_of(scene.particles), scene.output.footprint_depth),
      neighbours_(flow_, reach_of_neighbours(scene.particles)),
      rest_fraction_(scene.rest_fraction) {
    if (start == Start::kept) return;
    map_.note(flow_.body(), 0.0);
    book();
}

void StructuredRun::advance(double until) {
    flow_.advance(until);
    timed_("peaks", [&] { map_.note(flow_.body(), flow_.status().time); });
    book();
}

void StructuredRun::book() {
    const StructuredStatus& s = flow_.status();
    status_.step = s.step, status_.time = s.time, status_.dt = s.dt;
    status_.particles = s.points;
    status_.mass = s.mass, status_.mass_left = s.mass_left;
    const Vec2 impulse = s.impulse.sum() + s.momentum_given;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        const auto k = static_cast<Eigen::Index>(axis);
        status_.momentum[axis] = s.momentum[k];
        status_.momentum_left[axis] = s.momentum_left[k];
        status_.impulse[axis] = impulse[k];
    }
    status_.kinetic = s.bed_kinetic, status_.potential = s.potential;
    status_.stored = s.stored;
    status_.dissipated = s.friction + s.pushed + (s.worked - s.stored);
    status_.energy_left = s.energy_left;
    status_.max_speed = s.max_speed;
    status_.mean_speed = s.mass > 0.0 ? s.speeds / s.mass : 0.0;
    status_.max_depth = map_.sums().max_depth;
    status_.covered_area = map_.sums().covered_area;
    status_.front = map_.sums().front;
    peak_mean_speed_ = std::max(peak_mean_speed_, status_.mean_speed);
}

bool StructuredRun::at_rest() const {
    return status_.step > 0 &&
           (status_.max_speed == 0.0 || status_.mean_speed < rest_fraction_ * peak_mean_speed_);
}

Sample StructuredRun::at(const Vec2& point) const {
    Sample sample;
    StructuredMap::sample(flow_.body(), point, sample.depth, sample.velocity);
    return sample;
}

std::optional<Breakage> StructuredRun::breakage() const {
    const double cell = flow_.body().grid.cell();
    PieceRule rule = kPieces;
    rule.link *= cell;
    const Neighbours::Torn torn = neighbours_.torn(flow_, kTorn * cell);
    return Breakage{flow_.status().damage, pieces(flow_, rule), neighbours_.pairs(), torn.all, torn.numerical};
}

std::vector<std::string> StructuredRun::remarks() const {
    const Breakage now = *breakage();
    if (now.numerical == 0) return {};
    return {fmt::format("structure: {} of {} pairs of neighbouring columns parted without damage to either, by the scheme "
                        "and not by the material (numerical fracture); a smaller critical_strain or finer cells may help",
                        now.numerical, now.pairs)};
}

std::vector<PhaseTime> StructuredRun::timings() const {
    std::vector<PhaseTime> all = flow_.timings();
    for (const PhaseTime& phase : timed_.times()) all.push_back(phase);
    return all;
}

void StructuredRun::keep(Archive& archive) {
    {
        const Archive::Part part(archive, "columns");
        flow_.keep(archive);
    }
    neighbours_.keep(archive);
    map_.keep(archive);
    frana::keep(archive, "status", status_);
    archive.numbers("peak_mean_speed", {&peak_mean_speed_});
    timed_.keep(archive);
}

}  // namespace frana
