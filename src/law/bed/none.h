#pragma once
#include <vector>

#include "law/bed/key.h"
#include "law/friction_step.h"

namespace frana::bed {

/// A bed without friction.
struct None {
    static constexpr const char* name = "none";
    static constexpr const char* is = "";
    static std::vector<Key<None>> keys() { return {}; }
    double friction_at_rest() const { return 0.0; }

    template <class Real>
    [[gnu::always_inline]] Real speed_after(const BedStateOf<Real>&, Real, Real driven, double) const {
        return driven;
    }
};

}  // namespace frana::bed
