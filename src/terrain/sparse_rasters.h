#pragma once
// Rasters of one grid that have values in a few places only: of the pixels that a flow has reached.
#include <cstdint>
#include <vector>

#include "terrain/raster.h"

namespace frana {

/// Several fields on the same pixels, which are rows of neighbours. Elsewhere they are zero.
struct SparseRasters {
    /// Pixels first, first + 1, ..., first + count - 1 of the grid's values.
    struct Row {
        std::int64_t first = 0, count = 0;
    };
    std::vector<Row> rows;                   ///< ascending, none touches the next
    std::vector<std::vector<float>> values;  ///< by field, then by pixel in the order of the rows

    Index pixels() const;
    /// Calls body(pixel, n) for each pixel, n its place in the values.
    template <class Body>
    void for_each(Body&& body) const {
        for_each_pixel(rows, body);
    }
    template <class Body>
    static void for_each_pixel(const std::vector<Row>& rows, Body&& body) {
        std::size_t n = 0;
        for (const Row& row : rows)
            for (std::int64_t k = 0; k < row.count; ++k) body(static_cast<Index>(row.first + k), n++);
    }
};

/// What `fields` have where `cover` exceeds `above`; missing values are zero. Fields and cover lie on `part`, whose nodes are
/// some of `whole`. Throws InternalError when they are not.
SparseRasters sparse_of(const std::vector<const double*>& fields, const double* cover, const GridGeometry& part,
                        const GridGeometry& whole, double above);

}  // namespace frana
