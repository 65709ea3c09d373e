#pragma once
// Where the sub-points of four points spread, and what the exchange with the bed found of it for the deposit after it.
#include <cstdint>
#include <vector>

#include "base/simd.h"
#include "base/staggered.h"
#include "base/types.h"

namespace frana {

/// Where the sub-points of four points spread: weights of the four by four nodes that hold all of a point's.
struct WindowOfFour {
    Int4 i, j;              ///< first nodes, counted from the storage's first
    Double4 of_lane[4][4];  ///< of a row, of a point: the weights of four nodes, 256 in all
};

/// Windows of the points as they are now. Whoever moves points or changes their order forgets them.
class SubPointWindows {
public:
    /// None is known yet, for so many points in so many tiles. To find the windows of many points again costs less than to
    /// keep them where no cache has room for them.
    void start(Index points, Index tiles) {
        constexpr Index kMostPoints = 16384;  // 2.4 MB
        known_.clear();
        if (points > kMostPoints) return;
        const std::size_t slots = static_cast<std::size_t>(points / 4 + tiles + 1);
        assign_sparingly(known_, slots, std::uint8_t{0});
        if (windows_.size() >= slots) return;
        windows_ = {};  // nothing of them is wanted
        windows_ = std::vector<WindowOfFour>(slots + slots / 8);
    }
    void forget() { known_.clear(); }
    /// Whether windows are kept at all.
    bool keeps() const { return !known_.empty(); }
    /// Of the four points from p on, of the n-th tile with material. Known only where sub-points are near.
    WindowOfFour& at(Index p, Index n) { return windows_[slot(p, n)]; }
    /// nullptr where it is not known.
    const WindowOfFour* find(Index p, Index n) const {
        return keeps() && known_[slot(p, n)] ? &windows_[slot(p, n)] : nullptr;
    }
    void know(Index p, Index n, bool known) {
        if (keeps()) known_[slot(p, n)] = known;
    }

private:
    /// A tile has at most one group of fewer than four points.
    static std::size_t slot(Index p, Index n) { return static_cast<std::size_t>(p / 4 + n); }
    std::vector<WindowOfFour> windows_;
    std::vector<std::uint8_t> known_;
};

}  // namespace frana
