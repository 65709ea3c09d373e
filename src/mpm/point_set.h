#pragma once
// What the points of every model have in common: one array per quantity, which grow, are counted and sorted together.
#include <cstdint>
#include <vector>

#include "base/staggered.h"
#include "base/types.h"

namespace frana {

/// Memory that an array holds [bytes].
template <class Values>
Index allocated(const Values& array) {
    return static_cast<Index>(array.capacity() * sizeof(typename Values::value_type));
}

/// A model's arrays of points, and their numbers. Arrays::visit_arrays(self, visit) is its one list of floating-point
/// arrays in use. Everything that concerns all of them goes by it.
template <class Arrays>
struct PointSet : Arrays {
    std::vector<std::int64_t> id;  ///< constant through sorting; children of a split get new ones

    Index count() const { return static_cast<Index>(this->mass.size()); }

    /// Calls visit(array) for the floating-point arrays in use.
    template <class Visit>
    void each(Visit&& visit) {
        Arrays::visit_arrays(*this, visit);
    }
    template <class Visit>
    void each(Visit&& visit) const {
        Arrays::visit_arrays(*this, visit);
    }
    Index bytes() const {
        Index sum = allocated(id);
        each([&](const auto& array) { sum += allocated(array); });
        return sum;
    }
    void resize(Index count) {
        each([&](auto& array) { resize_sparingly(array, static_cast<std::size_t>(count)); });
        resize_sparingly(id, static_cast<std::size_t>(count));
    }
};

}  // namespace frana
