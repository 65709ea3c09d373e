#include "terrain/sparse_rasters.h"

#include <cmath>

#include "base/error.h"
#include "terrain/part_of.h"

namespace frana {
Index SparseRasters::pixels() const {
    Index sum = 0;
    for (const Row& row : rows) sum += row.count;
    return sum;
}

SparseRasters sparse_of(const std::vector<const double*>& fields, const double* cover, const GridGeometry& part,
                        const GridGeometry& whole, double above) {
    const NodeBox box = box_of(part, whole).value_or(NodeBox{-1, -1, 0, 0});
    expect(box.i0 >= 0 && box.j0 >= 0 && box.i0 + box.nx <= whole.nx && box.j0 + box.ny <= whole.ny,
           "a part lies within the whole grid");
    SparseRasters sparse;
    sparse.values.resize(fields.size());
    for (Index j = 0; j < part.ny; ++j)
        for (Index i = 0; i < part.nx; ++i) {
            const Index from = j * part.nx + i;
            if (!(cover[from] > above)) continue;
            const std::int64_t pixel = (box.j0 + j) * whole.nx + box.i0 + i;
            if (sparse.rows.empty() || sparse.rows.back().first + sparse.rows.back().count != pixel)
                sparse.rows.push_back({pixel, 0});
            ++sparse.rows.back().count;
            for (std::size_t f = 0; f < fields.size(); ++f) {
                const double value = fields[f][from];
                sparse.values[f].push_back(std::isfinite(value) ? static_cast<float>(value) : 0.0F);
            }
        }
    return sparse;
}

}  // namespace frana
