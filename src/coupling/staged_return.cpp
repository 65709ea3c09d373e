// Points of a run in stages that become particles again: those that leave their window, and in the end all.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "coupling/displaced.h"
#include "coupling/staged_run.h"
#include "terrain/bed_points.h"
#include "terrain/part_of.h"
#include "terrain/places.h"

namespace frana {
namespace {

/// Whether a wall in a hole of the terrain stands there.
bool in_hole_wall(const Flow& flow, const Vec2& x) {
    const GridGeometry& g = flow.grid.geometry();
    if (!(x.x() >= g.x0 && x.x() <= g.x_max() && x.y() >= g.y0 && x.y() <= g.y_max())) return false;
    return flow.bed.exit[flow.grid.nearest((x.x() - g.x0) / g.cell, (x.y() - g.y0) / g.cell)] == kWall;
}

}  // namespace

/// Of the points that left, those that left where particles may stand. That is beyond the window's open sides, or onto
/// a wall in a hole there, before which they then stand. Until they are particles the others go on to feel them.
void StagedRun::note_departed() {
    for (const DepartedPoint& point : points_->take_departed()) {
        const Vec2 x = point.position.head<2>();
        if (!depth_averaged().may_stand(x.x(), x.y()) && !in_hole_wall(depth_averaged().flow(), x)) continue;
        returning_.push_back(point);
        points_->set_adjacent(point);
    }
}

/// Where a point has come to, or where it left if particles may not stand there.
Vec2 StagedRun::where_allowed(const DepartedPoint& point, const Vec2& to) const {
    return depth_averaged().may_stand(to.x(), to.y()) ? to : Vec2(point.position.head<2>());
}

/// Where a particle of a point that has come to `to` stands. It is there, or where it left. A barrier may raise the
/// ground of particles that the point is not above. Or a hole may have a wall. Then it is before them on its own side.
/// Where the window ends near a barrier and particles have no cell there, it is one of the window. They leave that
/// again in their next step: on the barrier they would gain its height. Not so before a hole. Points do not feel its
/// wall, and would run down the same cells again and again.
Vec2 StagedRun::place_of_particle(const DepartedPoint& point, const Vec2& to) {
    Vec2 x = where_allowed(point, to);
    const Flow& flow = depth_averaged().flow();
    const bool at_hole = in_hole_wall(flow, x);
    if (!at_hole && (!on_raised(x) || above_barrier(x))) return x;
    const auto nearest = [&](std::uint8_t kind) {
        return nearest_before(point, x, [&](Index i, Index j) { return exit_at(i, j) == kind; });
    };
    std::optional<Vec2> place = nearest(0);
    if (!place && !at_hole) place = nearest(kNoted);
    if (!place) returned_.raised += point.mass;
    return place.value_or(x);
}

/// Where particles leave at a node, and how.
std::uint8_t StagedRun::exit_at(Index i, Index j) const {
    const NodeAt origin = terrain_->origin();
    const Flow& flow = depth_averaged().flow();
    return flow.bed.exit[flow.grid.at(i + origin.i, j + origin.j)];
}

/// Not beyond the terrain, where points may be.
bool StagedRun::is_raised(Index i, Index j) const {
    const GridGeometry& g = scene_.bed.geometry;
    if (raised_.empty() || i < 0 || j < 0 || i >= g.nx || j >= g.ny) return false;
    return raised_[static_cast<std::size_t>(j * g.nx + i)] != 0;
}

bool StagedRun::on_raised(const Vec2& x) const {
    const auto [i, j] = nearest_node(scene_.bed.geometry, x);
    return is_raised(i, j);
}

/// Whether a point's particle may stand at x: on the terrain, in an allowed cell that no barrier raises or hides from
/// it.
bool StagedRun::may_stand(const DepartedPoint& point, const Vec2& x, const Allowed& allowed) const {
    const GridGeometry& g = scene_.bed.geometry;
    const auto [i, j] = nearest_node(g, x);
    return between_nodes(g, x) && !is_raised(i, j) && allowed(i, j) && !behind_barrier(point.position, x);
}

/// In the cell of a node, as near to x as can be.
Vec2 StagedRun::in_cell(Index i, Index j, const Vec2& x) const {
    constexpr double kWithin = 0.499;  // of a cell: what belongs to its node for certain
    const GridGeometry& g = scene_.bed.geometry;
    const auto near = [&](double u, double node, double low, double high) {
        return std::clamp(u, std::max(low, node - kWithin * g.cell), std::min(high, node + kWithin * g.cell));
    };
    return {near(x.x(), g.x(i), g.x0, g.x_max()), near(x.y(), g.y(j), g.y0, g.y_max())};
}

/// The nearest place to x in the allowed cells that no barrier raises or hides.
std::optional<Vec2> StagedRun::edge_before(const DepartedPoint& point, const Vec2& x, const Allowed& allowed) const {
    constexpr Index kFar = 3;  // cells
    const GridGeometry& g = scene_.bed.geometry;
    const auto [i0, j0] = nearest_node(g, x);
    std::optional<Vec2> edge;
    double least = std::numeric_limits<double>::max();
    for (Index j = std::max<Index>(0, j0 - kFar); j <= std::min(g.ny - 1, j0 + kFar); ++j)
        for (Index i = std::max<Index>(0, i0 - kFar); i <= std::min(g.nx - 1, i0 + kFar); ++i) {
            if (is_raised(i, j) || !allowed(i, j)) continue;
            const Vec2 place = in_cell(i, j, x);
            if ((place - x).norm() >= least || behind_barrier(point.position, place)) continue;
            least = (place - x).norm(), edge = place;
        }
    return edge;
}

/// Behind the edge of the nearest cell to x of those that no barrier raises or hides. The place is kSpread times as far
/// behind it as x lies before it. So what leaves the window there is not heaped on the next cells.
std::optional<Vec2> StagedRun::nearest_before(const DepartedPoint& point, const Vec2& x, const Allowed& allowed) const {
    constexpr double kSpread = 4.0;  // chosen
    const std::optional<Vec2> edge = edge_before(point, x, allowed);
    if (!edge) return std::nullopt;
    for (double spread = kSpread; spread > 1.0; spread -= 1.0) {
        const Vec2 place = *edge + spread * (*edge - x);
        if (may_stand(point, place, allowed)) return place;
    }
    const auto [i, j] = nearest_node(scene_.bed.geometry, *edge);
    return in_cell(i, j, 2.0 * *edge - x);
}

/// Their ground is filtered: nodes adjacent to those that a barrier raises are raised too.
void StagedRun::mark_raised() {
    const GridGeometry& g = scene_.bed.geometry;
    raised_.assign(static_cast<std::size_t>(g.size()), 0);
    for (const BarrierNode& node : barrier_nodes(scene_)) {
        if (!(node.top > scene_.bed.at(node.i, node.j))) continue;
        const NodeBox around = common(widened({node.i, node.j, 1, 1}, 1), NodeBox::all(g));
        for (Index j = around.j0; j < around.j0 + around.ny; ++j)
            for (Index i = around.i0; i < around.i0 + around.nx; ++i)
                raised_[static_cast<std::size_t>(j * g.nx + i)] = 1;
    }
}

bool StagedRun::above_barrier(const Vec2& place) const {
    const std::vector<Surface>& surfaces = points_->body().surfaces;
    return std::any_of(surfaces.begin(), surfaces.end(),
                       [&](const Surface& s) { return s.is_barrier() && std::isfinite(top_of(s, place)); });
}

/// Whether a barrier stands between a point and a place, at the point's height.
bool StagedRun::behind_barrier(const Vec3& from, const Vec2& place) const {
    Entry entry;
    const Vec3 to(place.x(), place.y(), from.z());
    const std::vector<Surface>& surfaces = points_->body().surfaces;
    return std::any_of(surfaces.begin(), surfaces.end(),
                       [&](const Surface& s) { return s.is_barrier() && enters(s, from, to, entry); });
}

/// How much of a point its particle has room for where it stands on the ramp of a barrier [1]: what is above it.
double StagedRun::share_above_ramp(const DepartedPoint& point, const Vec2& x) const {
    const double size = std::cbrt(point.mass / scene_.density), ground = depth_averaged().at(x).elevation;
    return std::clamp(0.5 + (point.position.z() - ground) / size, 0.0, 1.0);
}

/// At the end of the stage all points stand where they are. Of those on the ramp of a barrier the part below it is
/// moved to the nearest cell before it, and spreads from there. A cell that holds points goes before a dry one.
void StagedRun::clear_ramps() {
    const GridGeometry& g = scene_.bed.geometry;
    const Flow& flow = depth_averaged().flow();
    const auto is_open = [&](Index i, Index j) { return !is_raised(i, j) && exit_at(i, j) == 0; };
    Displaced displaced(g, scene_.density, [&](Index node) {
        const Index i = node % g.nx, j = node / g.nx;
        return is_open(i, j) ? bed_below(scene_.bed, g.x(i), g.y(j)) : std::numeric_limits<double>::quiet_NaN();
    });
    const double time = points_->status().time;
    const auto now = [&](const DepartedPoint& point) {
        return where_allowed(point, point.position.head<2>() + (time - point.time) * point.velocity.head<2>());
    };
    const auto node_at = [&](const Vec2& x) {
        const auto [i, j] = nearest_node(g, x);
        return std::clamp<Index>(j, 0, g.ny - 1) * g.nx + std::clamp<Index>(i, 0, g.nx - 1);
    };
    const auto on_ramp = [&](const Vec2& x) { return on_raised(x) && !above_barrier(x) && !in_hole_wall(flow, x); };
    std::vector<DepartedPoint> before, ramp;
    for (const DepartedPoint& point : returning_) {
        const Vec2 x = now(point);
        if (on_ramp(x)) {
            ramp.push_back(point);
            continue;
        }
        before.push_back(point);
        const double ground = bed_below(scene_.bed, x.x(), x.y());
        if (!on_raised(x)) displaced.stay(point, node_at(x), std::isfinite(ground) ? ground : point.position.z());
    }
    std::vector<DepartedPoint> stay;
    for (DepartedPoint& point : ramp) {
        const Vec2 x = now(point);
        const double above = share_above_ramp(point, x);
        if (above < 1.0) {
            std::optional<Vec2> edge =
                edge_before(point, x, [&](Index i, Index j) { return displaced.holds(j * g.nx + i); });
            if (!edge) edge = edge_before(point, x, is_open);
            if (edge) {
                displaced.move(point, 1.0 - above, node_at(*edge));
                point.mass *= above, point.energy *= above;
            } else
                returned_.raised += (1.0 - above) * point.mass;
        }
        if (point.mass > 0.0) stay.push_back(point);
    }
    displaced.spread();
    returning_.clear();
    for (const DepartedPoint& point : before) {
        const Vec2 x = now(point);
        returning_.push_back(on_raised(x) ? point : displaced.joined(point, node_at(x)));
    }
    const std::vector<DepartedPoint> laid = displaced.laid(time);
    returning_.insert(returning_.end(), laid.begin(), laid.end());
    returning_.insert(returning_.end(), stay.begin(), stay.end());
}

/// They become particles. What these have no place for, motion up and down and against each other, is lost.
void StagedRun::convert_to_2d(const PlaceOf& place) {
    const double time = points_->status().time;
    note_largest();
    for (const DepartedPoint& point : returning_) returned_.mass += point.mass, returned_.lost += point.energy;
    const MovingParticles particles =
        particles_of(returning_, scene_, {time, place, [&](const Vec2& x) { return depth_averaged().at(x).depth; }});
    returned_.lost -= depth_averaged().take_in(particles.seeds, particles.gradient, time);
    returning_.clear();
}

/// All points become particles, and the window is a part of the map like any other.
void StagedRun::end_3d() {
    timed_("3D to 2D", [&] {
        note_largest();
        points_->set_adjacent(GhostParticles{});
        points_->leave();
        terrain_->close_exits();
        depth_averaged().catch_up();
        std::vector<DepartedPoint> all = points_->take_departed();
        if (returning_.empty())
            returning_ = std::move(all);
        else
            returning_.insert(returning_.end(), all.begin(), all.end());
        if (!raised_.empty()) clear_ramps();
        convert_to_2d([&](const DepartedPoint& point, const Vec2& to) {
            const Vec2 x = where_allowed(point, to);
            return in_hole_wall(depth_averaged().flow(), x) ? place_of_particle(point, to) : x;
        });
        returning_.shrink_to_fit();
        ended_ = true;
    });
    timed_("map", [&] {
        map_.sample(*points_, points_->status().time);
        if (!watch_) return;
        watch_->end();
        sample_particles();
    });
}

}  // namespace frana
