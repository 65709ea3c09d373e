#include "shallow/depth_averaged.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/clock.h"
#include "base/flush_denormals.h"
#include "mpm/stencil.h"
#include "shallow/lateral.h"
#include "shallow/shock.h"

namespace frana {
namespace {

/// What a step does once, however short it is, adds up with the number of steps. Affine points lose of their motion
/// what the nodes cannot hold, and crowded points merge. So steps shorter than those of this scheme.cfl do less of it.
constexpr double kOrdinaryCfl = 0.5;
/// A bed loses where points have arrived, half a step's way too late. 3D points take over what arrives in a step at
/// once. Both err twice as much with steps twice as long, where the flow itself hardly errs more.
constexpr double kMostCflOfExchange = 0.5;
constexpr double kStepsBetweenSplits = 3.0;  ///< ordinary ones
/// Cells a point may have moved since the last sort. Same-colour tiles then still share no node, as long as the drift d
/// satisfies 16 + d + 2 < 32 - d - 1: d <= 6, cubic d <= 5. (Sub-points reach from one node before the quadratic
/// stencil to one behind it.) A step that moves a point by more than 4 cells is refused.
constexpr double kDriftLimit = 3.0;
/// A step in which a signal would cross so many times what it was chosen for (scheme.cfl) is shortened. The default scheme
/// holds to twice its scheme.cfl and more (tests/cfl_map.txt).
constexpr double kFarther = 2.0;
double drift_before_carry(const Scheme& scheme) { return scheme.shape == Shape::cubic ? 1.0 : 2.0; }

double least_split_mass(const Scene& scene) {
    return scene.scheme.split_min_mass * largest_particle(scene) * scene.density;
}

/// Heavier points count as ones that have taken up bed. Few merged points are so heavy.
double grown_mass(const Scene& scene) {
    constexpr double kGrown = 2.0;  // of the largest at the start
    return scene.erodible ? kGrown * largest_particle(scene) * scene.density : std::numeric_limits<double>::infinity();
}

bool is_resisted(const Scene& scene) {
    return scene.bed_laws() || scene.rheologies() || !std::holds_alternative<bed::None>(scene.bed_law) ||
           !std::holds_alternative<rheology::None>(scene.rheology);
}

}  // namespace

DepthAveraged::DepthAveraged(const Scene& scene, Start start)
    : flow_(scene),
      transfer_(make_transfer(scene)),
      grid_update_(make_grid_update(scene)),
      creep_filter_(is_resisted(scene), flow_.grid),
      splitter_(least_split_mass(scene), grown_mass(scene)),
      peaks_(flow_.grid),
      shown_(NodeBox::all(scene.bed.geometry)),
      rheology_(scene.rheology),
      steep_(scene.terrain != TerrainModel::shallow),
      curved_(steep_ && scene.curvature == Curvature::full),
      sleeps_(scene.scheme.sleep),
      footprint_depth_(scene.output.footprint_depth) {
    if (scene.erodible || scene.solid) flow_.scheme.cfl = std::min(flow_.scheme.cfl, kMostCflOfExchange);
    expect(!scene.wider, "on a part of a terrain particles grow it (coupling/growing_particles.h)");
    expect(flow_.grid.nx() >= 4 && flow_.grid.ny() >= 4, "the grid needs four nodes in each direction");
    flush_denormals_on_all_threads();
    if (scene.bed_changes()) {
        erosion_.emplace(scene, flow_);
        status_.bed = erosion_->status();
    }
    flow_.particles.single = scene.scheme.precision == Precision::single;
    if (!scene.sections.empty()) passages_.emplace(scene.sections, flow_.grid);
    if (!scene.inflows.empty()) feed_.emplace(scene.inflows), supports_.emplace(flow_.grid.size());
    if (!scene.late.empty()) late_.emplace(scene.late, flow_.grid);
    choose_sleep();
    if (start == Start::resumed) return;
    flow_.particles.with_real([&](auto real) { place<decltype(real)>(scene.particles); });
    if (scene.still_surface && scene.scheme.paper_pressure)
        level_points(*scene.still_surface);
    else if (scene.still_surface && scene.scheme.mass_fit && scene.scheme.shape != Shape::linear) {
        // Points that split later would spread over other nodes than those they were fitted on. The fit makes some
        // heavy enough to split.
        const auto split = [&] { return splitter_.split(flow_) > 0; };
        const auto sort = [&] { sorter_.sort(flow_.particles, flow_.grid, {}, flow_.active); };
        while (split()) sort();
        for (fit_ = fit_masses(flow_, *scene.still_surface); split(); fit_ = fit_masses(flow_, *scene.still_surface))
            sort();
    }
    if (flow_.scheme.merge && !flow_.scheme.paper_pressure) make_merger();
    const double longest = longest_step();
    arrive(timed_("deposit", [&] { return transfer_->deposit(flow_, 0.5 * longest); }));
    if (fit_) fit_->level_error = off_level(flow_, *scene.still_surface);
    start_momentum_ = status_.momentum;
    if (flow_.walls) close_by_walls(status_);
    if (status_.max_speed_on_map > 0.0)
        status_.kinetic = catch_up_on_copy().kinetic;  // else the first step would bring it
    signal_ += std::sqrt(flow_.gravity * status_.max_depth);
    if (late_) enter_late();
}

/// Seeds become particles behind those that are there: positions in cells, square domains.
template <class Real>
void DepthAveraged::append(const Seeds& seeds, Index first_id) {
    Particles& c = flow_.particles;
    Carried<Real>& held = c.carried<Real>();
    const GridGeometry& g = flow_.grid.geometry();
    const Index before = c.count();
    c.resize(before + seeds.count());
    for (Index n = 0; n < seeds.count(); ++n) {
        const Index p = before + n;
        c.x[p] = (seeds.x[n] - g.x0) / g.cell;
        c.y[p] = (seeds.y[n] - g.y0) / g.cell;
        held.vx[p] = static_cast<Real>(seeds.vx[n]);
        held.vy[p] = static_cast<Real>(seeds.vy[n]);
        c.mass[p] = seeds.volume[n] * flow_.density;
        held.r1x[p] = held.r2y[p] = static_cast<Real>(seeds.size[n] / g.cell);
        held.depth[p] = static_cast<Real>(seeds.depth[n]);
        c.id[p] = first_id + n;
        status_.max_speed_on_map = std::max(status_.max_speed_on_map, std::hypot(seeds.vx[n], seeds.vy[n]));
    }
}
template void DepthAveraged::append<double>(const Seeds&, Index);
template void DepthAveraged::append<float>(const Seeds&, Index);

/// The particles of a start, sorted by tile.
template <class Real>
void DepthAveraged::place(const Seeds& seeds) {
    append<Real>(seeds, 0);
    Particles& c = flow_.particles;
    double mass = 0.0;
    for (Index p = 0; p < seeds.count(); ++p) {
        centre_ += c.mass[p] * Vec2(c.x[p], c.y[p]);
        mass += c.mass[p];
    }
    signal_ = status_.max_speed_on_map;
    if (mass > 0.0)
        centre_ /= mass;
    else if (feed_)
        centre_ = (feed_->middle() - Vec2(flow_.grid.geometry().x0, flow_.grid.geometry().y0)) / flow_.cell;
    else if (late_)
        centre_ = (late_->middle() - Vec2(flow_.grid.geometry().x0, flow_.grid.geometry().y0)) / flow_.cell;
    splitter_.set_next_id(late_ ? late_->next_id(seeds.count()) : seeds.count());
    sorter_.sort(c, flow_.grid, {}, flow_.active);
}

/// Depths of a lake's points up to the level from the bilinear bed beneath each, as in the paper.
void DepthAveraged::level_points(double level) {
    Particles& c = flow_.particles;
    for (Index p = 0; p < c.count(); ++p) {
        const Linear sx(c.x[p]), sy(c.y[p]);
        double bed = 0.0;
        for (int j = 0; j < 2; ++j)
            for (int i = 0; i < 2; ++i) bed += sx.w[i] * sy.w[j] * flow_.bed.z[flow_.grid.at(sx.base + i, sy.base + j)];
        const double depth = level - bed;
        if (!(depth > 0.0) || !(c.depth[p] > 0.0)) continue;
        c.mass[p] *= depth / c.depth[p];
        c.depth[p] = depth;
    }
}

/// One step: the nodes are updated and braked, the points are carried and deposit where they arrive.
void DepthAveraged::advance(double until) {
    if (late_) until = std::min(until, late_->next());  // that time is hit
    const double share = share_of_ordinary_step();
    flow_.carried_share = 1.0 - share;
    const double dt = timed_("grid update", [&] { return update_nodes(step_length(until)); });
    flow_.rest.settled = since_split_ == 0.0 || flow_.scheme.paper_pressure;  // that preset does neither
    since_split_ += share;
    const bool due = since_split_ >= (1.0 - 1e-9) * kStepsBetweenSplits;
    timed_("grid update", [&] { mirror_motion(flow_); });
    const double next_velocity_dt = 0.5 * (dt + longest_step());
    const bool rows = feed_ && feed_->due(status_.after(dt, until));
    // Rows wait until points are sorted anyway. A sort of its own for each would cost a fifth of a step.
    const bool adapts = due || drift_ > drift_before_carry(flow_.scheme) || (rows && flow_.particles.count() == 0);
    const bool fed = rows && adapts;
    const bool settles = erosion_ && erosion_->deposits(), erodes = erosion_ && exchange_is_due(dt, until, adapts);
    const bool apart = adapts || settles || erodes;
    if (passages_) timed_("sections", [&] { passages_->note(flow_); });
    PointSums points =
        apart ? timed_("gather", [&] { return transfer_->gather(flow_, dt); })
              : timed_("gather and deposit", [&] { return transfer_->carry(flow_, dt, next_velocity_dt); });
    require_finite(points);
    if (passages_) timed_("sections", [&] { passages_->count_moved(flow_); });
    accumulate_points(points);
    status_.tick(dt, until);
    // Dropped, not sorted: nodes have been cleared for the present tiles, and stay so until the next deposit.
    if (points.left_count > 0) timed_("sort", [&] { sorter_.drop(flow_.particles, transfer_->gone(), flow_.active); });
    if (settles) timed_("erosion", [&] { settle(); });
    if (adapts) adapt_points(due, fed);
    if (erodes)
        timed_("erosion", [&] {
            erode({dt, velocity_dt_, until - status_.time,
                   std::ceil((kStepsBetweenSplits - since_split_) / share - 1e-9)});
        });
    if (settles) timed_("erosion", [&] { detrain(dt); });
    if (apart) points = timed_("deposit", [&] { return transfer_->deposit(flow_, next_velocity_dt); });
    arrive(points);
    if (late_) enter_late();
    if (!aside_ && added_.count() > 0) enter_added();
}

/// Grid updates the nodes for a step of `dt`. Where forces drive them much farther than the step was chosen for, it is
/// a shorter one. The step follows the last one's signal, and a film on a cliff, say, has none before it falls. Returns
/// the step.
double DepthAveraged::update_nodes(double dt) {
    const double reach = flow_.scheme.cfl * flow_.cell;
    const double before = signal_;
    for (;;) {
        const double velocity_dt = 0.5 * (status_.dt + dt);  // leapfrog: velocities stand between the positions
        const GridUpdateSums sums = grid_update_->update(flow_, velocity_dt, dt);
        velocity_dt_ = velocity_dt;
        if (!(sums.max_signal * dt > kFarther * reach)) {
            accumulate_grid_update(sums, velocity_dt);
            return dt;
        }
        const double acceleration =
            (sums.max_signal - before) / velocity_dt;  // of the node that is driven farthest [m/s^2]
        const double start = before + 0.5 * acceleration * status_.dt;
        dt = std::min(0.5 * dt, 2.0 * reach / (start + std::sqrt(start * start + 2.0 * acceleration * reach)));
    }
}

/// What follows from a deposit: depth, surface, status, peaks.
void DepthAveraged::arrive(const PointSums& points) {
    const PointSums nodes = timed_("deposit", [&] {
        choose_active(flow_, *grid_update_);
        return node_sums(flow_);
    });
    status_.p2g_mass_error = points.mass > 0.0 ? std::abs(nodes.mass - points.mass) / points.mass : 0.0;
    status_.p2g_momentum_error =
        points.p_abs > 0.0 ? std::hypot(nodes.px - points.px, nodes.py - points.py) / points.p_abs : 0.0;
    if (feed_) timed_("inflow", [&] { support_inflows(); });
    timed_("depth", [&] { fold_with_support(); });
    NodeSums sums = raise_surface();
    if (!supported_.empty()) timed_("inflow", [&] { leave_support_out(sums); });
    const FlowSpeeds speeds = timed_("peaks", [&] {
        // The run does not come by states aside. Their peaks would be gone in the next frame.
        if (aside_) return speeds_of_nodes(flow_, steep_, curved_, footprint_depth_);
        put_peaks_aside();
        const FlowSpeeds all = update_peaks(flow_, steep_, curved_, status_.time, footprint_depth_, peaks_);
        put_peaks_back();
        if (erosion_) note_buried();
        return all;
    });
    status_.max_speed = speeds.fastest, status_.mean_speed = speeds.mean;

    stress_power_ = points.stress_power;
    status_.particles = flow_.particles.count();
    status_.mass = points.mass;
    status_.momentum = {points.px, points.py};
    if (flow_.walls) close_by_walls(status_);
    status_.potential = sums.potential;
    status_.max_depth = sums.max_depth;
    status_.covered_area = sums.covered_area;
    status_.front = std::sqrt(sums.front2);
}

/// The velocity step to come, at most. At a start the nodes tell no signal yet. `max_depth`: of the nodes [m].
double DepthAveraged::next_velocity_dt(double max_depth) const {
    if (status_.dt > 0.0) return 0.5 * (status_.dt + longest_step());
    const double start = status_.max_speed_on_map + std::sqrt(flow_.gravity * max_depth);
    return 0.5 * longest_step(flow_.scheme.cfl, feed_ ? std::max(start, feed_->signal(flow_.gravity)) : start);
}

/// All that nodes have besides what was deposited on them.
NodeSums DepthAveraged::raise_surface() {
    const NodeSums sums = timed_("depth", [&] { return depth_pass(flow_, {footprint_depth_, centre_}); });
    mark_margin(flow_);
    timed_("filter", [&] {
        shock_pass(flow_, next_velocity_dt(sums.max_depth));
        filter(flow_);
        creep_filter_.pass(flow_, sums.max_depth);
    });
    lateral_pass(flow_, status_.dt > 0.0 ? status_.dt : longest_step());
    timed_("shoreline", [&] { shoreline(flow_); });
    return sums;
}

/// Every few steps points split where they spread, and tiles are brought up to date; a deposit follows.
void DepthAveraged::adapt_points(bool due, bool fed) {
    const bool has_domains = !flow_.scheme.paper_pressure;
    if (due) since_split_ = 0.0;
    const std::vector<std::uint8_t> none;
    if (fed) take_rows();
    Index born = 0;
    if (has_domains && due) born = timed_("split", [&] { return split_points(); });
    if (born == 0 && drift_ <= kDriftLimit && !due && !fed) return;
    timed_("order", [&] { sorter_.plan(flow_.particles, flow_.grid, none, flow_.active); });
    if (merger_ && due && timed_("merge", [&] { return merge_points(); }))
        timed_("order", [&] { sorter_.leave_out(transfer_->gone(), flow_.active); });
    timed_("sort", [&] { sorter_.carry_out(flow_.particles); });
    drift_ = 0.0;
}

bool DepthAveraged::exchange_is_due(double dt, double until, bool adapts) {
    erosion_->wait(dt);
    return erosion_->is_due(dt, adapts, !(status_.after(dt, until) < until));
}

/// Points that have arrived take up bed; what they deposit then has it.
void DepthAveraged::erode(const Erosion::Step& step) {
    if (passages_) passages_->note(flow_);
    const ExchangeSums sums = erosion_->exchange(flow_, step);
    if (passages_) passages_->count_moved(flow_);
    status_.bed = erosion_->status();
    drift_ += sums.max_shift;
    account(of_bed(sums));
}

/// What comes in counts as at the start.
void DepthAveraged::make_merger() {
    merger_.emplace(flow_);
    if (feed_) merger_.emplace(std::max(merger_->most(), feed_->in_a_square(flow_.cell)));
    if (late_) merger_.emplace(std::max(merger_->most(), late_->most_in_a_square()));
}

Index DepthAveraged::split_points() {
    if (passages_) splitter_.note_parents(), passages_->note(flow_);
    const Index born = splitter_.split(flow_);
    end_of_births_ = splitter_.next_id();
    if (!passages_) return born;
    if (born > 0) passages_->count_halved(flow_, flow_.particles.count() - born, splitter_.parents());
    if (!births_wanted_) splitter_.forget_parents();
    return born;
}

/// Whether there was something to merge.
bool DepthAveraged::merge_points() {
    if (passages_) merger_->note_unions(), passages_->note(flow_, &sorter_.order());
    const Index merged = merger_->merge(flow_, sorter_.order(), transfer_->gone());
    if (passages_ && merged > 0) passages_->count_merged(flow_, transfer_->gone(), merger_->into());
    return merged > 0;
}

/// dt = 2 C dx / (S + sqrt(S^2 + 2 g C dx)), S the fastest signal. It is what a signal that also accelerates by g needs
/// to cross the fraction C of a cell. A film at rest (S = 0) gets a step too.
double DepthAveraged::longest_step(double cfl, double signal) const {
    const double reach = cfl * flow_.cell;
    return 2.0 * reach / (signal + std::sqrt(signal * signal + 2.0 * flow_.gravity * reach));
}
double DepthAveraged::longest_step() const { return longest_step(flow_.scheme.cfl, fastest_signal()); }
/// What comes in next counts as if it were there already.
double DepthAveraged::fastest_signal() const {
    return feed_ ? std::max(signal_, feed_->signal(flow_.gravity)) : signal_;
}

/// How much of an ordinary step the scheme's steps are now, 1 at most. Those that an end shortens count as whole ones.
double DepthAveraged::share_of_ordinary_step() const {
    return std::min(1.0, longest_step() / longest_step(kOrdinaryCfl, fastest_signal()));
}

/// The longest stable step, shortened so that `until` is hit exactly and without a crumb before it.
double DepthAveraged::step_length(double until) const {
    // Where nothing is yet, the clock goes on to what comes first. What is due already comes in with this step: all that there
    // was has just become bed.
    const bool empty = feed_ && flow_.particles.count() == 0;
    if (empty && !feed_->over() && !feed_->due(status_.time)) until = std::min(until, feed_->next());
    return status_.step_towards(until, longest_step());
}

void DepthAveraged::account(const FlowLedger& more) {
    set_totals(since_start_.add(more), status_);
    if (flow_.walls) close_by_walls(status_);
}

/// What walls push is not seen on the nodes: it is what else the points gained.
void DepthAveraged::close_by_walls(Status& status) const {
    for (std::size_t axis = 0; axis < 2; ++axis)
        status.impulse[axis] = status.momentum[axis] + status.momentum_left[axis] - start_momentum_[axis];
}

void DepthAveraged::accumulate_grid_update(const GridUpdateSums& sums, double velocity_dt) {
    status_.kinetic = sums.kinetic;
    account(of_grid_update(sums, velocity_dt * stress_power_));
    signal_ = sums.max_signal;
}

void DepthAveraged::accumulate_points(const PointSums& sums) {
    signal_ = std::max(signal_, sums.max_signal);
    drift_ += sums.max_shift;
    status_.max_speed_on_map = sums.max_speed;
    FlowLedger step = carried_out(sums);
    step.lost_in_holes = sums.lost_in_holes;
    step.impulse = {sums.wall_impulse_x, sums.wall_impulse_y};
    account(step);
}

void DepthAveraged::require_finite(const PointSums& sums) const {
    if (sums.bad < 0) return;
    const Index p = sums.bad;
    const GridGeometry& g = flow_.grid.geometry();
    throw NumericsError(fmt::format(
        "step {}, t = {:.6g} s, dt = {:.3g} s: the point at ({:.6g}, {:.6g}) has depth {:.3g} m and would move more "
        "than "
        "four cells in one step or is not finite; reduce scheme.cfl (now {}) or look at the terrain there",
        status_.step, status_.time, status_.dt, g.x0 + flow_.particles.x[p] * g.cell,
        g.y0 + flow_.particles.y[p] * g.cell, flow_.particles.with_real([&](auto real) {
            return double{flow_.particles.carried<decltype(real)>().depth[p]};
        }),
        flow_.scheme.cfl));
}

std::vector<double> DepthAveraged::passed() const {
    std::vector<double> volumes;
    if (!passages_) return volumes;
    for (const double mass : passages_->passed()) volumes.push_back(mass / flow_.density);
    return volumes;
}

Index DepthAveraged::particle_bytes() const {
    return flow_.particles.bytes() + sorter_.bytes() + allocated(transfer_->gone()) + (merger_ ? merger_->bytes() : 0);
}

namespace {

/// Debris flows grow tenfold on their way, few of them fiftyfold. A flow that grows more takes all that it reaches, and
/// what it reaches depends on the cell.
std::string remark_on_growth(const Status& now) {
    constexpr double kMost = 100.0;
    const double given = now.mass + now.mass_left - (now.bed.eroded - now.bed.deposited);
    if (!(given > 0.0 && now.bed.eroded > kMost * given)) return "";
    return fmt::format(
        "erodible: the flow took up {:.3g} times the mass that was given to it; expected {:g} at most, since "
        "few debris flows grow fiftyfold; check erodible.depth, where it is loose (erodible.outline) and "
        "the law's numbers, and how the growth hangs on the cell (frana converge)",
        now.bed.eroded / given, kMost);
}

}  // namespace

std::vector<std::string> DepthAveraged::remarks() const {
    std::vector<std::string> remarks =
        remarks_on_lost(since_start_.total().lost_in_holes, status_.mass + status_.mass_left);
    for (const LateEntry& late : extras().late)
        if (!late.at && !late.entered)
            remarks.push_back(
                fmt::format("{}: its {:.6g} m3 did not enter: no flow deeper than {:.3g} m reached it (when_hit)",
                            late.name, late.volume, footprint_depth_));
    if (const std::string grown = remark_on_growth(status_); !grown.empty()) remarks.push_back(grown);
    if (fit_) remarks.push_back(remark_on(*fit_, flow_.cell));
    return remarks;
}

}  // namespace frana
