#pragma once
// The keys of detrainment, besides its pressure, which may vary spatially.
#include <vector>

#include "law/detrainment.h"
#include "law/key.h"

namespace frana::laws {

inline std::vector<Key<Detrainment>> detrainment_keys() {
    return {
        {&Detrainment::max_speed, "max_speed", "m/s", ranges::positive,
         "along the bed, above which nothing is lost; above 0.1 m/s, since slower flow loses nothing", Missing::none},
        {&Detrainment::max_depth, "max_depth", "m", ranges::positive, "of the flow, above which nothing is lost",
         Missing::none}};
}

}  // namespace frana::laws
