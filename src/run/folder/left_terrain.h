#pragma once
// What is to be said of a run whose flow left the terrain: what it shows of the flow is then a part.
#include <nlohmann/json.hpp>
#include <string>

#include "run/folder/run_record.h"

namespace frana {

/// What to do where the flow left the terrain.
inline constexpr const char* kWayOut = "give a wider elevation model or terrain.window";

/// "6124 m3", of two phases the volume of each.
std::string left_text(const RunRecord& record);

/// Of all that flowed [1].
double left_share(const RunRecord& record);
/// The same by a run.json, of an earlier version too.
double left_share_in(const nlohmann::ordered_json& record);

/// The share where it is worth a remark, otherwise 0. Of water alone it is none: that leaves as rivers do.
double noticeably_left_in(const nlohmann::ordered_json& record);

/// A remark for the report. Empty where the flow stayed.
std::string remark_on_left(const RunRecord& record);

/// Tells in the scores that they are those of a part; `share`: of all that flowed. Nothing up to kNoticeablyLeft.
void remark_on_left(double share, Comparison& comparison);

}  // namespace frana
