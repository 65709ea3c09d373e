#pragma once
#include "base/types.h"

namespace frana {

/// One value for all nodes (no bits in the mask), or one for each (all bits). Both are read in the same way, without a
/// branch. By default T{} for all.
template <class T>
struct NodeValues {
    inline static const T none{};
    const T* values = &none;
    Index mask = 0;
    const T& operator[](Index k) const { return values[k & mask]; }
};

}  // namespace frana
