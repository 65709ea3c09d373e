#pragma once
// Releases that enter a run later, at their time or when the flow reaches them: THEORY section 17.
#include <array>
#include <limits>
#include <vector>

#include "mpm/tile_grid.h"
#include "observe/archive.h"
#include "observe/frame.h"
#include "scene/scene.h"

namespace frana {

class LateReleases {
public:
    LateReleases(const std::vector<LateRelease>& releases, const TileGrid& grid);

    /// When the next one enters by its time [s]; infinite: none.
    double next() const;

    /// Those that enter at `time` [s], in the order of the case. Their time has come, or `reached(i, j)` holds for a
    /// node in whose cell they have particles. They count as entered from now on.
    template <class Reached>
    const std::vector<const LateRelease*>& enter(double time, Reached&& reached) {
        entering_.clear();
        for (Entry& entry : entries_) {
            if (entry.entered != kNotYet || !is_due(entry, time, reached)) continue;
            entry.entered = time;
            entering_.push_back(&entry.release);
        }
        return entering_;
    }

    /// Calls body(release) for those that have entered, in the order of the case.
    template <class Body>
    void for_each_entered(Body&& body) const {
        for (const Entry& entry : entries_)
            if (entry.entered != kNotYet) body(entry.release);
    }

    /// The first number that none of their particles has, and none below `id`.
    Index next_id(Index id) const;
    /// How many particles of one of them a half-cell square holds at most.
    Index most_in_a_square() const;
    /// The middle of their mass, on the map.
    Vec2 middle() const;
    /// Volume of those that entered [m3].
    double entered_volume() const;
    std::vector<LateEntry> entries() const;
    /// Adds the tiles that the particles still to come lie in, and the adjacent ones. A tile may come more than once.
    void add_tiles_to_come(std::vector<Index>& tiles) const;

    void serialize(Archive& archive);
    void take_over(const LateReleases& from);

private:
    static constexpr double kNotYet = std::numeric_limits<double>::infinity();
    struct Entry {
        LateRelease release;
        std::vector<std::array<Index, 2>> nodes;  ///< in whose cells it has particles; of those with a time none
        std::vector<Index> tiles = {};            ///< that its particles lie in, and adjacent ones
        double entered = kNotYet;                 ///< [s]
    };
    template <class Reached>
    static bool is_due(const Entry& entry, double time, Reached&& reached) {
        if (entry.release.at) return *entry.release.at <= time;
        for (const auto& node : entry.nodes)
            if (reached(node[0], node[1])) return true;
        return false;
    }

    GridGeometry grid_;
    std::vector<Entry> entries_;
    std::vector<const LateRelease*> entering_;  ///< scratch
};

}  // namespace frana
