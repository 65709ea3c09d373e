#include "shallow/passages.h"

#include <algorithm>
#include <cmath>

namespace frana {
namespace {

/// A step moves a point by four cells at most, halving and merging by less than one.
constexpr double kWay = 4.5;
/// A point may have left the tile that it is listed in by so much before tiles are sorted again.
constexpr double kStray = 8.0;

/// Above 0: `c` lies to the left as one goes from a to b.
double side(const Vec2& a, const Vec2& b, const Vec2& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// Whether a place lies within `reach` of the box around two others.
bool in_box(const Vec2& a, const Vec2& b, const Vec2& place, double reach) {
    return place.x() >= std::min(a.x(), b.x()) - reach && place.x() <= std::max(a.x(), b.x()) + reach &&
           place.y() >= std::min(a.y(), b.y()) - reach && place.y() <= std::max(a.y(), b.y()) + reach;
}

}  // namespace

Passages::Passages(const std::vector<Section>& sections, const TileGrid& grid)
    : passed_(sections.size(), 0.0), watched_(static_cast<std::size_t>(grid.tiles()), 0) {
    const GridGeometry& g = grid.geometry();
    const auto cells = [&](const Vec2& at) { return Vec2((at.x() - g.x0) / g.cell, (at.y() - g.y0) / g.cell); };
    for (std::size_t n = 0; n < sections.size(); ++n)
        for (std::size_t k = 0; k + 1 < sections[n].line.size(); ++k)
            pieces_.push_back(
                {cells(sections[n].line[k]), cells(sections[n].line[k + 1]), n, sections[n].to_right ? 1.0 : -1.0});
    const double half = 0.5 * static_cast<double>(kTile);
    for (Index tile = 0; tile < grid.tiles(); ++tile) {
        const Vec2 middle(static_cast<double>(grid.tile_i(tile)) + half, static_cast<double>(grid.tile_j(tile)) + half);
        for (const Piece& piece : pieces_)
            if (in_box(piece.a, piece.b, middle, half + kWay + kStray)) watched_[static_cast<std::size_t>(tile)] = 1;
    }
}

bool Passages::near(const Vec2& place) const {
    return std::any_of(pieces_.begin(), pieces_.end(), [&](const Piece& piece) {
        return in_box(piece.a, piece.b, place, kWay) &&
               std::abs(side(piece.a, piece.b, place)) <= kWay * (piece.b - piece.a).norm();
    });
}

void Passages::note(const Flow& flow, const std::vector<std::int32_t>* order) {
    noted_.clear();
    const Particles& c = flow.particles;
    for (Index n = 0; n < flow.active.count(); ++n) {
        if (!watched_[static_cast<std::size_t>(flow.active.tile[n])]) continue;
        for (Index place = flow.active.begin[n]; place < flow.active.begin[n + 1]; ++place) {
            const Index p = order ? Index{(*order)[static_cast<std::size_t>(place)]} : place;
            const Vec2 at(c.x[p], c.y[p]);
            if (near(at)) noted_.push_back({p, at, c.mass[p], c.id[p]});
        }
    }
}

void Passages::count(const Vec2& from, const Vec2& to, double mass) {
    if (from == to) return;
    for (const Piece& piece : pieces_) {
        const bool was_left = side(piece.a, piece.b, from) > 0.0, is_left = side(piece.a, piece.b, to) > 0.0;
        if (was_left == is_left) continue;
        if ((side(from, to, piece.a) > 0.0) == (side(from, to, piece.b) > 0.0)) continue;
        passed_[piece.section] += was_left ? piece.sense * mass : -piece.sense * mass;
    }
}

void Passages::count_moved(const Flow& flow) {
    const Particles& c = flow.particles;
    for (const Noted& was : noted_) count(was.place, {c.x[was.p], c.y[was.p]}, was.mass);
}

void Passages::count_halved(const Flow& flow, Index first, const std::vector<Index>& parents) {
    const Particles& c = flow.particles;
    by_id_.resize(noted_.size());
    for (std::size_t n = 0; n < noted_.size(); ++n) by_id_[n] = n;
    std::sort(by_id_.begin(), by_id_.end(), [&](std::size_t a, std::size_t b) { return noted_[a].id < noted_[b].id; });
    for (const Noted& was : noted_) count(was.place, {c.x[was.p], c.y[was.p]}, c.mass[was.p]);
    const std::size_t older = parents.size() - static_cast<std::size_t>(c.count() - first);
    for (Index q = first; q < c.count(); ++q) {
        const Index parent = parents[older + static_cast<std::size_t>(q - first)];
        const auto found = std::lower_bound(by_id_.begin(), by_id_.end(), parent,
                                            [&](std::size_t n, Index id) { return noted_[n].id < id; });
        if (found == by_id_.end() || noted_[*found].id != parent) continue;
        count(noted_[*found].place, {c.x[q], c.y[q]}, c.mass[q]);
    }
}

void Passages::count_merged(const Flow& flow, const std::vector<std::uint8_t>& gone,
                            const std::vector<std::int32_t>& into) {
    const Particles& c = flow.particles;
    for (const Noted& was : noted_) {
        const std::size_t p = static_cast<std::size_t>(was.p);
        const Index now = gone[p] ? Index{into[p]} : was.p;
        count(was.place, {c.x[now], c.y[now]}, was.mass);
    }
}

}  // namespace frana
