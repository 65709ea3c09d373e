#pragma once
#include "base/types.h"

namespace frana {

/// One value for all nodes (no bits in the mask), or one for each (all bits): read in the same way, without a branch.
template <class T>
struct NodeValues {
    const T* values = nullptr;
    Index mask = 0;
    const T& operator[](Index k) const { return values[k & mask]; }
};

}  // namespace frana
