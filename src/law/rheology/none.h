#pragma once
#include <vector>

#include "law/key.h"

namespace frana::rheology {

/// Pressure alone: no stress inside the mass.
struct None {
    static constexpr const char* name = "none";
    static constexpr const char* is = "";
    static std::vector<laws::Key<None>> keys() { return {}; }
};

}  // namespace frana::rheology
