// Where a depth-averaged run gives its material to another model, and what it tells of its particles.
#include <fmt/core.h>
#include <omp.h>

#include <algorithm>
#include <cmath>

#include "base/compensated_sum.h"
#include "base/error.h"
#include "shallow/depth_averaged.h"
#include "shallow/shock.h"
#include "shallow/sides.h"

namespace frana {
namespace {

/// Of point p above node k [J].
template <class Real>
double kinetic_of(const Flow& flow, Index p, Index k) {
    const auto& held = flow.particles.carried<Real>();
    const double vx = held.vx[p], vy = held.vy[p];
    const double vz = flow.steep ? vx * flow.bed.slope_x[k] + vy * flow.bed.slope_y[k] : 0.0;
    return 0.5 * flow.particles.mass[p] * (vx * vx + vy * vy + vz * vz);
}

/// What tiles that sleep deposited stays: not next to what comes or goes.
void wake_all(Flow& flow) {
    for (const Index tile : flow.active.tile) flow.active.quiet[tile] = 0;
}

}  // namespace

void DepthAveraged::open_exits(const NodeBox& nodes, bool leave_now) {
    for (Index j = nodes.j0; j < nodes.j0 + nodes.ny; ++j)
        for (Index i = nodes.i0; i < nodes.i0 + nodes.nx; ++i) flow_.bed.exit[flow_.grid.at(i, j)] = kNoted;
    flow_.bed.has_exits = true;
    flow_.departed.resize(static_cast<std::size_t>(omp_get_max_threads()));
    if (leave_now) leave_at_exits();
}

void DepthAveraged::catch_up() {
    if (status_.dt == 0.0) return;
    const Frame now = frame();
    flow_.particles.with_real([&](auto real) {
        using Real = decltype(real);
        Carried<Real>& held = flow_.particles.carried<Real>();
        for (Index p = 0; p < flow_.particles.count(); ++p)
            held.vx[p] = static_cast<Real>(probe_.vx[p]), held.vy[p] = static_cast<Real>(probe_.vy[p]);
    });
    status_ = now.status;
    since_start_ = until_frame_;
    status_.dt = 0.0;
}

void DepthAveraged::close_exits() {
    flow_.scheme.sleep = sleeps_;
    flow_.bed.has_exits = false;
    for (Index j = 0; j < flow_.grid.ny(); ++j)
        for (Index i = 0; i < flow_.grid.nx(); ++i) {
            std::uint8_t& exit = flow_.bed.exit[flow_.grid.at(i, j)];
            if (exit == kNoted) exit = 0;
            flow_.bed.has_exits = flow_.bed.has_exits || exit != 0;
        }
}

bool DepthAveraged::may_stand(double x, double y) const {
    const GridGeometry& g = flow_.grid.geometry();
    if (!(x >= g.x0 && x <= g.x_max() && y >= g.y0 && y <= g.y_max())) return false;
    return flow_.bed.exit[flow_.grid.nearest((x - g.x0) / g.cell, (y - g.y0) / g.cell)] == 0;
}

double DepthAveraged::take_in(const Seeds& seeds, const std::vector<Mat2>& gradient, double time) {
    Particles& c = flow_.particles;
    const Index before = c.count();
    expect(gradient.size() == seeds.x.size(), "particles that come in have a gradient each");
    expect(before == 0 || time == status_.time, "particles that come in are at the time of the others");
    if (before == 0) status_.time = time, status_.dt = 0.0;
    wake_all(flow_);
    PointSums came;
    double kinetic = 0.0;
    c.with_real([&](auto real) {
        using Real = decltype(real);
        append<Real>(seeds, splitter_.next_id());
        for (Index p = before; p < c.count(); ++p) {
            const Mat2& of = gradient[static_cast<std::size_t>(p - before)];
            Carried<Real>& held = c.carried<Real>();
            held.cxx[p] = static_cast<Real>(of(0, 0)), held.cxy[p] = static_cast<Real>(of(0, 1));
            held.cyx[p] = static_cast<Real>(of(1, 0)), held.cyy[p] = static_cast<Real>(of(1, 1));
            const Index k = flow_.grid.nearest(c.x[p], c.y[p]);
            kinetic += kinetic_of<Real>(flow_, p, k);
            leave<Real>(flow_, p, k, came);
        }
    });
    splitter_.set_next_id(splitter_.next_id() + seeds.count());
    FlowLedger back = carried_in(came);
    back.mass_in = 0.0, back.mass_left = -came.left_mass;  // it had left
    account(back);
    status_.kinetic += kinetic;  // of nodes, and to the next grid update only
    signal_ = std::max(signal_, status_.max_speed_on_map);
    sorter_.sort(c, flow_.grid, {}, flow_.active);
    drift_ = 0.0;
    arrive(transfer_->deposit(flow_, 0.5 * (status_.dt + longest_step())));
    signal_ = std::max(signal_, status_.max_speed_on_map + std::sqrt(flow_.gravity * status_.max_depth));
    shock_pass(flow_,
               next_velocity_dt(status_.max_depth));  // with the step that follows from this, as a resumed run has it
    return came.left_energy;
}

/// Rows of inflows that are complete now, behind the particles that are there. A sort and a deposit have to follow.
void DepthAveraged::take_rows() {
    const Feed::Particles& rows = feed_->take(status_.time);
    Particles& c = flow_.particles;
    const Index before = c.count();
    if (erosion_ && before == 0) erosion_->start_anew(true);
    const GridGeometry& g = flow_.grid.geometry();
    PointSums came;
    double kinetic = 0.0;
    c.with_real([&](auto real) {
        using Real = decltype(real);
        append<Real>(rows.seeds, splitter_.next_id());
        Carried<Real>& held = c.carried<Real>();
        for (Index p = before; p < c.count(); ++p) {
            for (auto* zero : {&held.cxx, &held.cxy, &held.cyx, &held.cyy, &held.r1y, &held.r2x}) (*zero)[p] = Real{0};
            const Index k = flow_.grid.nearest(c.x[p], c.y[p]);
            kinetic += kinetic_of<Real>(flow_, p, k);
            leave<Real>(flow_, p, k, came);
            const auto n = static_cast<std::size_t>(p - before);
            const auto i = static_cast<Index>(std::lround(c.x[p])), j = static_cast<Index>(std::lround(c.y[p]));
            const bool over_area = rows.seeds.vx[n] == 0.0 && rows.seeds.vy[n] == 0.0;  // onto what lies there
            if (over_area && before > 0 && flow_.is_in_reach(i, j))
                came.left_energy += c.mass[p] * flow_.gravity * flow_.nodes.depth[k];
            const Vec2 from = (rows.from[n] - Vec2(g.x0, g.y0)) / g.cell;
            if (passages_) passages_->count(from, {c.x[p], c.y[p]}, c.mass[p]);
        }
    });
    if (erosion_) erosion_->begin(flow_, before, false);
    splitter_.set_next_id(splitter_.next_id() + rows.seeds.count());
    account(carried_in(came));
    status_.kinetic += kinetic;  // of nodes, and to the next grid update only
    for (Index n = 0; n < rows.seeds.count(); ++n)
        signal_ = std::max(
            signal_, std::hypot(rows.seeds.vx[n], rows.seeds.vy[n]) + std::sqrt(flow_.gravity * rows.seeds.depth[n]));
    if (before == 0) status_.dt = 0.0, since_split_ = 0.0;  // as at a start
    if (feed_->over()) wake_all(flow_), choose_sleep();
}

/// Releases whose time has come, and those that the flow has reached. What enters may reach others.
void DepthAveraged::enter_late() {
    const auto reached = [this](Index i, Index j) {
        const Index k = flow_.grid.at(i, j);
        return flow_.is_in_reach(i, j) && flow_.nodes.depth[k] > footprint_depth_ && !is_support(k);
    };
    for (;;) {
        const std::vector<const LateRelease*>& releases = late_->enter(status_.time, reached);
        if (releases.empty()) return;
        take_late(releases);
    }
}

/// Returns the kinetic energy that it brings [J].
template <class Real>
double DepthAveraged::place_late(const LateRelease& release, PointSums& came) {
    Particles& c = flow_.particles;
    const Index before = c.count();
    append<Real>(release.seeds, release.first_id);
    Carried<Real>& held = c.carried<Real>();
    double kinetic = 0.0;
    CompensatedSum mass(came.left_mass);
    for (Index p = before; p < c.count(); ++p) {
        for (auto* zero : {&held.cxx, &held.cxy, &held.cyx, &held.cyy, &held.r1y, &held.r2x}) (*zero)[p] = Real{0};
        const Index k = flow_.grid.nearest(c.x[p], c.y[p]);
        kinetic += kinetic_of<Real>(flow_, p, k);
        leave<Real>(flow_, p, k, came);
        mass.add(c.mass[p]);
    }
    came.left_mass = mass.value();
    if (erosion_) erosion_->begin(flow_, before, true);
    return kinetic;
}

/// All that moves is brought to the present. So the next step is as at a start for all of it. Potential energy comes in
/// as the nodes count it, with what a flow on a falling bed loses: the release lifts it as far again.
void DepthAveraged::take_late(const std::vector<const LateRelease*>& releases) {
    if (flow_.particles.count() > 0) catch_up();
    if (erosion_) erosion_->start_anew(flow_.particles.count() == 0);
    status_.dt = 0.0, since_split_ = 0.0;
    wake_all(flow_);
    const double potential = status_.potential, signal = signal_;
    for (const LateRelease* release : releases)
        if (!release->scar.empty()) timed_("erosion", [&] { erosion_->cut(flow_, release->scar); });
    PointSums came;
    double kinetic = 0.0;
    flow_.particles.with_real([&](auto real) {
        for (const LateRelease* release : releases) kinetic += place_late<decltype(real)>(*release, came);
    });
    FlowLedger in = carried_in(came);
    status_.kinetic += kinetic;  // of nodes, and to the next grid update only
    signal_ = status_.max_speed_on_map;
    sorter_.sort(flow_.particles, flow_.grid, {}, flow_.active);
    drift_ = 0.0;
    arrive(timed_("deposit", [&] { return transfer_->deposit(flow_, 0.5 * longest_step()); }));
    signal_ = std::max(signal, status_.max_speed_on_map + std::sqrt(flow_.gravity * status_.max_depth));
    in.energy_left = -(kinetic + (status_.potential - potential));
    account(in);
}

std::string DepthAveraged::why_not_add(const Seeds& particles) const {
    for (Index n = 0; n < particles.count(); ++n)
        if (!may_stand(particles.x[n], particles.y[n]))
            return fmt::format(
                "found the place ({:.10g}, {:.10g}); expected one on the terrain that the run holds now, and "
                "not where material leaves it; choose another one, or a larger terrain.window",
                particles.x[n], particles.y[n]);
    return "";
}

void DepthAveraged::add(const Seeds& particles) {
    added_.append(particles, 0, particles.count());
    if (!aside_) enter_added();
}

/// As a release whose time has come.
void DepthAveraged::enter_added() {
    LateRelease release;
    release.seeds = std::move(added_);
    added_ = {};
    release.first_id = splitter_.next_id();
    splitter_.set_next_id(release.first_id + release.seeds.count());
    mass_added_ += release.volume() * flow_.density;
    take_late({&release});
}

/// Drops the points at exits and deposits the others again, recording what left as at other exits.
void DepthAveraged::leave_at_exits() {
    wake_all(flow_);
    const Particles& c = flow_.particles;
    std::vector<std::uint8_t> gone(static_cast<std::size_t>(c.count()), 0);
    PointSums left;
    double kinetic = 0.0;
    for (Index p = 0; p < c.count(); ++p) {
        const Index k = flow_.grid.nearest(c.x[p], c.y[p]);
        if (!leads_out(flow_.bed.exit[k])) continue;
        gone[static_cast<std::size_t>(p)] = 1;
        flow_.particles.with_real([&](auto real) {
            kinetic += kinetic_of<decltype(real)>(flow_, p, k);
            leave<decltype(real)>(flow_, p, k, left);
        });
    }
    account(carried_out(left));
    status_.kinetic = std::max(0.0, status_.kinetic - kinetic);  // of nodes, and to the next grid update only
    sorter_.drop(flow_.particles, gone, flow_.active);
    arrive(transfer_->deposit(flow_, 0.5 * (status_.dt + longest_step())));
}

std::vector<Departed> DepthAveraged::take_departed() {
    std::vector<Departed> all;
    for (std::vector<Departed>& list : flow_.departed) {
        all.insert(all.end(), list.begin(), list.end());
        list.clear();
    }
    std::sort(all.begin(), all.end(), [](const Departed& a, const Departed& b) { return a.id < b.id; });
    return all;
}

std::vector<DepthAveraged::Birth> DepthAveraged::take_births() {
    std::vector<Birth> births;
    const std::vector<Index> parents = splitter_.take_parents();
    const Index first = end_of_births_ - static_cast<Index>(parents.size());  // later numbers are of what came in
    for (std::size_t n = 0; n < parents.size(); ++n) births.push_back({first + static_cast<Index>(n), parents[n]});
    return births;
}

}  // namespace frana
