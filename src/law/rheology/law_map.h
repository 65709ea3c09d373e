#pragma once
// Spatially varying rheologies: on the nodes of a grid.
#include <vector>

#include "law/law_map.h"
#include "law/rheology/laws.h"

namespace frana::rheology {

using LawMap = laws::LawMap<Rheology>;

template <class Law>
LawMap law_map(const std::vector<Law>& of_nodes) {
    return laws::law_map<Rheology>(of_nodes);
}

}  // namespace frana::rheology
