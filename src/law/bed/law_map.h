#pragma once
// Spatially varying friction: bed laws on the nodes of a grid.
#include <vector>

#include "law/bed/laws.h"
#include "law/law_map.h"

namespace frana::bed {

using LawTable = laws::LawTable<BedLaw>;
using LawMap = laws::LawMap<BedLaw>;
using laws::parameter_on_nodes;
using laws::plain_name;

template <class Law>
LawMap law_map(const std::vector<Law>& of_nodes) {
    return laws::law_map<BedLaw>(of_nodes);
}

}  // namespace frana::bed
