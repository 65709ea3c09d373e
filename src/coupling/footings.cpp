#include "coupling/footings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "terrain/part_of.h"
#include "terrain/places.h"

namespace frana {
namespace {

/// Calls f(i, j) for a node and its eight neighbours: the slopes of those have its top in them.
template <class F>
void for_footing(const BarrierNode& node, const GridGeometry& g, F&& f) {
    const NodeBox footing = common(widened({node.i, node.j, 1, 1}, 1), NodeBox::all(g));
    for (Index j = footing.j0; j < footing.j0 + footing.ny; ++j)
        for (Index i = footing.i0; i < footing.i0 + footing.nx; ++i) f(i, j);
}

/// Of loose ground `depth` there stays what lies above a barrier's top. The rest [m], summed.
double firm_up(Raster& depth, const Raster& bed, const BarrierNode& node) {
    double firm = 0.0;
    for_footing(node, bed.geometry, [&](Index i, Index j) {
        const double z = bed.at(i, j);
        if (std::isnan(z)) return;
        const double left = std::min(depth.at(i, j), std::max(0.0, z - node.top));
        firm += std::exchange(depth.at(i, j), left) - left;
    });
    return firm;
}

/// Of releases that stand in the bed, a barrier holds what is below its top.
void hold_up(std::vector<LateRelease>& late, const Raster& bed, const std::vector<BarrierNode>& nodes) {
    for (LateRelease& release : late) {
        if (release.scar.empty()) continue;
        std::map<std::pair<Index, Index>, double> above;  // [m]
        for (const BarrierNode& node : nodes)
            above[{node.i, node.j}] = std::max(0.0, bed.at(node.i, node.j) - node.top);
        for (ScarNode& node : release.scar) {
            const NodeAt nearest = nearest_node(bed.geometry, node.at);
            const auto left = above.find({nearest.i, nearest.j});
            if (left == above.end()) continue;
            node.depth = std::min(node.depth, left->second);
            left->second -= node.depth;
        }
    }
}

}  // namespace

Footings stand_in(Scene& scene, const std::vector<BarrierNode>& nodes, Index i0, Index j0) {
    const GridGeometry g = scene.bed.geometry;
    const double area = g.cell * g.cell;
    std::vector<BarrierNode> here = nodes;
    for (BarrierNode& node : here) node.i -= i0, node.j -= j0;
    Footings footings;
    if (scene.erodible)
        for (const BarrierNode& node : here) footings.firm += area * firm_up(scene.erodible->depth, scene.bed, node);
    if (scene.cuts_later()) hold_up(scene.late, scene.bed, here);
    for (const BarrierNode& node : here) {
        double& z = scene.bed.at(node.i, node.j);
        if (!(node.top > z)) continue;
        z = node.top;
        if (!scene.forest) continue;
        for_footing(node, g, [&](Index i, Index j) {
            if (std::exchange(scene.forest->pressure.at(i, j), 0.0) > 0.0) footings.cleared += area;
        });
    }
    return footings;
}

std::vector<std::string> remarks_on(const Footings& footings) {
    std::vector<std::string> all;
    if (footings.firm > 0.0)
        all.push_back(fmt::format(
            "erodible: {:.6g} m3 of loose ground under barriers and a cell around them is taken for firm, or it "
            "would be carried away from under them; no scour at their foot is foretold",
            footings.firm));
    if (footings.displaced > 0.0)
        all.push_back(fmt::format(
            "barriers: {:.6g} m3 of the lake are not there, since barriers and the cell around them are ground",
            footings.displaced));
    if (footings.cleared > 0.0)
        all.push_back(
            fmt::format("forest: no trees stand on barriers and a cell around them, on {:.4g} ha that had some",
                        1e-4 * footings.cleared));
    return all;
}

}  // namespace frana
