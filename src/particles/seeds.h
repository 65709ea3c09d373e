#pragma once
#include <vector>

#include "base/types.h"

namespace frana {

/// The material points at the start of a run, one array per quantity, equal lengths. A point is an array of
/// material. Its mass is the integral of the release over the point's own patch of the map.
struct Seeds {
    std::vector<double> x, y;    ///< map position [m]
    std::vector<double> vx, vy;  ///< horizontal velocity [m/s]
    std::vector<double> volume;  ///< [m^3]
    std::vector<double> depth;   ///< release depth (vertical) at the point [m]
    std::vector<double> size;    ///< edge of the point's square patch [m]

    Index count() const { return static_cast<Index>(x.size()); }

    /// Those of `from` with numbers from `begin` to before `end`, behind the ones that are here.
    void append(const Seeds& from, Index begin, Index end) {
        for (auto array : {&Seeds::x, &Seeds::y, &Seeds::vx, &Seeds::vy, &Seeds::volume, &Seeds::depth, &Seeds::size})
            (this->*array).insert((this->*array).end(), (from.*array).begin() + begin, (from.*array).begin() + end);
    }
};

}  // namespace frana
