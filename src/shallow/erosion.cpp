#include "shallow/erosion.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "law/bed/node_friction.h"
#include "mpm/domain.h"
#include "mpm/tile_points.h"
#include "scene/bed_smoothing.h"
#include "shallow/ground_of_four.h"
#include "shallow/sub_points_of_four.h"
#include "shallow/tiles_around.h"

namespace frana {
namespace {

/// A node never gives its last billionth of a thousandth: rounding must not take more than there is.
constexpr double kCrumb = 1e-12;

/// One half, middle first, of the weights of so many passes of (1, 2, 1)/4, without tails below 1e-10.
std::vector<double> half_filter(Index passes) {
    std::vector<double> w(static_cast<std::size_t>(passes) + 1, 0.0);
    w[0] = 1.0;
    for (Index pass = 0; pass < passes; ++pass) {
        const std::vector<double> before = w;
        const Index size = static_cast<Index>(w.size());
        const auto at = [&](Index n) { return n < size ? before[static_cast<std::size_t>(n)] : 0.0; };
        for (Index n = 0; n < static_cast<Index>(w.size()); ++n)
            w[static_cast<std::size_t>(n)] = 0.5 * at(n) + 0.25 * (at(n + 1) + at(std::abs(n - 1)));
    }
    while (w.size() > 1 && w.back() < 1e-10) w.pop_back();
    return w;
}

/// Nothing to take.
ErodibleBed rock_of(const Scene& scene) {
    ErodibleBed bed;
    bed.density = scene.density;
    return bed;
}

/// Sums of four kinds at once, without loss (Knuth's sum of two).
struct SumOfFour {
    Double4 sum = {}, lost = {};
    [[gnu::always_inline]] void add(Double4 term) {
        const Double4 next = sum + term, part = next - sum;
        lost += (sum - (next - part)) + (term - part), sum = next;
    }
    double value() const {
        CompensatedSum all;
        for (int lane = 0; lane < 4; ++lane) all.add(sum[lane]), all.add(lost[lane]);
        return all.value();
    }
};

/// Flow::share of four nodes in a row.
Double4 shares_of_four(const Flow& flow, Index i, Index j) {
    if (!flow.walls) return all(1.0);
    return Double4{flow.share(i, j), flow.share(i + 1, j), flow.share(i + 2, j), flow.share(i + 3, j)};
}

}  // namespace

Erosion::Erosion(const Scene& scene, Flow& flow)
    : Erosion(scene, scene.erodible ? *scene.erodible : rock_of(scene), flow) {}

Erosion::Erosion(const Scene& scene, const ErodibleBed& bed, Flow& flow)
    : law_(bed.law),
      friction_(scene.bed_law),
      momentum_(bed.momentum),
      min_depth_(bed.min_depth),
      density_(bed.density),
      per_area_(1.0 / (density_ * flow.area)),
      per_area_of_flow_(1.0 / (flow.density * flow.area)),
      fresh_crumb_(kCrumb * flow.cell / per_area_of_flow_),
      takes_(scene.erodible.has_value()),
      evolves_(bed.evolves),
      curved_(scene.terrain != TerrainModel::shallow && scene.curvature == Curvature::full),
      bent_path_(flow.bed.smoothed),
      left_(flow.grid.size()),
      initial_(flow.grid.size()),
      demand_(flow.grid.size()),
      taken_(flow.grid.size()),
      gained_(flow.grid.size()),
      share_(flow.grid.size()),
      holds_(flow.grid.tiles()),
      changed_(flow.grid.tiles()),
      tile_mass_(flow.grid.tiles()),
      tile_deepest_(flow.grid.tiles()),
      marked_(static_cast<std::size_t>(flow.grid.tiles()), 0),
      moved_(flow.grid.tiles()),
      in_reach_(flow.grid.tiles()),
      tile_energy_(flow.grid.tiles()) {
    const TileGrid& grid = flow.grid;
    expect(flow.scheme.shape == Shape::quadratic && !flow.scheme.paper_pressure,
           "a bed that changes needs quadratic shapes");
    for (Index j = 0; j < grid.ny(); ++j)
        for (Index i = 0; i < grid.nx(); ++i) {
            const Index k = grid.at(i, j);
            if (takes_ && flow.bed.exit[k] == 0) initial_[k] = bed.depth.at(i, j) / per_area_;
        }
    if (flow.walls)  // beyond them lie the mirror particles
        for (Index j = -kGhosts; j < grid.ny() + kGhosts; ++j)
            for (Index i = -kGhosts; i < grid.nx() + kGhosts; ++i) {
                const auto mirror = [](Index n, Index count) {
                    return n < 0 ? -n : n >= count ? 2 * (count - 1) - n : n;
                };
                initial_[grid.at(i, j)] = initial_[grid.at(mirror(i, grid.nx()), mirror(j, grid.ny()))];
            }
    prepare_deposition(scene, flow);
    prepare_forest(scene, flow);
    prepare_scars(scene, flow);
    for (Index tile = 0; tile < grid.tiles(); ++tile) {
        bool any = false;
        for_each_node_of(grid, tile, [&](Index k, Index, Index) {
            left_[k] = initial_[k];
            any = any || initial_[k] > 0.0;
        });
        if (!any) continue;
        ledger_tiles_.push_back(tile);
        count_tile(flow, tile);
    }
    status_changed();
    initial_mass_ = mass_;
    if (!evolves_) return;
    // Steps compute these anew, tile by tile: all of it comes from the same lines.
    for (Index tile = 0; tile < grid.tiles(); ++tile) refresh_slopes(grid, flow.bed, tile);
    if (!bent_path_) return;
    pending_ = LazyArray<double>(grid.size()), tile_pending_ = LazyArray<double>(grid.tiles());
    rows_ = LazyArray<double>(grid.size());
    filter_ = half_filter(smoothing_passes(scene.scheme, grid.cell()));
    for (Index tile = 0; tile < grid.tiles(); ++tile) refresh_path(grid, flow.bed, tile);
}

void Erosion::count_tile(const Flow& flow, Index tile) {
    SumOfFour mass;
    Double4 deepest = {};
    Mask4 holds = {};
    for_each_four_of(flow.grid, tile, kAllGroups, [&](Index k, Index i, Index j) {
        const Double4 left = load(&left_[k]), none = {};
        mass.add(shares_of_four(flow, i, j) * (deposits_ ? left + load(&fresh_[k]) : left));
        holds |= there_is<Double4>(k) > none;
        deepest = max(deepest, (load(&initial_[k]) - left) * per_area_);
    });
    tile_mass_[tile] = mass.value(), holds_[tile] = any(holds), tile_deepest_[tile] = largest(deepest);
}

/// Sums of all tiles, in their order.
void Erosion::status_changed() {
    CompensatedSum mass;
    deepest_ = 0.0;
    for (const Index tile : ledger_tiles_) {
        mass.add(tile_mass_[tile]);
        deepest_ = std::max(deepest_, tile_deepest_[tile]);
    }
    mass_ = mass.value();
}

Status::Bed Erosion::status() const {
    return {initial_mass_, mass_, eroded_.value(), deposited_.value(), energy_.value(), deepest_};
}

/// What a node, or four, has to give, less than nothing where only a crumb is left [kg].
template <class Real>
Real Erosion::there_is(Index k) const {
    const Real old = read<Real>(&left_[k]) - kCrumb * read<Real>(&initial_[k]), none = {};
    if (!deposits_) return old;
    const Real lies = read<Real>(&fresh_[k]);
    return select(lies > none, old + (lies - fresh_crumb_), old);
}

/// The same in this step: where something has just come to rest, nothing is taken. Under a release that still stands
/// there, only what was left on top of it is.
template <class Real>
Real Erosion::can_give(Index k) const {
    Real all = there_is<Real>(k), none = {};
    if (buried_) {
        const Real on_top = deposits_ ? read<Real>(&fresh_[k]) - fresh_crumb_ : none;
        all = select(read<Real>(&buried_[k]) > none, on_top, all);
    }
    if (raised_tiles_.empty() || !raised_) return all;
    return select(read<Real>(&raised_[k]) > none, none, all);
}

/// An exchange stands for three steps. Where it would take more than a share of the flow that gains, one comes in each
/// step.
constexpr double kMostSteps = 3.0;
constexpr double kMostShare = 0.01;

/// What the last exchange took ahead tells how many steps it was to serve.
bool Erosion::is_due(double dt, bool adapts, bool last) const {
    return takes_ && (adapts || last || waited_ > 2.0 * ahead_ + 0.5 * dt || share_rate_ * (waited_ + dt) > kMostShare);
}

/// THEORY.md, section 18: what comes until the next exchange moves with the mass of the middle of that time.
Erosion::Stretch Erosion::next_stretch(const Step& step) {
    const double owed = waited_ - ahead_, dt = step.dt;
    const bool each = share_rate_ * kMostSteps * dt > kMostShare;
    const double steps = each ? 1.0 : std::min(kMostSteps, step.sorted);
    waited_ = 0.0, ahead_ = std::max({0.0, -owed, std::min(0.5 * (steps - 1.0) * dt, step.left)});
    return {owed + ahead_, owed, owed - 0.5 * dt, dt, step.velocity_dt};
}

ExchangeSums Erosion::exchange(Flow& flow, const Step& step) {
    ExchangeSums all;
    constexpr double kRoundOff = 1e-12;
    const Stretch stretch = next_stretch(step);
    if (!takes_ || !(stretch.whole > kRoundOff * step.dt)) return all;
    share_rate_ = 0.0;
    if (!choose(flow)) return all;
    make_room(flow);
    find_demand(flow, stretch);
    scarce_ = find_shares(flow);
    if (scarce_) share_out(flow);
    flow.particles.with_real(
        [&](auto real) { for_each_eroding(flow, [&](Index n) { grow<decltype(real)>(flow, n); }); });
    lower(flow);
    CompensatedSum taken;
    double gained = 0.0;
    for (Index n = 0; n < flow.active.count(); ++n) {
        if (!eroding_[static_cast<std::size_t>(n)]) continue;
        const ExchangeSums& of = sums_[static_cast<std::size_t>(n)];
        taken.add(of.taken), all.px += of.px, all.py += of.py, all.lost += of.lost;
        gained += of.gained;
        all.max_shift = std::max(all.max_shift, of.max_shift);
    }
    unmark_raised(flow);
    for (const Index tile : nodes_) energy_.add(tile_energy_[tile]);
    all.taken = taken.value();
    if (gained > 0.0) share_rate_ = all.taken / (gained * stretch.whole);
    eroded_.add(all.taken);
    status_changed();
    return all;
}

/// Which tiles' points may take something, and which tiles' nodes they reach.
bool Erosion::choose(const Flow& flow) {
    const ActiveTiles& active = flow.active;
    eroding_.assign(static_cast<std::size_t>(active.count()), 0);
    nodes_.clear();
    bool any = false;
    for (Index n = 0; n < active.count(); ++n) {
        const Index tile = active.tile[n];
        if (active.quiet[tile] >= kAsleep) continue;
        bool near = false;
        for_each_around(flow.grid, tile, [&](Index to) { near = near || holds_[to]; });
        if (!near) continue;
        any = true, eroding_[static_cast<std::size_t>(n)] = 1;
        for_each_around(flow.grid, tile, [&](Index to) { marked_[static_cast<std::size_t>(to)] = 1; });
    }
    for (const Index tile : active.work)
        if (std::exchange(marked_[static_cast<std::size_t>(tile)], std::uint8_t{0}) || flow.walls)
            nodes_.push_back(tile);
    return any;
}

void Erosion::make_room(const Flow& flow) {
    const std::size_t count = static_cast<std::size_t>(flow.particles.count());
    for (Array* array : {&wanted_, &missed_, &speed_, &braked_, &extra_x_, &extra_y_, &from_x_, &from_y_})
        resize_sparingly(*array, count);
    const std::size_t tiles = static_cast<std::size_t>(flow.active.count());
    sums_.assign(tiles, {}), spread_to_.resize(tiles);
}

namespace {

/// The window of four points, not next to the grid's sides, in `room`; nullptr where sub-points are too far away.
template <class Real>
const WindowOfFour* window_of(const Flow& flow, Index p, int lanes, WindowOfFour& room) {
    const Particles& c = flow.particles;
    const Carried<Real>& held = c.carried<Real>();
    const Domains r{load(&held.r1x[p], lanes), load(&held.r1y[p], lanes), load(&held.r2x[p], lanes),
                    load(&held.r2y[p], lanes)};
    return find_window(flow, load(&c.x[p], lanes), load(&c.y[p], lanes), r, room) ? &room : nullptr;
}

}  // namespace

/// Adds numbers of points to nodes as their mass is: by sub-points.
template <class Real>
void Erosion::spread(Flow& flow, Index n, const Array& masses, LazyArray<double>& into) {
    const Particles& c = flow.particles;
    const Carried<Real>& held = c.carried<Real>();
    StencilMarks marks = flow.marks_of(flow.active.tile[n]);
    const bool at_side = !flow.walls && near_side(flow.grid, flow.active.tile[n]);
    const Index stride = flow.grid.stride();
    WindowOfFour room;
    for_each_four(flow.active.begin[n], flow.active.begin[n + 1], [&](Index p, int lanes) {
        const Double4 m = load(&masses[p], lanes), none = {};
        if (!any(m > none)) return;
        const Double4 x = load(&c.x[p], lanes), y = load(&c.y[p], lanes);
        marks.mark(floor_positive(x + (kTile - 0.5)), floor_positive(y + (kTile - 0.5)), lanes);
        const WindowOfFour* const window = at_side ? nullptr : window_of<Real>(flow, p, lanes, room);
        if (window) return spread_window(stride, into.data(), lanes, m, *window);
        for (Index q = p; q < p + lanes; ++q)
            spread_particle<Quadratic>(flow, into.data(), {c.x[q], c.y[q], masses[q]}, edges_of(held, q));
    });
    spread_to_[static_cast<std::size_t>(n)] = marks.reach(kReachBefore, kReachAfter);
}

template void Erosion::spread<double>(Flow&, Index, const Array&, LazyArray<double>&);
template void Erosion::spread<float>(Flow&, Index, const Array&, LazyArray<double>&);

/// The nodes that the chosen tiles' points gave something to. At walls all: mirror particles give too.
void Erosion::collect_reach(const Flow& flow) {
    for (const Index tile : nodes_) in_reach_[tile] = flow.walls ? kAllGroups : 0;
    if (flow.walls) return;
    for (Index n = 0; n < flow.active.count(); ++n)
        if (eroding_[static_cast<std::size_t>(n)])
            for_each_around(flow.grid, flow.active.tile[n], [&](Index to, std::size_t m) {
                in_reach_[to] |= spread_to_[static_cast<std::size_t>(n)][m];
            });
}

/// Closes the domain at walls. Adds what mirror particles bring, and gives the nodes beyond what their mirror nodes
/// have.
void Erosion::fold(const Flow& flow, LazyArray<double>& field) const {
    if (!flow.walls) return;
    for (int axis = 0; axis < 2; ++axis)
        for_each_wall_pair(flow, axis, 0, [&](Index ghost, Index mirror) { field[mirror] += field[ghost]; });
    for (int axis = 0; axis < 2; ++axis)
        for_each_wall_pair(flow, axis, 1, [&](Index ghost, Index mirror) { field[ghost] = field[mirror]; });
}

/// THEORY (73): the share of the demand that each node can give. Whether some node has too little.
bool Erosion::find_shares(Flow& flow) {
    next_.assign(nodes_.size(), 0);
    const Index count = static_cast<Index>(nodes_.size());
#pragma omp parallel for schedule(dynamic, 1) if (count >= kTilesForThreads)
    for (Index n = 0; n < count; ++n) {
        Mask4 scarce = {};
        const Double4 none = {}, one = all(1.0);
        const Index tile = nodes_[static_cast<std::size_t>(n)];
        for_each_four_of(flow.grid, tile, in_reach_[tile], [&](Index k, Index, Index) {
            const Double4 can = max(can_give<Double4>(k), none), wants = load(&demand_[k]);
            const Mask4 lacks = wants > can;
            store(&share_[k], select(lacks, can / select(lacks, wants, one), one));
            scarce |= lacks;
        });
        next_[static_cast<std::size_t>(n)] = any(scarce);
    }
    return std::any_of(next_.begin(), next_.end(), [](Index scarce) { return scarce != 0; });
}

/// THEORY (74) and (75): each point gets by its poorest node, then what nodes have left over goes round. Few points get less
/// than they demand: what those miss goes to the nodes.
void Erosion::share_out(Flow& flow) {
    flow.particles.with_real([&](auto real) {
        using Real = decltype(real);
        for_each_eroding_in_turn(flow, [&](Index n) {
            take_shares<Real>(flow, n);
            spread<Real>(flow, n, missed_, taken_);
        });
        fold(flow, taken_);
        for_each_in_parallel(nodes_, [&](Index tile) {
            for_each_four_of(flow.grid, tile, in_reach_[tile], [&](Index k, Index, Index) {
                const Double4 none = {}, one = all(1.0), wants = load(&demand_[k]);
                const Double4 given = max(wants - load(&taken_[k]), none);
                const Double4 more = max(min(wants, can_give<Double4>(k)) - given, none);
                const Double4 share = select(wants > none, more / select(wants > none, wants, one), none);
                store(&share_[k], share), store(&taken_[k], given + share * wants);
            });
        });
        for_each_eroding(flow, [&](Index n) { take_left_over<Real>(flow, n); });
    });
}

namespace {

/// Whether all nodes that sub-points of four points can reach have the same share; not next to the grid's sides.
bool all_usual(const Flow& flow, const LazyArray<double>& share, double usual, Double4 x, Double4 y, int lanes) {
    const Int4 i = floor_positive(x + (kTile - 1.0)) - 1, j = floor_positive(y + (kTile - 1.0)) - 1;
    const Index stride = flow.grid.stride();
    Mask4 other = {};
    for (int lane = 0; lane < lanes; ++lane) {
        const double* row = share.data() + j[lane] * stride + i[lane];
        for (int b = 0; b < 6; ++b, row += stride) other |= (load(row) != usual) | (load(row + 2) != usual);
    }
    return !any(other);
}

/// Calls take(p, number) for the points of a tile that have a demand. The number is what of_window finds on the shares
/// of the window's nodes. Where sub-points lie too far away for a window, it is that of of_point(p, edges). Among nodes
/// of the usual share it is that share.
template <class Real, class OfWindow, class OfPoint, class Take>
void for_each_wanting(Flow& flow, Index n, const Array& wanted, const LazyArray<double>& share, double usual,
                      OfWindow&& of_window, OfPoint&& of_point, Take&& take) {
    const Particles& c = flow.particles;
    const Carried<Real>& held = c.carried<Real>();
    const bool at_side = !flow.walls && near_side(flow.grid, flow.active.tile[n]);
    const Index stride = flow.grid.stride();
    WindowOfFour room;
    for_each_four(flow.active.begin[n], flow.active.begin[n + 1], [&](Index p, int lanes) {
        const Double4 none = {};
        if (!any(load(&wanted[p], lanes) > none)) return;
        const Double4 x = load(&c.x[p], lanes), y = load(&c.y[p], lanes);
        const bool alike = !at_side && all_usual(flow, share, usual, x, y, lanes);
        const WindowOfFour* const window = alike || at_side ? nullptr : window_of<Real>(flow, p, lanes, room);
        const auto number = [&](Index q, int lane) {
            if (alike) return usual;
            if (!window) return of_point(q, edges_of(held, q));
            return of_window(*window, lane, share.data() + window->j[lane] * stride + window->i[lane]);
        };
        for (int lane = 0; lane < lanes; ++lane)
            if (wanted[p + lane] > 0.0) take(p + lane, number(p + lane, lane));
    });
}

}  // namespace

template <class Real>
void Erosion::take_shares(Flow& flow, Index n) {
    for (Index p = flow.active.begin[n]; p < flow.active.begin[n + 1]; ++p) missed_[p] = 0.0;
    const auto of_window = [&](const WindowOfFour& window, int lane, const double* row) {
        Double4 least = all(1.0);
        for (int b = 0; b < 4; ++b, row += flow.grid.stride())
            least = select(window.of_lane[b][lane] > 0.0, min(least, load(row)), least);
        return std::min(std::min(least[0], least[1]), std::min(least[2], least[3]));
    };
    const auto of_point = [&](Index p, const Edges& edges) {
        double least = 1.0;
        for_each_sub_point<Quadratic>(
            flow, flow.particles.x[p], flow.particles.y[p], edges, [&](const auto& sx, const auto& sy) {
                for (int j = 0; j < 3; ++j)
                    for (int i = 0; i < 3; ++i)
                        if (sx.w[i] * sy.w[j] > 0.0)
                            least = std::min(least, share_[flow.grid.at(sx.base + i, sy.base + j)]);
            });
        return least;
    };
    for_each_wanting<Real>(flow, n, wanted_, share_, 1.0, of_window, of_point,
                           [&](Index p, double least) { missed_[p] = wanted_[p] - least * wanted_[p]; });
}

template <class Real>
void Erosion::take_left_over(Flow& flow, Index n) {
    const auto of_window = [&](const WindowOfFour& window, int lane, const double* row) {
        const Index up = flow.grid.stride();
        const auto of_row = [&](int b) { return window.of_lane[b][lane] * load(row + b * up); };
        const Double4 sum = (of_row(0) + of_row(3)) + (of_row(1) + of_row(2));
        return kOfWindow * ((sum[0] + sum[3]) + (sum[1] + sum[2]));
    };
    const auto of_point = [&](Index p, const Edges& edges) {
        double more = 0.0;
        for_each_sub_point<Quadratic>(
            flow, flow.particles.x[p], flow.particles.y[p], edges, [&](const auto& sx, const auto& sy) {
                for (int j = 0; j < 3; ++j)
                    for (int i = 0; i < 3; ++i)
                        more += sx.w[i] * sy.w[j] * share_[flow.grid.at(sx.base + i, sy.base + j)];
            });
        return 0.25 * more;
    };
    for_each_wanting<Real>(flow, n, wanted_, share_, 0.0, of_window, of_point, [&](Index p, double mean) {
        const double wanted = wanted_[p], gets = (wanted - missed_[p]) + mean * wanted;
        wanted_[p] = gets;
        if (gets < wanted) return_part(flow, p, gets / wanted);
    });
}

/// Points take what they gained into their motion.
template <class Real>
void Erosion::grow(Flow& flow, Index n) {
    Particles& c = flow.particles;
    Carried<Real>& held = c.carried<Real>();
    Double4 taken = {}, gained = {}, px = {}, py = {}, lost = {};
    for_each_four(flow.active.begin[n], flow.active.begin[n + 1], [&](Index p, int lanes) {
        const Double4 gain = load(&wanted_[p], lanes), mass = load(&c.mass[p], lanes), none = {}, one = all(1.0);
        const Mask4 grows = gain > none;
        if (!any(grows)) return;
        const Double4 vx = load(&held.vx[p], lanes), vy = load(&held.vy[p], lanes);
        const Double4 share = gain / select(grows, mass, one), grown = 1.0 + share;
        const Double4 braked = momentum_ > 0.0 ? load(&braked_[p], lanes) : none;
        const Double4 factor = select(grows, speeds_left(share, braked), one);
        for (auto* array : {&held.cxx, &held.cxy, &held.cyx, &held.cyy})
            store(&(*array)[p], factor * load(&(*array)[p], lanes), lanes);
        const Double4 wx = select(grows, load(&extra_x_[p], lanes), none),
                      wy = select(grows, load(&extra_y_[p], lanes), none);
        store(&held.vx[p], factor * vx + wx, lanes), store(&held.vy[p], factor * vy + wy, lanes);
        const Double4 now = mass + gain, speed = load(&speed_[p], lanes);
        store(&c.mass[p], now, lanes);
        taken += now - mass;
        gained += select(grows, mass, none);
        const Double4 nx = load(&held.vx[p], lanes), ny = load(&held.vy[p], lanes), v2 = vx * vx + vy * vy;
        px += now * nx - mass * vx, py += now * ny - mass * vy;
        const Double4 slower = 1.0 - grown * (nx * nx + ny * ny) / select(v2 > none, v2, one);
        lost += select(grows, 0.5 * mass * speed * speed * slower, none);
    });
    ExchangeSums& sums = sums_[static_cast<std::size_t>(n)];
    sums.taken = sum(taken), sums.gained = sum(gained), sums.px = sum(px), sums.py = sum(py), sums.lost = sum(lost);
}

/// The bed loses what the points gained.
void Erosion::lower(Flow& flow) {
    for_each_in_parallel(nodes_, [&](Index tile) { lower_tile(flow, tile); });
    if (evolves_) follow_bed(flow);
}

void Erosion::lower_tile(Flow& flow, Index tile) {
    Double4 energy = {};
    TileBox any_taken;
    for_each_four_of(flow.grid, tile, in_reach_[tile], [&](Index k, Index i, Index j) {
        const Double4 none = {}, left = load(&left_[k]), lies = deposits_ ? load(&fresh_[k]) : none;
        const Double4 taken = max(min(load(scarce_ ? &taken_[k] : &demand_[k]), left + lies), none);
        store(&demand_[k], none), store(&taken_[k], none);
        if (!any(taken > none)) return;
        const Double4 of_fresh = min(taken, lies), old = taken - of_fresh;  // of a node the deposit goes first
        const Double4 sinks = evolves_ ? old * per_area_ + of_fresh * per_area_of_flow_ : none,
                      rises = taken * per_area_of_flow_;
        const Double4 z = load(&flow.bed.z[k]), h = load(&flow.nodes.depth[k]);
        energy += shares_of_four(flow, i, j) * flow.gravity *
                  (taken * (z - sinks + 0.5 * rises) + flow.density * flow.area * h * (rises - sinks));
        store(&left_[k], max(left - old, none));
        if (deposits_) store(&fresh_[k], lies - of_fresh);
        const Index a = i - flow.grid.tile_i(tile), b = j - flow.grid.tile_j(tile);
        any_taken.add({a, a + 4, b, b + 1});
        if (!evolves_) return;
        store(&flow.bed.z[k], z - sinks);
        store(&flow.bed.ground[k], load(&flow.bed.ground[k]) - sinks);
        if (bent_path_) store(&pending_[k], load(&pending_[k]) - sinks);
    });
    tile_energy_[tile] = sum(energy);
    if (any_taken.empty()) return;
    if (bent_path_) tile_pending_[tile] = most_pending(flow, tile);
    changed_[tile] = 1;
    marked_[static_cast<std::size_t>(tile)] = evolves_;
    if (evolves_) moved_[tile] = any_taken;
    count_tile(flow, tile);
}

double Erosion::most_pending(const Flow& flow, Index tile) const {
    Double4 most = {};
    for_each_four_of(flow.grid, tile, kAllGroups,
                     [&](Index k, Index, Index) { most = max(most, abs(load(&pending_[k]))); });
    return largest(most);
}

}  // namespace frana
