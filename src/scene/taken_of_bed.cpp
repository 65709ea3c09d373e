#include "scene/taken_of_bed.h"

#include <cmath>

#include "base/compensated_sum.h"
#include "base/error.h"
#include "terrain/part_of.h"

namespace frana {

double taken_of_bed(const Scene& scene, const GridGeometry& part, const std::vector<double>& eroded_depth) {
    if (!scene.erodible || eroded_depth.empty()) return 0.0;
    expect(static_cast<Index>(eroded_depth.size()) == part.size(), "an eroded depth has a value for each node");
    const GridGeometry& whole = scene.wider ? scene.wider->grid : scene.bed.geometry;
    const NodeBox at = box_of(part, whole).value_or(NodeBox::all(part));
    const auto inside = [&](Index k, Index n) {  // of nodes on walls only a half lies inside
        return are_closed(scene.sides) && (k == 0 || k == n - 1) ? 0.5 : 1.0;
    };
    CompensatedSum sum;
    for (Index j = 0; j < part.ny; ++j)
        for (Index i = 0; i < part.nx; ++i) {
            const double depth = eroded_depth[static_cast<std::size_t>(j * part.nx + i)];
            if (!std::isnan(depth)) sum.add(inside(at.i0 + i, whole.nx) * inside(at.j0 + j, whole.ny) * depth);
        }
    return sum.value() * part.cell * part.cell * scene.erodible->density;
}

}  // namespace frana
