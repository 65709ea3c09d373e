#pragma once
// What every model saves of its points between two steps. It is their numbers in their order, and the tiles they are sorted by.
#include <string>

#include "base/error.h"
#include "mpm/tile_grid.h"
#include "observe/archive.h"

namespace frana {

inline UserError misfit(const std::string& what) {
    return UserError("the kept state does not fit this case: " + what + "; run without --resume");
}

/// All columns of `points`, and their ids.
template <class Points>
void serialize_points(Archive& archive, Points& points) {
    const Archive::Part part(archive, "points");
    int n = 0;
    points.each([&](auto& column) { archive.array("column_" + std::to_string(n++), column); });
    archive.array("id", points.id);
    points.each([&](auto& column) {
        if (column.size() != points.id.size()) throw misfit("its columns of points differ in length");
    });
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
