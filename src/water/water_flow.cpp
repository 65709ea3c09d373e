#include "water/water_flow.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "base/clock.h"
#include "base/discharge.h"
#include "base/error.h"
#include "base/flush_denormals.h"

namespace frana {
namespace {

/// Cells: a lake beyond a side fills dry cells in both stages of a step; one more for good measure.
constexpr Index kLakeReach = 3;

constexpr Index kBeyond = 2;  ///< nodes beyond the grid whose bed is known, for slopes at its sides

/// The bed at nodes and a little beyond, where it goes on as it ends. The lowest elevation in whole metres is the
/// datum, so that what is taken off costs no digits.
double learn_bed(const WaterScene& scene, const TileGrid& grid, LazyArray<double>& bed) {
    const GridGeometry& g = grid.geometry();
    double lowest = scene.bed(g.x0, g.y0);
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) lowest = std::min(lowest, bed[grid.at(i, j)] = scene.bed(g.x(i), g.y(j)));
    expect(std::isfinite(lowest), "water has a bed at every node");
    const double datum = std::floor(lowest);
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) bed[grid.at(i, j)] -= datum;
    const auto go_on = [&](Index last, Index step) {
        for (Index n = 1; n <= kBeyond; ++n)
            bed[last + n * step] = bed[last] + static_cast<double>(n) * (bed[last] - bed[last - step]);
    };
    for (Index j = 0; j < g.ny; ++j) go_on(grid.at(0, j), -1), go_on(grid.at(g.nx - 1, j), 1);
    for (Index i = 0; i < g.nx; ++i) go_on(grid.at(i, 0), -grid.stride()), go_on(grid.at(i, g.ny - 1), grid.stride());
    return datum;
}

/// A function at the nodes; nothing without one.
LazyArray<double> at_nodes(const WaterScene::Function& f, const TileGrid& grid) {
    if (!f) return {};
    LazyArray<double> values(grid.size());
    const GridGeometry& g = grid.geometry();
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) {
            const double value = f(g.x(i), g.y(j));
            expect(value >= 0.0, "depths and rates of water are not negative");
            values[grid.at(i, j)] = value;
        }
    return values;
}

/// Of the water beyond each side, above the datum [m].
std::array<double, 4> lakes_of(const WaterScene& scene, double datum) {
    std::array<double, 4> lakes{};
    for (std::size_t side = 0; side < lakes.size(); ++side) {
        lakes[side] = WaterBody::kNoLake;
        if (scene.sides[side] == WaterSide::level) lakes[side] = scene.side_levels[side] - datum;
        if (scene.sides[side] == WaterSide::open && scene.level) lakes[side] = *scene.level - datum;
    }
    return lakes;
}

/// One law stands in a table of its own.
std::optional<bed::LawTable> laws_of(const WaterScene& scene) {
    if (scene.bed_laws) return scene.bed_laws->laws;
    if (!scene.bed_law) return {};
    return std::visit([](const auto& law) { return bed::LawTable(std::vector<std::decay_t<decltype(law)>>{law}); },
                      *scene.bed_law);
}

}  // namespace

void WaterLedger::add(const WaterLedger& o, double share) {
    released += share * o.released, particles += share * o.particles;
    rained += share * o.rained, infiltrated += share * o.infiltrated, left += share * o.left;
    entered += share * o.entered, fed += share * o.fed;
    momentum_left += share * o.momentum_left, momentum_infiltrated += share * o.momentum_infiltrated;
    ground += share * o.ground, walls += share * o.walls, friction += share * o.friction;
    braked += share * o.braked, sheared += share * o.sheared, energy_out += share * o.energy_out;
}

WaterBody::WaterBody(const WaterScene& scene)
    : grid(scene.grid),
      now(grid.size()),
      half(grid.size()),
      driven_x(grid.size()),
      driven_y(grid.size()),
      bed(grid.size()),
      confined(grid.size()),
      normal_gravity(grid.size()),
      rain(at_nodes(scene.rain, grid)),
      infiltration(at_nodes(scene.infiltration, grid)),
      sides(scene.sides),
      friction(scene.friction.law),
      coefficient(scene.friction_at ? OnNodes<double>(at_nodes(scene.friction_at, grid))
                                    : OnNodes<double>(scene.friction.coefficient)),
      viscosity(scene.viscosity),
      bed_laws(laws_of(scene)),
      bed_law(scene.bed_laws ? OnNodes<std::uint32_t>(on_storage(scene.bed_laws->place, grid))
                             : OnNodes<std::uint32_t>(std::uint32_t{0})),
      density(scene.density),
      gravity(scene.gravity),
      theta(scene.theta),
      film(scene.film),
      datum(learn_bed(scene, grid, bed)),
      lakes(lakes_of(scene, datum)),
      steep(scene.steep) {
    if (scene.confined) confined = at_nodes(scene.confined, grid);
    if (viscosity.kinematic > 0.0 && viscosity.solid_gradient)
        for (LazyArray<double>* field : {&share, &bound_x, &bound_y}) *field = LazyArray<double>(grid.size());
    const double per = 0.5 / grid.cell();
    for (Index j = 0; j < grid.ny(); ++j)
        for (Index i = 0; i < grid.nx(); ++i) {
            const Index k = grid.at(i, j);
            const Vec2 slope = per * Vec2(bed[k + 1] - bed[k - 1], bed[k + grid.stride()] - bed[k - grid.stride()]);
            normal_gravity[k] = steep ? gravity / (1.0 + slope.squaredNorm()) : gravity;
        }
    if (!scene.curvature || !steep) return;
    curvature = LazyArray<BedCurvature>(grid.size());
    const GridGeometry& g = grid.geometry();
    for (Index j = 0; j < grid.ny(); ++j)
        for (Index i = 0; i < grid.nx(); ++i) curvature[grid.at(i, j)] = scene.curvature(g.x(i), g.y(j));
}

WaterFlow::WaterFlow(const WaterScene& scene)
    : body_(scene),
      wanted_(static_cast<std::size_t>(body_.grid.tiles())),
      rained_(static_cast<std::size_t>(body_.grid.tiles())),
      sources_(scene.sources),
      cfl_(scene.cfl) {
    expect(scene.grid.nx >= 3 && scene.grid.ny >= 3, "water needs three nodes each way");
    expect(scene.theta >= 1.0 && scene.theta <= 2.0 && scene.cfl > 0.0 && scene.cfl < 0.5 && scene.film > 0.0,
           "numbers of the water scheme are in range");
    flush_denormals_on_all_threads();
    body_.work.reserve(wanted_.size()), body_.sums.reserve(wanted_.size()), next_.reserve(wanted_.size());
    place_sources();
    place(scene);
}

/// Tiles of sources are always visited.
void WaterFlow::place_sources() {
    const TileGrid& grid = body_.grid;
    if (sources_.empty()) return;
    for (LazyArray<double>* field : {&body_.fed, &body_.fed_x, &body_.fed_y}) *field = LazyArray<double>(grid.size());
    for (const WaterSource& source : sources_) {
        expect(source.time.size() > 1 && source.discharge.size() == source.time.size() &&
                   source.speed.size() == source.time.size(),
               "each time of a source has its discharge and its speed");
        for (const WaterSource::Place& at : source.places) {
            expect(at.i >= 0 && at.j >= 0 && at.i < grid.nx() && at.j < grid.ny(), "sources lie in the grid");
            expect_water(at.i, at.j, 0);
        }
    }
}

/// Always visits the tiles of the cells around one that water may come to, within its reach of a step.
void WaterFlow::expect_water(Index i, Index j, Index reach) {
    const TileGrid& grid = body_.grid;
    const auto clamped = [](Index n, Index count) { return std::clamp<Index>(n, 0, count - 1); };
    for (const Index dj : {-reach, reach})
        for (const Index di : {-reach, reach}) {
            const Index a = clamped(i + di, grid.nx()), b = clamped(j + dj, grid.ny());
            rained_[static_cast<std::size_t>((b / kTile + 1) * grid.tiles_x() + a / kTile + 1)] = 1;
        }
}

/// What sources bring from now to `end` [s]: the table's integrals over it, so that no step loses any.
void WaterFlow::feed(double end) {
    const double per = 1.0 / (body_.grid.cell() * body_.grid.cell());
    for (const WaterSource& source : sources_)
        for (const WaterSource::Place& at : source.places) {
            const Index k = body_.grid.at(at.i, at.j);
            body_.fed[k] = body_.fed_x[k] = body_.fed_y[k] = 0.0;
        }
    for (const WaterSource& source : sources_) {
        const Through comes = between(source, status_.time, end);
        if (!(comes.volume > 0.0)) continue;
        for (const WaterSource::Place& at : source.places) {
            const Index k = body_.grid.at(at.i, at.j);
            body_.fed[k] += per * at.share * comes.volume;
            body_.fed_x[k] += per * at.share * comes.momentum * at.towards.x();
            body_.fed_y[k] += per * at.share * comes.momentum * at.towards.y();
        }
    }
}

/// Water at the start, and the first list of tiles: those of the grid, less the dry ones.
void WaterFlow::place(const WaterScene& scene) {
    const TileGrid& grid = body_.grid;
    const GridGeometry& g = grid.geometry();
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) {
            const Index k = grid.at(i, j);
            if (body_.rain && body_.rain[k] > 0.0) comes_on_ = true, expect_water(i, j, 0);
            if (body_.meets_lake(i, j)) comes_on_ = true, expect_water(i, j, kLakeReach);
            if (!scene.start) continue;
            const WaterState s = scene.start(g.x(i), g.y(j));
            expect(s.depth >= 0.0, "water at the start has no negative depth");
            const double moves = s.depth > body_.film ? s.depth : 0.0;
            body_.now.h[k] = s.depth, body_.now.qx[k] = moves * s.u, body_.now.qy[k] = moves * s.v;
        }
    for (Index tj = 0; tj * kTile < g.ny; ++tj)
        for (Index ti = 0; ti * kTile < g.nx; ++ti) body_.work.push_back((tj + 1) * grid.tiles_x() + ti + 1);
    body_.sums.resize(body_.work.size());
    for (std::size_t n = 0; n < body_.work.size(); ++n) body_.sums[n] = tile_sums(body_, body_.work[n]);
    accumulate();
    status_.volume_given = status_.volume, status_.momentum_given = status_.momentum;
}

/// The next step's tiles: those that hold water or get rain, and their neighbours near which there is water.
/// Tiles that are dropped are dry; what a stage left in them goes.
void WaterFlow::list_tiles() {
    const TileGrid& grid = body_.grid;
    const auto inside = [&](Index tile) {
        const Index i = grid.tile_i(tile), j = grid.tile_j(tile);
        return i >= 0 && j >= 0 && i < grid.nx() && j < grid.ny();
    };
    next_.clear();
    const auto want = [&](Index tile) {
        std::uint8_t& wanted = wanted_[static_cast<std::size_t>(tile)];
        if (wanted || !inside(tile)) return;
        wanted = 1;
        next_.push_back(tile);
    };
    for (std::size_t n = 0; n < body_.work.size(); ++n) {
        if (rained_[static_cast<std::size_t>(body_.work[n])]) want(body_.work[n]);
        for (Index bit = 0; bit < 9; ++bit)
            if (body_.sums[n].near >> bit & 1) want(body_.work[n] + (bit / 3 - 1) * grid.tiles_x() + bit % 3 - 1);
    }
    for (const Index tile : body_.work) {
        if (wanted_[static_cast<std::size_t>(tile)]) continue;
        const Index first = grid.at(grid.tile_i(tile), grid.tile_j(tile));
        for (Index j = 0; j < kTile; ++j)
            for (LazyArray<double>* field : {&body_.half.h, &body_.half.qx, &body_.half.qy})
                std::fill_n(&(*field)[first + j * grid.stride()], kTile, 0.0);
    }
    std::sort(next_.begin(), next_.end());
    for (const Index tile : next_) wanted_[static_cast<std::size_t>(tile)] = 0;
    body_.work.swap(next_);
    body_.sums.resize(body_.work.size());
}

/// What runs at the signal's speed, and falls by half of g at most, passes part of a cell. (It falls by g_z times the slope.)
double WaterFlow::longest_step() const {
    if (body_.work.empty()) return 0.0;
    const double reach = cfl_ * body_.grid.cell();
    double dt = 2.0 * reach / (signal_ + std::sqrt(signal_ * signal_ + body_.gravity * reach));
    if (body_.viscosity.kinematic > 0.0) dt = std::min(dt, viscous_step(body_.viscosity, body_.grid.cell()));
    return dt;
}

double WaterFlow::step_length(double until) const {
    const double longest = longest_step();
    return longest > 0.0 ? status_.step_towards(until, longest) : until - status_.time;
}

void WaterFlow::advance(double until) {
    expect(until > status_.time, "a step goes forward");
    const double dt = step_length(until);
    if (!sources_.empty()) timed_("sources", [&] { feed(status_.after(dt, until)); });
    timed_("first stage", [&] { first_stage(body_, dt); });
    timed_("second stage", [&] { second_stage(body_, dt); });
    status_.tick(dt, until);
    timed_("sums", [&] { accumulate(); });
}

/// Sums of the tiles, in their order.
WaterSums WaterFlow::summed() const {
    WaterSums all;
    for (const WaterSums& tile : body_.sums) {
        all.volume += tile.volume, all.momentum += tile.momentum, all.kinetic += tile.kinetic;
        all.max_speed2 = std::max(all.max_speed2, tile.max_speed2), all.signal = std::max(all.signal, tile.signal);
        all.ledger.add(tile.ledger);
        if (tile.bad >= 0) all.bad = tile.bad;
    }
    if (all.bad >= 0)
        throw NumericsError(
            fmt::format("free water, step {}, t = {:.6g} s, dt = {:.3g} s: node ({}, {}) has numbers "
                        "that are not finite, or a negative depth; a smaller cfl may help",
                        status_.step, status_.time, status_.dt, all.bad % body_.grid.stride() - kTile,
                        all.bad / body_.grid.stride() - kTile));
    return all;
}

/// The sums of a step.
void WaterFlow::accumulate() {
    const WaterSums all = summed();
    status_.ledger = since_start_.add(all.ledger);
    take(all);
}

/// The state that the sums tell, and the next step's tiles.
void WaterFlow::take(const WaterSums& all) {
    status_.volume = all.volume, status_.momentum = all.momentum, status_.kinetic = all.kinetic;
    status_.max_speed = std::sqrt(all.max_speed2);
    signal_ = all.signal;
    list_tiles();
}

void WaterFlow::take_changes(const std::vector<Index>& tiles) {
    const TileGrid& grid = body_.grid;
    next_.clear();
    std::set_union(body_.work.begin(), body_.work.end(), tiles.begin(), tiles.end(), std::back_inserter(next_));
    const auto outside = [&](Index tile) {
        const Index i = grid.tile_i(tile), j = grid.tile_j(tile);
        return i < 0 || j < 0 || i >= grid.nx() || j >= grid.ny();
    };
    next_.erase(std::remove_if(next_.begin(), next_.end(), outside), next_.end());
    body_.work.swap(next_);
    body_.sums.resize(body_.work.size());
    const double volume = status_.volume;
    const Vec2 momentum = status_.momentum;
    for (std::size_t n = 0; n < body_.work.size(); ++n) body_.sums[n] = tile_sums(body_, body_.work[n]);
    take(summed());
    WaterLedger from_particles;
    from_particles.released = status_.volume - volume, from_particles.particles = status_.momentum - momentum;
    status_.ledger = since_start_.add(from_particles);
}

double WaterFlow::due_so_far() const {
    double sum = 0.0;
    for (const WaterSource& source : sources_) sum += volume_until(source, status_.time);
    return sum;
}

double WaterFlow::due_at_all() const {
    double sum = 0.0;
    for (const WaterSource& source : sources_) sum += volume_until(source, source.time.back());
    return sum;
}

bool WaterFlow::sources_go_on() const {
    return std::any_of(sources_.begin(), sources_.end(),
                       [&](const WaterSource& source) { return status_.time < source.time.back(); });
}

bool WaterFlow::soaks_in() const {
    if (!body_.infiltration) return false;
    const TileGrid& grid = body_.grid;
    const auto soaks = [&](Index tile) {
        const Index i0 = grid.tile_i(tile), j0 = grid.tile_j(tile);
        for (Index j = std::max<Index>(j0, 0); j < std::min(j0 + kTile, grid.ny()); ++j)
            for (Index i = std::max<Index>(i0, 0); i < std::min(i0 + kTile, grid.nx()); ++i) {
                const Index k = grid.at(i, j);
                if (body_.infiltration[k] > 0.0 && body_.now.h[k] > 0.0) return true;
            }
        return false;
    };
    return std::any_of(body_.work.begin(), body_.work.end(), soaks);
}

WaterState WaterFlow::at(Index i, Index j) const {
    const Index k = body_.grid.at(i, j);
    const double h = body_.now.h[k], per = h > body_.film ? 1.0 / h : 0.0;
    return {h, per * body_.now.qx[k], per * body_.now.qy[k]};
}

double WaterFlow::surface(Index i, Index j) const {
    const Index k = body_.grid.at(i, j);
    return body_.datum + body_.bed[k] + body_.confined[k] + body_.now.h[k];
}

double WaterFlow::volume_faster_than(double speed) const {
    double depths = 0.0;
    const TileGrid& grid = body_.grid;
    for (const Index tile : body_.work) {
        const Index i0 = grid.tile_i(tile), j0 = grid.tile_j(tile);
        for (Index j = j0; j < std::min(j0 + kTile, grid.ny()); ++j)
            for (Index i = i0; i < std::min(i0 + kTile, grid.nx()); ++i) {
                const WaterState here = at(i, j);
                if (std::hypot(here.u, here.v) > speed) depths += here.depth;
            }
    }
    return grid.cell() * grid.cell() * depths;
}

double WaterFlow::volume_residual() const {
    const WaterLedger& l = status_.ledger;
    return status_.volume + l.left + l.infiltrated - l.rained - l.entered - l.fed - l.released - status_.volume_given;
}

Vec2 WaterFlow::momentum_residual() const {
    const WaterLedger& l = status_.ledger;
    return status_.momentum + l.momentum_left + l.momentum_infiltrated - status_.momentum_given - l.ground - l.walls -
           l.friction - l.particles;
}

}  // namespace frana
