#include "coupling/particle_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/error.h"
#include "coupling/at_barrier.h"
#include "coupling/barriers.h"
#include "shallow/feed.h"

namespace frana {

BarrierTiles::BarrierTiles(const GridGeometry& grid, const std::vector<std::pair<Vec3, Vec3>>& boxes, double margin)
    : x0_(grid.x0), y0_(grid.y0) {
    constexpr Index kCells = 4;  // a side: about a house, so that a tile has few barriers
    size_ = static_cast<double>(kCells) * grid.cell;
    across_ = grid.nx / kCells + 1;
    const Index rows = grid.ny / kCells + 1;
    last_i_ = static_cast<double>(across_ - 1), last_j_ = static_cast<double>(rows - 1);
    std::vector<std::pair<std::size_t, Index>> all;  // tile, number
    const auto tile = [&](double at, double last) { return static_cast<Index>(std::clamp(at / size_, 0.0, last)); };
    for (std::size_t n = 0; n < boxes.size(); ++n) {
        const auto& [low, high] = boxes[n];
        for (Index j = tile(low.y() - margin - y0_, last_j_); j <= tile(high.y() + margin - y0_, last_j_); ++j)
            for (Index i = tile(low.x() - margin - x0_, last_i_); i <= tile(high.x() + margin - x0_, last_i_); ++i)
                all.emplace_back(static_cast<std::size_t>(j * across_ + i), static_cast<Index>(n));
    }
    std::sort(all.begin(), all.end());
    begin_.assign(static_cast<std::size_t>(across_ * rows) + 1, 0);
    for (const auto& entry : all) ++begin_[entry.first + 1], numbers_.push_back(entry.second);
    for (std::size_t k = 1; k < begin_.size(); ++k) begin_[k] += begin_[k - 1];
}

ParticleWatch::ParticleWatch(const Scene& scene) : grid_(scene.bed.geometry), cell_(grid_.cell) {
    for (const Barrier& barrier : scene.barriers) {
        surfaces_.push_back(surface_around(barrier, scene));
        boxes_.push_back(box_around(surfaces_.back()));
        BarrierLoad load;
        load.about = middle_of(surfaces_.back(), &barrier, scene);
        ground_.push_back(ground_around(barrier, surfaces_.back(), scene));
        loads_.barriers.push_back(load);
        for (const BarrierNode& node : nodes_of(barrier, surfaces_.back(), scene))
            raised_.push_back(node.j * grid_.nx + node.i);
    }
    std::sort(raised_.begin(), raised_.end());
    tiles_ = BarrierTiles(scene.bed.geometry, boxes_, kClose * cell_);
    for (const Seeds* seeds : scene.all_particles())
        for (std::size_t p = 0; p < seeds->x.size(); ++p)
            if (!scene.still_surface && is_on_top({seeds->x[p], seeds->y[p]})) placed_ += seeds->volume[p];
    note_inflows(scene);
}

void ParticleWatch::note_inflows(const Scene& scene) {
    if (scene.inflows.empty()) return;
    const auto all = Feed(scene.inflows).entries(scene.end);
    for (std::size_t n = 0; n < all.size(); ++n) {
        double volume = 0.0;
        for (const Feed::Entry& entry : all[n])
            if (is_on_top(entry.at)) volume += entry.volume;
        if (volume > 0.0) enter_.push_back({scene.inflows[n].name, volume});
    }
}

bool ParticleWatch::is_on_top(const Vec2& place) const {
    const auto [first, end] = tiles_.barriers_at(place);
    return std::any_of(first, end, [&](Index n) { return is_on(static_cast<std::size_t>(n), place); });
}

bool ParticleWatch::is_on(std::size_t n, const Vec2& place) const {
    return std::isfinite(top_of(surfaces_[n], place)) && stands_out(surfaces_[n], ground_[n], place);
}

std::vector<std::string> ParticleWatch::remarks() const {
    std::vector<std::string> all;
    if (placed_ > 0.0)
        all.push_back(fmt::format(
            "barriers: found {:.4g} m3 of releases on top of barriers; expected none, since it falls from there; move "
            "the outlines apart",
            placed_));
    for (const Entering& entering : enter_)
        all.push_back(
            fmt::format("inflow {}: found {:.4g} m3 of it that enter on top of barriers by time.end; expected none, "
                        "since it falls from there; move it off their outlines, or cut them out of its area",
                        entering.inflow, entering.volume));
    return all;
}

void ParticleWatch::inherit(Index child, Index parent) {
    const auto c = static_cast<std::size_t>(child), p = static_cast<std::size_t>(parent);
    if (p >= near_.size() && c >= near_.size()) return;  // neither was near
    make_room(std::max(c, p));
    near_[c] = near_[p];
    if (const auto found = over_.find(parent); found != over_.end())
        over_[child] = found->second;
    else
        over_.erase(child);
    for (std::size_t axis = 0; axis < 2; ++axis) last_[2 * c + axis] = last_[2 * p + axis];
}

void ParticleWatch::make_room(std::size_t id) {
    if (near_.size() <= id) near_.resize(id + 1, 0);
    if (last_.size() < 2 * (id + 1)) last_.resize(2 * (id + 1), 0.0);
}

void ParticleWatch::sample(const DepthAveraged& particles, const ParticleAt& particle) {
    const auto [first, end] = tiles_.barriers_at(particle.place);
    if (first == end) return;
    const auto id = static_cast<std::size_t>(particle.id);
    make_room(id);
    const Vec2 from(last_[2 * id], last_[2 * id + 1]);
    const bool came = near_[id] > 0 && near_[id] == round_ - 1;
    bool on_its_way = false;
    for (const Index* n = first; n != end; ++n)
        on_its_way = sample_at(static_cast<std::size_t>(*n), particles, particle, came ? &from : nullptr) || on_its_way;
    near_[id] = round_;
    if (on_its_way) return;  // its way goes on from where it was outside
    for (std::size_t axis = 0; axis < 2; ++axis) last_[2 * id + axis] = particle.place[static_cast<Eigen::Index>(axis)];
}

bool ParticleWatch::on_crest(std::size_t n, const DepthAveraged& particles, const Vec2& place) const {
    if (surfaces_[n].shape) return at_crest(surfaces_[n], place, cell_);
    const Sample here = particles.at(place);
    if (here.elevation + here.depth >= top_of(surfaces_[n], place)) return true;
    const auto bed = [&](const Vec2& x) { return particles.at(x).elevation; };
    if (at_crest(bed, place, cell_)) return true;
    const auto below_top = [&](const Vec2& x) {  // a crest may itself rise, as the ground does
        const double top = top_of(surfaces_[n], x);
        return bed(x) - (std::isfinite(top) ? top : top_of(surfaces_[n], place));
    };
    return at_crest(below_top, place, cell_);
}

bool ParticleWatch::goes_over(std::size_t n, const DepthAveraged& particles, const Vec2& from, const Vec2& to) const {
    if (!crosses(surfaces_[n], ground_[n], boxes_[n], from, to)) return false;
    if (surfaces_[n].shape) return true;
    const double z = boxes_[n].second.z() - 1e6;  // as crosses() has it
    const Vec3 a(from.x(), from.y(), z), b(to.x(), to.y(), z);
    Entry in, out;
    if (!enters(surfaces_[n], a, b, in) || !enters(surfaces_[n], b, a, out)) return true;
    if (in.normal.dot(out.normal) < -0.5) return true;  // in at one side, out at the other
    return on_crest(n, particles, from + 0.5 * (in.share + 1.0 - out.share) * (to - from));
}

bool ParticleWatch::sample_at(std::size_t n, const DepthAveraged& particles, const ParticleAt& particle,
                              const Vec2* from) {
    const Vec3 top_of_it(particle.place.x(), particle.place.y(), particle.surface);
    if (!stands_near(surfaces_[n], ground_[n], boxes_[n], top_of_it, kClose * cell_, cell_)) return false;
    const auto barrier = static_cast<Index>(n);
    const auto found = over_.find(particle.id);
    const bool was_over =
        found != over_.end() && std::find(found->second.begin(), found->second.end(), barrier) != found->second.end();
    const bool came_to_it = from != nullptr && !was_over, on_it = is_on(n, particle.place);
    bool over = was_over || (on_it && at_crest(surfaces_[n], particle.place, cell_));
    const bool mesh = surfaces_[n].shape != nullptr;
    if (came_to_it)
        over = (on_it && on_crest(n, particles, particle.place)) ||
               ((mesh || !on_it) && goes_over(n, particles, *from, particle.place));
    BarrierLoad& load = loads_.barriers[n];
    // On the roof of a neighbour it does not run up this one.
    if (on_it || !particle.on_barrier) load.reach(particle.surface);
    if (over && came_to_it) load.overtopped += particle.volume;
    if (over && !was_over) over_[particle.id].push_back(barrier);
    return came_to_it && on_it && !over && !mesh;
}

bool ParticleWatch::is_raised(const Vec2& node) const {
    const Index i = std::lround((node.x() - grid_.x0) / grid_.cell),
                j = std::lround((node.y() - grid_.y0) / grid_.cell);
    if (i < 0 || j < 0 || i >= grid_.nx || j >= grid_.ny) return false;
    return std::binary_search(raised_.begin(), raised_.end(), j * grid_.nx + i);
}

double ParticleWatch::adjacent_surface(const DepthAveraged& particles, const Vec2& place) const {
    const Flow& flow = particles.flow();
    const GridGeometry& g = flow.grid.geometry();
    const auto first = [&](double at, double start, Index count) {
        return std::clamp<Index>(static_cast<Index>(std::floor((at - start) / g.cell)), 0, count - 2);
    };
    const Index i = first(place.x(), g.x0, g.nx), j = first(place.y(), g.y0, g.ny);
    double sum = 0.0, weights = 0.0;
    for (const Index b : {j, j + 1})
        for (const Index a : {i, i + 1}) {
            const double w =
                (1.0 - std::abs((place.x() - g.x(a)) / g.cell)) * (1.0 - std::abs((place.y() - g.y(b)) / g.cell));
            const Index k = flow.grid.at(a, b);
            if (!(w > 0.0) || !flow.is_in_reach(a, b) || !(flow.nodes.depth[k] > 0.0) || is_raised({g.x(a), g.y(b)}))
                continue;
            sum += w * (flow.bed.ground[k] + flow.nodes.depth[k]), weights += w;
        }
    return weights > 0.0 ? sum / weights : std::numeric_limits<double>::quiet_NaN();
}

bool ParticleWatch::is_due(DepthAveraged& particles, double before, double until) {
    for (const DepthAveraged::Birth& birth : particles.take_births()) inherit(birth.child, birth.parent);
    const Status& now = particles.status();
    moved_ += now.max_speed_on_map * (now.time - before);  // where something enters, dt begins anew
    if (moved_ < 0.5 * cell_ && now.time < until) return false;
    moved_ = 0.0;
    return true;
}

void ParticleWatch::sample_particles(const DepthAveraged& particles, double density) {
    const Flow& flow = particles.flow();
    const GridGeometry& g = flow.grid.geometry();
    const Particles& c = flow.particles;
    begin_round();
    for (Index p = 0; p < c.count(); ++p) {
        const Vec2 place(g.x0 + g.cell * c.x[p], g.y0 + g.cell * c.y[p]);
        if (!is_near(place)) continue;
        double surface = adjacent_surface(particles, place);
        const bool on_barrier = std::isnan(surface);
        if (on_barrier) {
            const Sample there = particles.at(place);
            surface = there.elevation + there.depth;
        }
        sample(particles, {c.id[p], place, surface, c.mass[p] / density, on_barrier});
    }
}

void ParticleWatch::serialize(Archive& archive) {
    const Archive::Part part(archive, "barriers");
    archive.numbers("moved", {&moved_});
    std::vector<double> sums;
    for (const BarrierLoad& load : loads_.barriers) sums.insert(sums.end(), {load.run_up, load.overtopped});
    std::vector<Index> over;  // number of the particle, of the barrier
    for (const auto& entry : over_)
        for (const Index barrier : entry.second) over.insert(over.end(), {entry.first, barrier});
    archive.number("round", round_);
    archive.array("near", near_);
    archive.array("over", over);
    archive.array("sums", sums);
    archive.array("last", last_);
    if (!archive.loading()) return;
    expect(sums.size() == 2 * loads_.barriers.size(), "a state has the barriers of its scene");
    for (std::size_t n = 0; n < loads_.barriers.size(); ++n)
        loads_.barriers[n].run_up = sums[2 * n], loads_.barriers[n].overtopped = sums[2 * n + 1];
    over_.clear();
    for (std::size_t k = 0; k + 1 < over.size(); k += 2) over_[over[k]].push_back(over[k + 1]);
}

}  // namespace frana
