#include "run/folder/left_terrain.h"

#include <fmt/core.h>

#include "observe/left_terrain.h"

namespace frana {
namespace {

double infiltrated(const RunRecord& r) { return r.extras.water ? r.extras.water->infiltrated_mass : 0.0; }

}  // namespace

std::string left_text(const RunRecord& r) {
    // A sum of gains and losses of all that there was: what is below their round-off, or below zero, is none.
    constexpr double kRoundOff = 1e-12;
    const RunSummary& s = r.summary;
    const double least = kRoundOff * (s.first.mass + mass_came_in(s.first, s.last)) / r.density;
    const auto volume = [&](double left) { return fmt::format("{:.6g} m3", left > least ? left : 0.0); };
    if (r.of_water_alone()) return volume(r.extras.water->left) + " of water";
    if (!r.extras.water) return volume(r.summary.last.mass_left / r.density);
    return volume(r.extras.water->solids_left) + " of grains and " + volume(r.extras.water->left) + " of water";
}

double left_share(const RunRecord& r) {
    const RunSummary& s = r.summary;
    return left_share(s.last.mass_left, infiltrated(r), mass_flowed(s.first, s.last, r.taken_of_bed));
}

double left_share_in(const nlohmann::ordered_json& record) {
    using namespace nlohmann::literals;
    const auto number = [&](const nlohmann::ordered_json::json_pointer& at) {
        return record.contains(at) && record.at(at).is_number() ? record.at(at).get<double>() : 0.0;
    };
    if (record.contains("/budgets/mass/left_share"_json_pointer))
        return number("/budgets/mass/left_share"_json_pointer);
    return left_share(number("/budgets/mass/left_domain"_json_pointer),
                      number("/budgets/mass/infiltrated"_json_pointer),
                      number("/budgets/mass/initial"_json_pointer) + number("/budgets/mass/came_in"_json_pointer) +
                          number("/budgets/bed/taken_of_bed"_json_pointer));
}

double noticeably_left_in(const nlohmann::ordered_json& record) {
    using namespace nlohmann::literals;
    const bool water_alone = record.contains("/budgets/water"_json_pointer) && !record.contains("structure");
    const double share = water_alone ? 0.0 : left_share_in(record);
    return share > kNoticeablyLeft ? share : 0.0;
}

std::string remark_on_left(const RunRecord& r) {
    const double share = left_share(r);
    if (r.of_water_alone() || !(share > kNoticeablyLeft)) return "";
    return fmt::format(
        "terrain: {}, {:.3g} % of all that flowed, left it; expected all to stay; runout, reach, footprint and deposit "
        "end at its edge, so that they are lower bounds; {}",
        left_text(r), 100.0 * share, kWayOut);
}

void remark_on_left(double share, Comparison& comparison) {
    if (!(share > kNoticeablyLeft)) return;
    comparison.remarks.insert(
        comparison.remarks.begin(),
        fmt::format("{:.3g} % of all that flowed left the terrain, so simulated runout, reach, area and deposit are "
                    "lower bounds, and so are their differences from the survey; {}",
                    100.0 * share, kWayOut));
}

}  // namespace frana
