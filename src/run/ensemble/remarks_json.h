#pragma once
// Remarks that several runs share, as records of ensembles and calibrations have them.
#include <nlohmann/json.hpp>
#include <vector>

#include "run/end_remarks.h"

namespace frana {

inline nlohmann::ordered_json shared_remarks_json(const std::vector<SharedRemark>& remarks) {
    auto all = nlohmann::ordered_json::array();
    for (const SharedRemark& one : remarks)
        all.push_back({{"runs", one.runs}, {"sample", one.worst}, {"remark", one.text}});
    return all;
}

}  // namespace frana
