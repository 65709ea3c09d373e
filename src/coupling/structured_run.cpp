#include "coupling/structured_run.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "scene/barrier_box.h"
#include "terrain/bed_points.h"

namespace frana {
namespace {

/// Of the water at the start, by its volume. Where there is none, of the first inflow; else of the terrain.
Vec2 centre_of(const WaterScene& water) {
    const GridGeometry& g = water.grid;
    Vec2 centre(0, 0);
    double volume = 0.0;
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) {
            const double h = water.start(g.x(i), g.y(j)).depth;
            centre += h * Vec2(g.x(i), g.y(j)), volume += h;
        }
    if (volume > 0.0) return centre / volume;
    if (water.sources.empty()) return 0.5 * Vec2(g.x0 + g.x_max(), g.y0 + g.y_max());
    for (const WaterSource::Place& at : water.sources.front().places) centre += at.share * Vec2(g.x(at.i), g.y(at.j));
    return centre;
}

/// Of all that is there at the start: the front is measured from it.
Vec2 centre_of(const Scene& scene) {
    if (!scene.structure) return centre_of(two_phase_scene(scene).water);
    const Seeds& seeds = scene.particles;
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
    if (start == Start::resumed) s.points = {};
    return s;
}

TwoPhaseScene wet(const Scene& scene, Start start) {
    TwoPhaseScene s = two_phase_scene(scene);
    if (start == Start::resumed) s.structured.points = {}, s.water.start = {};
    return s;
}

/// Distance at which particles of the start are neighbours: 1.1 times as far as they stand apart [m].
double reach_of_neighbours(const Seeds& seeds) {
    double widest = 0.0;
    for (const double size : seeds.size) widest = std::max(widest, size);
    return 1.1 * widest;
}

/// Of a cell: neighbours farther apart have no node in common that is near both.
constexpr double kTorn = 1.5, kLink = 1.25;
constexpr PieceRule kPieces{kLink, 0.9, 0.02};  // of the damage; of the mass

/// Coordinates along the ground have no slope left for velocities to follow.
LazyArray<Pair> path_of(const Scene& scene, const TileGrid& grid) {
    if (scene.structure && scene.structure->unrolled) return LazyArray<Pair>(grid.size());
    return smooth_slopes(scene, grid);
}

}  // namespace

StructuredRun::StructuredRun(const Scene& scene, Start start)
    : bed_(scene.bed),
      barriers_(scene.barriers),
      water_density_(scene.water ? scene.water->exchange.material.fluid_density : 0.0),
      solid_density_(scene.water ? scene.water->exchange.material.solid_density : scene.density),
      solids_(scene.structure.has_value()),
      inflows_(!scene.inflows.empty()),
      alone_(scene.water ? nullptr : std::make_unique<StructuredFlow>(started(scene, start))),
      both_(scene.water ? std::make_unique<TwoPhaseFlow>(wet(scene, start)) : nullptr),
      map_(flow().body().grid, centre_of(scene), scene.output.footprint_depth, path_of(scene, flow().body().grid)),
      neighbours_(flow(), reach_of_neighbours(scene.particles)) {
    if (start == Start::resumed) return;
    map_.note(flow().body(), water(), 0.0, StructuredMap::Peaks::grow);
    accumulate();
}

void StructuredRun::advance(double until) {
    if (both_)
        both_->advance(until);
    else
        alone_->advance(until);
    const auto peaks = aside_ ? StructuredMap::Peaks::stay : StructuredMap::Peaks::grow;
    timed_("peaks", [&] { map_.note(flow().body(), water(), time(), peaks); });
    accumulate();
}

void StructuredRun::accumulate() {
    const StructuredStatus& s = flow().status();
    status_.step = s.step, status_.time = s.time, status_.dt = s.dt;
    status_.particles = s.points;
    status_.mass = s.mass, status_.mass_left = s.mass_left;
    const Vec2 impulse = s.impulse.sum();
    for (std::size_t axis = 0; axis < 2; ++axis) {
        const auto k = static_cast<Eigen::Index>(axis);
        status_.momentum[axis] = s.momentum[k];
        status_.momentum_left[axis] = s.momentum_left[k];
        status_.impulse[axis] = impulse[k];
    }
    status_.kinetic = s.bed_kinetic, status_.potential = s.potential;
    status_.stored = s.stored;
    status_.dissipated = s.friction + s.squeezed + s.obstacle_work + (s.worked - s.stored);
    status_.energy_left = s.energy_left;
    status_.max_speed = map_.extent().max_speed, status_.max_speed_on_map = s.max_speed;
    status_.mean_speed = map_.extent().mean_speed();
    status_.max_depth = map_.extent().max_depth;
    status_.covered_area = map_.extent().covered_area;
    status_.front = map_.extent().front;
    if (both_) accumulate_water();
}

/// The water's part. Rain and what sources bring have come in, and what the ground takes has left. Of its energy friction,
/// viscosity and drag are recorded. What shocks and the scheme take is what is left, the residual.
void StructuredRun::accumulate_water() {
    const WaterStatus& w = both_->water().status();
    const WaterLedger& l = w.ledger;
    const double density = water_density_, solids = status_.mass, mass = solids + density * w.volume;
    const Vec2 left = l.momentum_left + l.momentum_infiltrated, thrust = l.ground + l.walls + l.friction + l.particles;
    if (both_->alone()) status_.step = w.step, status_.time = w.time;
    status_.dt = w.dt;
    status_.mass = mass;
    status_.water = density * w.volume, status_.water_volume = w.volume;
    status_.mass_left += density * (l.left + l.infiltrated);
    status_.mass_in = density * (l.rained + l.entered + l.fed);
    for (std::size_t axis = 0; axis < 2; ++axis) {
        const auto k = static_cast<Eigen::Index>(axis);
        status_.momentum[axis] += density * w.momentum[k];
        status_.momentum_left[axis] += density * left[k];
        status_.impulse[axis] += density * thrust[k];
    }
    status_.kinetic += density * both_->water_kinetic();
    status_.potential += density * both_->water_potential();
    status_.dissipated += density * (l.braked + l.sheared) + flow().status().dragged;
    const WaterBody& body = both_->water().body();
    status_.energy_left +=
        density * (l.energy_out + body.gravity * body.datum * (l.left + l.infiltrated - l.rained - l.entered - l.fed));
    status_.max_speed_on_map = std::max(status_.max_speed_on_map, w.max_speed);
}

/// Water that is still to come in is about to begin. Rain may move solids that stand yet. What soaks in gets less.
bool StructuredRun::may_rest() const {
    if (!both_) return true;
    const WaterFlow& water = both_->water();
    return !water.sources_go_on() && !water.body().rain && !water.soaks_in();
}

bool StructuredRun::more_comes() const {
    return both_ && (both_->water().sources_go_on() || both_->water().comes_on());
}

std::string StructuredRun::why_not_add(const Seeds& particles) const {
    if (solids_) return Simulation::why_not_add(particles);
    return "found a case of free water; expected one of depth-averaged flow alone; give what comes later as an inflow "
           "of the "
           "case";
}

/// Free water counts as material; below the film's depth it stands still.
MovingMass StructuredRun::motion(const MotionQuery& query) const {
    MovingMass motion{status_.mass, 0.0, status_.max_speed_on_map, 0};
    const StructuredPoints& p = flow().body().points;
    for (std::size_t n = 0; n < p.mass.size(); ++n)
        if (std::hypot(p.vx[n], p.vy[n]) > query.faster_than) motion.moving += p.mass[n];
    if (both_) motion.moving += water_density_ * water()->volume_faster_than(query.faster_than);
    motion.fronts = map_.fronts(flow().body(), water(), query.since, query.faster_than);
    return motion;
}

Sample StructuredRun::at(const Vec2& point) const {
    Sample sample;
    sample.elevation = bed_below(bed_, point.x(), point.y());
    StructuredMap::sample(flow().body(), water(), point, sample.depth, sample.velocity);
    const TileGrid& grid = flow().body().grid;
    const GridGeometry& g = grid.geometry();
    const auto place = [&](double at, double start, Index count) {
        return std::clamp((at - start) / g.cell, 0.0, static_cast<double>(count - 1));
    };
    const Index k = grid.nearest(place(point.x(), g.x0, g.nx), place(point.y(), g.y0, g.ny));
    const double vx = sample.velocity.x(), vy = sample.velocity.y();
    sample.speed = std::hypot(vx, vy, map_.climb(k, vx, vy));
    return sample;
}

Extras StructuredRun::extras() const {
    Extras extras;
    if (solids_) extras.breakage = breakage();
    extras.water = water_budget();
    extras.inflow = inflow_budget();
    return extras;
}

Breakage StructuredRun::breakage() const {
    const double cell = flow().body().grid.cell();
    PieceRule rule = kPieces;
    rule.link *= cell;
    const Neighbours::Torn torn = neighbours_.torn(flow(), kTorn * cell);
    const StructuredStatus& s = flow().status();
    return Breakage{s.damage,
                    pieces(flow(), rule),
                    neighbours_.pairs(),
                    torn.all,
                    torn.numerical,
                    flow().sub_cycling(),
                    {0.0 - s.impulse.obstacles.x(), 0.0 - s.impulse.obstacles.y()}};
}

std::optional<WaterBudget> StructuredRun::water_budget() const {
    if (!both_) return {};
    const WaterStatus& w = both_->water().status();
    const WaterLedger& l = w.ledger;
    WaterBudget b;
    b.given = both_->volume_given(), b.free = w.volume, b.confined = both_->confined();
    b.released = flow().status().released;
    b.rained = l.rained, b.infiltrated = l.infiltrated, b.left = l.left + flow().status().confined_left;
    b.entered = l.entered, b.fed = l.fed, b.infiltrated_mass = water_density_ * l.infiltrated;
    b.solids_left = (flow().status().mass_left - water_density_ * flow().status().confined_left) / solid_density_;
    b.residual = both_->volume_residual();
    b.bed = water_density_ * l.braked, b.viscosity = water_density_ * l.sheared, b.drag = flow().status().dragged;
    b.steps = both_->sub_cycles();
    return b;
}

std::optional<InflowBudget> StructuredRun::inflow_budget() const {
    if (!both_ || !inflows_) return {};
    const WaterFlow& water = both_->water();
    return InflowBudget{water.status().ledger.fed, water.due_so_far(), water.due_at_all()};
}

std::vector<std::string> StructuredRun::remarks() const {
    if (!solids_) return {};
    const Breakage now = breakage();
    const StructuredStatus& s = flow().status();
    std::vector<std::string> remarks;
    if (s.lost_in_holes > 0.0)  // walls in holes, the depth-averaged flow's way out, structured particles do not have
        remarks.push_back(fmt::format(
            "boundary.holes: {:.6g} kg, {:.3g} % of the mass, left where the elevation model has no data inside the "
            "terrain; fill it (gdal_fillnodata.py)",
            s.lost_in_holes, 100.0 * s.lost_in_holes / (s.mass + s.mass_left)));
    if (s.outrun > 0)
        remarks.push_back(
            fmt::format("water.profile_factor: in {} nodes and steps drag was weaker than what it adds to the "
                        "slip, and it was left out there; a smaller one, or finer grains, may help",
                        flow().status().outrun));
    remark_on_low_barriers(remarks);
    if (now.numerical == 0) return remarks;
    remarks.push_back(fmt::format(
        "structure: {} of {} pairs of neighbouring particles parted without damage to either, by the scheme "
        "and not by the material (numerical fracture); a smaller critical_strain or finer cells may help",
        now.numerical, now.pairs));
    return remarks;
}

/// Their boxes hold back whatever comes: where it ever stood higher than a barrier, it would have gone over it.
void StructuredRun::remark_on_low_barriers(std::vector<std::string>& remarks) const {
    const GridGeometry& g = bed_.geometry;
    for (const Barrier& barrier : barriers_) {
        double over = 0.0;
        if (is_buried(barrier, bed_)) continue;
        const BarrierBox box = box_around(barrier, g.cell);
        for (Index j = 0; j < g.ny; ++j)
            for (Index i = 0; i < g.nx; ++i) {
                const Vec2 place(g.x(i), g.y(j)), nearest = place.cwiseMax(box.low).cwiseMin(box.high);
                if ((place - nearest).cwiseAbs().maxCoeff() > g.cell) continue;
                const double depth = map_.peak(flow().body().grid.at(i, j)).depth;
                const double height = barrier.top ? *barrier.top - bed_.at(i, j) : barrier.height;
                if (depth > 0.0) over = std::max(over, depth - height);
            }
        if (over > 0.0)
            remarks.push_back(fmt::format(
                "barrier \"{}\": found material up to {:.3g} m higher than it; expected none, since with "
                "material.structure a barrier counts as any height; raise the elevation model there instead",
                barrier.name, over));
    }
}

std::vector<PhaseTime> StructuredRun::timings() const {
    std::vector<PhaseTime> all = flow().timings();
    if (both_)
        for (PhaseTime phase : both_->water().timings()) {
            phase.name = "water: " + phase.name;
            all.push_back(phase);
        }
    for (const PhaseTime& phase : timed_.times()) all.push_back(phase);
    return all;
}

void StructuredRun::serialize(Archive& archive) {
    aside_ = archive.aside() && !archive.loading();
    {
        const Archive::Part part(archive, "columns");
        if (both_)
            both_->serialize(archive);
        else
            alone_->serialize(archive);
    }
    neighbours_.serialize(archive);
    map_.serialize(archive);
    frana::serialize(archive, "status", status_);
    timed_.serialize(archive);
}

}  // namespace frana
