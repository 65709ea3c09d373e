// What holds an inflow up behind its line: the depth of the rows that follow, without mass or motion.
#include <algorithm>
#include <cmath>

#include "shallow/depth_averaged.h"
#include "shallow/sub_points.h"

namespace frana {
namespace {

constexpr double kSupport = 4.0;  ///< behind the line, beyond the reach of passes over nodes [cells]

/// Nodes that a particle's sub-points may touch, of any shape.
struct Touched {
    Index i0, i1, j0, j1;  ///< first and last
    /// Of a place and half the way between sub-points [cells].
    Touched(double x, double y, double half)
        : i0(first(x - half)), i1(last(x + half)), j0(first(y - half)), j1(last(y + half)) {}
    static Index first(double u) { return static_cast<Index>(std::floor(u)) - 1; }
    static Index last(double u) { return static_cast<Index>(std::floor(u)) + 2; }
    template <class Body>
    void for_each(Body&& body) const {
        for (Index j = j0; j <= j1; ++j)
            for (Index i = i0; i <= i1; ++i) body(i, j);
    }
};

/// Whether all tiles of those nodes are near material.
bool all_in_work(const Flow& flow, const Touched& nodes) {
    const auto tile = [](Index n) { return (n + kTile) / kTile; };
    for (Index v = tile(nodes.j0); v <= tile(nodes.j1); ++v)
        for (Index u = tile(nodes.i0); u <= tile(nodes.i1); ++u)
            if (!flow.active.in_work[v * flow.grid.tiles_x() + u]) return false;
    return true;
}

void spread(Flow& flow, const MassAt& particle, const Edges& edges) {
    double* const into = flow.nodes.column_mass.data();
    switch (flow.scheme.shape) {
        case Shape::linear:
            return spread_particle<Linear>(flow, into, particle, edges);
        case Shape::quadratic:
            return spread_particle<Quadratic>(flow, into, particle, edges);
        case Shape::cubic:
            return spread_particle<Cubic>(flow, into, particle, edges);
    }
}

/// The nodes that walls fold a node onto.
template <class Body>
void for_each_image(const Flow& flow, Index i, Index j, Body&& body) {
    const auto image = [](Index n, Index count) { return n < 0 ? -n : n >= count ? 2 * (count - 1) - n : n; };
    const Index a = image(i, flow.grid.nx()), b = image(j, flow.grid.ny());
    if (a != i) body(flow.grid.at(a, j));
    if (b != j) body(flow.grid.at(i, b));
    if (a != i && b != j) body(flow.grid.at(a, b));
}

/// [J]
double potential(const Flow& flow, Index k, double mass) {
    return flow.gravity * mass * (flow.bed.z[k] + 0.5 * mass / (flow.density * flow.area));
}

}  // namespace

/// Next to what may come in nothing sleeps: its nodes have depth that is of no particle.
void DepthAveraged::choose_sleep() { flow_.scheme.sleep = sleeps_ && !(feed_ && !feed_->over()); }

/// Before walls fold the deposit and the surface is made. Its nodes count as in reach.
void DepthAveraged::support_inflows() {
    supports_->clear();
    supported_.clear();
    if (feed_->over()) return;
    const Seeds& behind = feed_->behind(status_.time, kSupport * flow_.cell);
    const GridGeometry& g = flow_.grid.geometry();
    const auto each = [&](auto&& body) {
        for (Index n = 0; n < behind.count(); ++n) {
            const double x = (behind.x[n] - g.x0) / g.cell, y = (behind.y[n] - g.y0) / g.cell;
            const double edge = behind.size[n] / g.cell;
            const Touched nodes(x, y, edge * flow_.scheme.sub_point_reach);
            // otherwise no particle is near
            if (all_in_work(flow_, nodes)) body(MassAt{x, y, behind.volume[n] * flow_.density}, edge, nodes);
        }
    };
    each([&](const MassAt&, double, const Touched& nodes) {
        for (Index j = nodes.j0; j <= nodes.j1; ++j)
            supports_->add(flow_.grid.at(nodes.i0, j), nodes.i1 - nodes.i0 + 1);
    });
    reach_supports();
    if (flow_.walls)
        each([&](const MassAt&, double, const Touched& nodes) {
            if (nodes.i0 >= 0 && nodes.j0 >= 0 && nodes.i1 < flow_.grid.nx() && nodes.j1 < flow_.grid.ny()) return;
            nodes.for_each(
                [&](Index i, Index j) { for_each_image(flow_, i, j, [&](Index image) { supports_->add(image); }); });
        });
    if (supports_->number() == 0) return;
    supports_->for_each([&](Index k) { supported_.push_back({k, flow_.nodes.column_mass[k]}); });
    each([&](const MassAt& particle, double edge, const Touched&) { spread(flow_, particle, {edge, 0.0, 0.0, edge}); });
    activate_all(flow_);
}

/// Where what is still to come stands, the deposit has reached the nodes.
void DepthAveraged::reach_supports() {
    const Index stride = flow_.grid.stride();
    supports_->for_each([&](Index k) {
        const Index i = k % stride - kTile, j = k / stride - kTile;
        flow_.in_reach[flow_.grid.tile_of_node(i, j)] |= group_of((i + kTile) % kTile, (j + kTile) % kTile);
    });
}

/// What holds an inflow up is folded too. What is left of a node's mass without it is the flow's own.
void DepthAveraged::fold_with_support() {
    if (!flow_.walls || supported_.empty()) return fold_walls(flow_);
    for (Supported& node : supported_) node.own = flow_.nodes.column_mass[node.k] - node.own;  // now what is not
    for (int axis = 0; axis < 2; ++axis)
        for_each_wall_pair(flow_, axis, 0, [&](Index ghost, Index mirror) {
            const auto from = supported(ghost), to = supported(mirror);
            if (from && to) supported_[*to].own += supported_[*from].own;
        });
    fold_walls(flow_);
    for (Supported& node : supported_) node.own = std::max(0.0, flow_.nodes.column_mass[node.k] - node.own);
}

/// Where a node stands among those; nothing where no inflow is held up there.
std::optional<std::size_t> DepthAveraged::supported(Index k) const {
    return supports_ ? supports_->place(k) : std::nullopt;
}

/// Depth of the flow itself at a node [m].
double DepthAveraged::own_depth(Index k) const {
    const auto place = supported(k);
    if (!place) return flow_.nodes.depth[k];
    const double own = supported_[*place].own / (flow_.density * flow_.area);
    return own > flow_.dry_depth() ? own : 0.0;
}

/// Whether less than half of what lies there is the flow's own.
bool DepthAveraged::is_support(const Supported& node) const { return node.own < 0.5 * flow_.nodes.column_mass[node.k]; }

bool DepthAveraged::is_support(Index k) const {
    const auto place = supported(k);
    return place && is_support(supported_[*place]);
}

/// Sums over nodes, anew for the tiles that have some.
void DepthAveraged::leave_support_out(NodeSums& sums) {
    sums.potential -= potential_of_support();
    std::vector<Index>& tiles = support_tiles_;
    tiles.clear();
    const Index stride = flow_.grid.stride();
    for (const Supported& node : supported_) {
        const Index tile = flow_.grid.tile_of_node(node.k % stride - kTile, node.k / stride - kTile);
        if (tiles.empty() || tile != tiles.back()) tiles.push_back(tile);
    }
    std::sort(tiles.begin(), tiles.end());
    tiles.erase(std::unique(tiles.begin(), tiles.end()), tiles.end());
    for (const Index tile : tiles) {
        double deepest = 0.0, covered = 0.0, far2 = 0.0;
        for_each_node_of(flow_.grid, tile, flow_.in_reach[tile], [&](Index k, Index i, Index j) {
            const double h = own_depth(k), share = flow_.share(i, j);
            if (!(share > 0.0)) return;
            deepest = std::max(deepest, h);
            if (!(h > footprint_depth_)) return;
            covered += share * flow_.area;
            const Vec2 from = Vec2(static_cast<double>(i), static_cast<double>(j)) - centre_;
            far2 = std::max(far2, from.squaredNorm() * flow_.area);
        });
        flow_.depth_sums[tile] = {flow_.depth_sums[tile][0], deepest, covered, far2};
    }
    sums.max_depth = sums.covered_area = sums.front2 = 0.0;
    for (const Index tile : flow_.active.work) {
        const TileSums& part = flow_.depth_sums[tile];
        sums.max_depth = std::max(sums.max_depth, part[1]);
        sums.covered_area += part[2];
        sums.front2 = std::max(sums.front2, part[3]);
    }
}

void DepthAveraged::put_peaks_aside() {
    peaks_aside_.clear();
    for (const Supported& node : supported_)
        peaks_aside_.push_back({node.k, peaks_.depth[node.k], peaks_.arrival[node.k], peaks_.speed[node.k],
                                peaks_.pressure[node.k], peaks_.dynamic_pressure[node.k]});
}

/// Peaks are of the flow's own depth, which frames and the status show. Where most is support there is no speed either.
void DepthAveraged::put_peaks_back() {
    for (const NodePeaks& had : peaks_aside_) {
        const double own = own_depth(had.k), all = flow_.nodes.depth[had.k];
        peaks_.depth[had.k] = had.depth, peaks_.arrival[had.k] = had.arrival, peaks_.pressure[had.k] = had.pressure;
        if (is_support(had.k)) {
            peaks_.speed[had.k] = had.speed, peaks_.dynamic_pressure[had.k] = had.dynamic_pressure;
        } else if (all > 0.0) {
            const Pair& v = flow_.nodes.before[had.k];
            const double pressure = bed_contact(flow_, steep_, curved_, had.k, v.x, v.y).pressure * (own / all);
            peaks_.pressure[had.k] = std::max(had.pressure, pressure);
        }
        if (own > footprint_depth_ && !(had.depth > footprint_depth_)) peaks_.arrival[had.k] = status_.time;
        peaks_.depth[had.k] = std::max(had.depth, own);
    }
}

/// It is not of the flow.
double DepthAveraged::potential_of_support() const {
    double sum = 0.0;
    const Index stride = flow_.grid.stride();
    const auto share = [&](const Supported& node) {
        return flow_.share(node.k % stride - kTile, node.k / stride - kTile);
    };
    for (const Supported& node : supported_)
        sum += share(node) *
               (potential(flow_, node.k, flow_.nodes.column_mass[node.k]) - potential(flow_, node.k, node.own));
    return sum;
}

Extras DepthAveraged::extras() const {
    Extras extras;
    const double others = (late_ ? late_->entered_volume() : 0.0) + mass_added_ / flow_.density;
    if (feed_)
        extras.inflow = InflowBudget{status_.mass_in / flow_.density - others, feed_->expected(), feed_->whole()};
    if (late_) extras.late = late_->entries();
    return extras;
}

}  // namespace frana
