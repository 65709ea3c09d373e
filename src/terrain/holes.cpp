#include "terrain/holes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "terrain/connected_nodes.h"

namespace frana {
namespace {

/// Takes connected groups of nodes without data out of a raster's marks.
class Groups {
public:
    explicit Groups(const Raster& bed) : g_(bed.geometry), missing_(bed.values.size()) {
        for (std::size_t k = 0; k < missing_.size(); ++k) missing_[k] = std::isnan(bed.values[k]);
    }
    bool missing(Index k) const { return missing_[static_cast<std::size_t>(k)]; }

    /// The group that node k belongs to, which is marked no more.
    std::vector<Index> take(Index k) { return take_connected(g_, missing_, k); }

    /// Takes all that reaches the outer nodes.
    void take_outside() {
        for (Index j = 0; j < g_.ny; ++j)
            for (Index i = 0; i < g_.nx; i += j == 0 || j == g_.ny - 1 ? 1 : std::max<Index>(1, g_.nx - 1))
                if (missing(j * g_.nx + i)) take(j * g_.nx + i);
    }

private:
    GridGeometry g_;
    std::vector<char> missing_;
};

}  // namespace

bool has_nodata(const Raster& bed) {
    return std::any_of(bed.values.begin(), bed.values.end(), [](double z) { return std::isnan(z); });
}

Holes holes_of(const Raster& bed) {
    Holes holes;
    Groups groups(bed);
    groups.take_outside();
    for (Index k = 0; k < bed.geometry.size(); ++k) {
        if (!groups.missing(k)) continue;
        const std::vector<Index> group = groups.take(k);
        holes.nodes.insert(holes.nodes.end(), group.begin(), group.end());
        ++holes.count;
        if (static_cast<Index>(group.size()) <= holes.largest) continue;
        holes.largest = static_cast<Index>(group.size()), holes.first = k;
    }
    std::sort(holes.nodes.begin(), holes.nodes.end());
    return holes;
}

std::vector<std::string> remarks_on_lost(double lost, double all) {
    if (!(lost > 0.0)) return {};
    return {fmt::format(
        "boundary.holes: {:.6g} kg, {:.3g} % of the mass, left where the elevation model has no data inside "
        "the terrain; fill it (gdal_fillnodata.py), or make walls of its holes (boundary.holes = \"wall\")",
        lost, 100.0 * lost / all)};
}

}  // namespace frana
