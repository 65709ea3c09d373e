#pragma once
// What every model saves of its points between two steps. It is their numbers in their order, and the tiles they are sorted by.
#include <algorithm>
#include <string>

#include "base/error.h"
#include "base/staggered.h"
#include "mpm/tile_grid.h"
#include "observe/archive.h"

namespace frana {

inline UserError misfit(const std::string& what) {
    return UserError("the saved state does not fit this case: " + what + "; run without --resume");
}

inline void serialize_array(Archive& archive, const std::string& name, Array& array) { archive.array(name, array); }

/// Every float is a double.
inline void serialize_array(Archive& archive, const std::string& name, ArrayOf<float>& array) {
    Array wide(array.begin(), array.end());
    archive.array(name, wide);
    if (!archive.loading()) return;
    array.resize(wide.size());
    std::transform(wide.begin(), wide.end(), array.begin(), [](double value) { return static_cast<float>(value); });
}

/// All arrays of `points`, and their ids; name(n): what the archive calls array n.
template <class Points, class Name>
void serialize_points(Archive& archive, Points& points, const Name& name) {
    const Archive::Part part(archive, "points");
    std::size_t n = 0;
    points.each([&](auto& array) { serialize_array(archive, name(n++), array); });
    archive.array("id", points.id);
    points.each([&](auto& array) {
        if (array.size() != points.id.size()) throw misfit("its arrays of points differ in length");
    });
}
template <class Points>
void serialize_points(Archive& archive, Points& points) {
    serialize_points(archive, points, [](std::size_t n) { return "column_" + std::to_string(n); });
}

/// The tiles that points are sorted by, and which points each has.
inline void serialize_tiles(Archive& archive, ActiveTiles& active) {
    archive.array("tile", active.tile);
    archive.array("begin", active.begin);
}

/// Refuses tiles that do not hold so many points, each in one of a grid's `tiles`.
inline void require_whole(const ActiveTiles& active, Index tiles, Index points) {
    const Index count = active.count();
    bool valid = static_cast<Index>(active.begin.size()) == count + 1 && active.begin.front() == 0 &&
                 active.begin.back() == points;
    for (Index n = 0; valid && n < count; ++n)
        valid = active.tile[n] >= 0 && active.tile[n] < tiles && active.begin[n] <= active.begin[n + 1] &&
                (n == 0 || active.tile[n - 1] < active.tile[n]);
    if (!valid) throw misfit("its tiles are not those of the points");
}

}  // namespace frana
