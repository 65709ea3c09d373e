#include "shallow/late.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "mpm/stored_points.h"
#include "shallow/merge.h"
#include "shallow/tiles_around.h"

namespace frana {
namespace {

/// Row after row from the south, each once.
std::vector<std::array<Index, 2>> nodes_of(const Seeds& seeds, const GridGeometry& grid) {
    std::vector<std::array<Index, 2>> nodes;
    for (std::size_t p = 0; p < seeds.x.size(); ++p)
        nodes.push_back({static_cast<Index>(std::floor((seeds.x[p] - grid.x0) / grid.cell + 0.5)),
                         static_cast<Index>(std::floor((seeds.y[p] - grid.y0) / grid.cell + 0.5))});
    std::sort(nodes.begin(), nodes.end(),
              [](const auto& a, const auto& b) { return a[1] != b[1] ? a[1] < b[1] : a[0] < b[0]; });
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    return nodes;
}

/// Each once.
std::vector<Index> tiles_around(const std::vector<std::array<Index, 2>>& nodes, const TileGrid& grid) {
    std::set<Index> tiles;
    for (const auto& node : nodes)
        for_each_around(grid, grid.tile_of(double(node[0]), double(node[1])), [&](Index to) { tiles.insert(to); });
    return {tiles.begin(), tiles.end()};
}

}  // namespace

LateReleases::LateReleases(const std::vector<LateRelease>& releases, const TileGrid& grid) : grid_(grid.geometry()) {
    for (const LateRelease& release : releases) {
        Entry entry{release, {}};
        entry.nodes = nodes_of(release.seeds, grid_);
        entry.tiles = tiles_around(entry.nodes, grid);
        if (release.at) entry.nodes.clear();
        entries_.push_back(std::move(entry));
    }
    entering_.reserve(entries_.size());
}

double LateReleases::next() const {
    double first = std::numeric_limits<double>::infinity();
    for (const Entry& entry : entries_)
        if (entry.entered == kNotYet && entry.release.at) first = std::min(first, *entry.release.at);
    return first;
}

Index LateReleases::next_id(Index id) const {
    for (const Entry& entry : entries_) id = std::max(id, entry.release.first_id + entry.release.seeds.count());
    return id;
}

Index LateReleases::most_in_a_square() const {
    Index most = 0;
    for (const Entry& entry : entries_) most = std::max(most, Merger::most_of(entry.release.seeds, grid_));
    return most;
}

Vec2 LateReleases::middle() const {
    Vec2 sum(0, 0);
    double volume = 0.0;
    for (const Entry& entry : entries_) {
        const Seeds& seeds = entry.release.seeds;
        for (std::size_t p = 0; p < seeds.x.size(); ++p) {
            sum += seeds.volume[p] * Vec2(seeds.x[p], seeds.y[p]);
            volume += seeds.volume[p];
        }
    }
    return volume > 0.0 ? Vec2(sum / volume) : sum;
}

double LateReleases::entered_volume() const {
    double sum = 0.0;
    for (const Entry& entry : entries_)
        if (entry.entered != kNotYet) sum += entry.release.volume();
    return sum;
}

std::vector<LateEntry> LateReleases::entries() const {
    std::vector<LateEntry> all;
    for (const Entry& entry : entries_) {
        all.push_back({entry.release.name, entry.release.volume(), entry.release.at, {}, !entry.release.scar.empty()});
        if (entry.entered != kNotYet) all.back().entered = entry.entered;
    }
    return all;
}

void LateReleases::add_tiles_to_come(std::vector<Index>& tiles) const {
    for (const Entry& entry : entries_)
        if (entry.entered == kNotYet) tiles.insert(tiles.end(), entry.tiles.begin(), entry.tiles.end());
}

void LateReleases::serialize(Archive& archive) {
    const Archive::Part part(archive, "late");
    std::vector<double> entered;
    for (const Entry& entry : entries_) entered.push_back(entry.entered);
    archive.array("entered", entered);
    if (entered.size() != entries_.size()) throw misfit("it is of another number of late releases");
    for (std::size_t n = 0; n < entries_.size(); ++n) entries_[n].entered = entered[n];
}

void LateReleases::take_over(const LateReleases& from) {
    for (std::size_t n = 0; n < entries_.size(); ++n) entries_[n].entered = from.entries_[n].entered;
}

}  // namespace frana
