#include "run/folder/comparison.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "io/gdal_reader.h"
#include "observe/table.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

void add_scores(Json& json, const ExtentScores& scores, const Comparison& c) {
    const Overlap& areas = scores.areas;
    json["true_positive_area"] = areas.hit;
    json["false_positive_area"] = areas.beyond;
    json["false_negative_area"] = areas.missed;
    json["iou"] = number(areas.iou());
    json["precision"] = number(areas.precision());
    json["recall"] = number(areas.recall());
    json["f1"] = number(areas.f1());
    json["area_ratio"] = number(areas.area_ratio());
    json["area_difference_percent"] = number(areas.area_difference_percent());
    json["symmetric_difference_percent"] = number(areas.symmetric_difference_percent());
    json["simulated_area"] = areas.simulated();
    json["survey_area"] = areas.surveyed();
    json["survey_area_outside"] = areas.missed_outside;
    json["runout_difference"] = number(scores.runout - c.surveyed_runout);
    json["runout_simulated"] = number(scores.runout);
    json["runout_survey"] = number(c.surveyed_runout);
    json["reach_difference"] = number(scores.reach - c.surveyed_reach);
    json["reach_simulated"] = number(scores.reach);
    json["reach_survey"] = number(c.surveyed_reach);
    json["boundary_distance_mean"] = number(scores.boundary.mean);
    json["boundary_distance_p95"] = number(scores.boundary.p95);
    json["boundary_distance_max"] = number(scores.boundary.max);
}

void add_deposit(Json& json, const DepositErrors& deposit) {
    json["volume_error"] = number(deposit.volume_error());
    json["depth_mae"] = number(deposit.mae);
    json["depth_rmse"] = number(deposit.rmse);
    json["deposit_volume_simulated"] = deposit.simulated_volume;
    json["deposit_volume_survey"] = deposit.surveyed_volume;
    json["deposit_volume_unsurveyed"] = deposit.unsurveyed_volume;
    json["deposit_compared_area"] = deposit.compared_area;
}

Json volumes(const BedVolumes& v) { return {{"eroded", v.eroded}, {"deposited", v.deposited}}; }

Json bed_change_json(const Comparison& c) {
    const BedChangeErrors& b = *c.bed_change;
    return {{"survey", c.bed_change_source},
            {"noise", b.noise},
            {"simulated", volumes(b.simulated)},
            {"surveyed", volumes(b.surveyed)},
            {"eroded_error", number(b.eroded_error())},
            {"deposited_error", number(b.deposited_error())},
            {"misplaced_volume", b.misplaced},
            {"misplaced_share", number(b.misplaced_share())},
            {"mae", number(b.mae)},
            {"rmse", number(b.rmse)},
            {"compared_area", b.compared_area},
            {"simulated_within_noise", volumes(b.within_noise)},
            {"simulated_unsurveyed", volumes(b.unsurveyed)},
            {"surveyed_in_release", volumes(b.release)}};
}

const Raster* raster_named(const std::vector<ProductRaster>& rasters, const char* name) {
    const ProductRaster* product = find_product(rasters, name);
    return product ? &product->raster : nullptr;
}

std::string value(double number, const char* form) {
    return std::isfinite(number) ? fmt::format(fmt::runtime(form), number) : "-";
}

/// A length with `decimals`, more where a tenth of a cell has more.
std::string metres(double cell, int decimals) {
    constexpr int most = 9;
    const int of_cell = static_cast<int>(std::ceil(-std::log10(cell) - 1e-9)) + decimals;
    return fmt::format("{{:.{}f}}", std::clamp(of_cell, decimals, most));
}

/// A row of a table. It has a column for the trace and, when it is known, one for the final state.
template <class Score>
std::string row(const Comparison& c, const char* name, const char* form, const Score& score) {
    std::string text = fmt::format("| {} | {} |", name, value(score(c.trace), form));
    if (c.final) text += fmt::format(" {} |", value(score(*c.final), form));
    return text + "\n";
}

std::string extent_table(const Comparison& c) {
    std::string text = c.final ? "| Score | everything ever covered | covered at the end |\n|---|---|---|\n"
                               : "| Score | everything ever covered |\n|---|---|\n";
    const auto add = [&](const char* name, const char* form, const auto& score) { text += row(c, name, form, score); };
    const std::string length = metres(c.cell, 1), difference = "{:+" + length.substr(2);
    const auto add_length = [&](const char* name, const auto& score) { add(name, length.c_str(), score); };
    const auto add_difference = [&](const char* name, const auto& score) { add(name, difference.c_str(), score); };
    using E = const ExtentScores&;
    add("simulated area [m2]", "{:.6g}", [](E s) { return s.areas.simulated(); });
    add("surveyed area [m2]", "{:.6g}", [](E s) { return s.areas.surveyed(); });
    add("both: true positive [m2]", "{:.6g}", [](E s) { return s.areas.hit; });
    add("simulated only: false positive [m2]", "{:.6g}", [](E s) { return s.areas.beyond; });
    add("surveyed only: false negative [m2]", "{:.6g}", [](E s) { return s.areas.missed; });
    add("IoU (critical success index)", "{:.3f}", [](E s) { return s.areas.iou(); });
    add("precision", "{:.3f}", [](E s) { return s.areas.precision(); });
    add("recall", "{:.3f}", [](E s) { return s.areas.recall(); });
    add("F1", "{:.3f}", [](E s) { return s.areas.f1(); });
    add("simulated over surveyed area", "{:.3f}", [](E s) { return s.areas.area_ratio(); });
    add("area difference [%]", "{:.1f}", [](E s) { return s.areas.area_difference_percent(); });
    add("symmetric difference [%]", "{:.1f}", [](E s) { return s.areas.symmetric_difference_percent(); });
    add_length("runout, simulated [m]", [](E s) { return s.runout; });
    add_length("runout, surveyed [m]", [&](E) { return c.surveyed_runout; });
    add_difference("runout difference [m]", [&](E s) { return s.runout - c.surveyed_runout; });
    add_difference("straight reach, difference [m]", [&](E s) { return s.reach - c.surveyed_reach; });
    add_length("distance of the outlines, mean [m]", [](E s) { return s.boundary.mean; });
    add_length("distance of the outlines, 95 % [m]", [](E s) { return s.boundary.p95; });
    return text + "\n";
}

std::string deposit_table(const Comparison& c) {
    if (!c.deposit) return "";
    const DepositErrors& d = *c.deposit;
    std::string text = fmt::format("| Deposit against `{}` | Value |\n|---|---|\n", c.deposit_source);
    text += fmt::format("| simulated volume [m3] | {:.6g} |\n", d.simulated_volume);
    text += fmt::format("| surveyed volume [m3] | {:.6g} |\n", d.surveyed_volume);
    text += fmt::format("| volume error [%] | {} |\n", value(100.0 * d.volume_error(), "{:+.1f}"));
    text += fmt::format("| mean absolute thickness error [m] | {} |\n", value(d.mae, "{:.3g}"));
    text += fmt::format("| root mean square thickness error [m] | {} |\n", value(d.rmse, "{:.3g}"));
    return text + "\n";
}

std::string bed_change_table(const Comparison& c) {
    if (!c.bed_change) return "";
    const BedChangeErrors& b = *c.bed_change;
    std::string text =
        fmt::format("| Change of the ground against `{}` | eroded | deposited |\n|---|---|---|\n", c.bed_change_source);
    const auto add = [&](const char* name, const std::string& eroded, const std::string& deposited) {
        text += fmt::format("| {} | {} | {} |\n", name, eroded, deposited);
    };
    const auto add_volumes = [&](const char* name, const BedVolumes& v) {
        add(name, fmt::format("{:.6g}", v.eroded), fmt::format("{:.6g}", v.deposited));
    };
    add_volumes("simulated volume [m3]", b.simulated);
    add_volumes("surveyed volume [m3]", b.surveyed);
    add("volume error [%]", value(100.0 * b.eroded_error(), "{:+.1f}"), value(100.0 * b.deposited_error(), "{:+.1f}"));
    add_volumes("simulated within the noise [m3]", b.within_noise);
    add_volumes("surveyed in the release [m3]", b.release);
    return text +
           fmt::format(
               "\nSimulated is the change of the bed with what lies on it at the end, as a second survey would see it. "
               "Changes of at most {:.3g} m count as none, and what was released is left out. Misplaced: {:.6g} "
               "m3, {} % of "
               "the surveyed volume. Where one of the two changes ({:.6g} m2): mean absolute error {} m, root mean "
               "square error {} m.\n\n",
               b.noise, b.misplaced, value(100.0 * b.misplaced_share(), "{:.1f}"), b.compared_area,
               value(b.mae, "{:.3g}"), value(b.rmse, "{:.3g}"));
}

}  // namespace

std::optional<Raster> solids_at_end(const std::vector<ProductRaster>& rasters) {
    const Raster *all = raster_named(rasters, "final_depth"), *water = raster_named(rasters, "final_water_depth");
    if (all == nullptr) return {};
    Raster solids = *all;
    if (water == nullptr) return solids;
    for (std::size_t k = 0; k < solids.values.size(); ++k)
        if (water->values[k] > 0.0) solids.values[k] = std::max(0.0, solids.values[k] - water->values[k]);
    return solids;
}

Comparison compare_rasters(const std::vector<ProductRaster>& rasters, const Raster* bed, double limit,
                           const Survey& survey, const std::vector<Vec2>& starts, const Raster* later) {
    const std::optional<Raster> solids = solids_at_end(rasters);
    SimulatedRun run;
    run.starts = starts;
    run.released_later = later;
    run.peak_depth = raster_named(rasters, "peak_depth");
    run.final_depth = solids ? &*solids : nullptr;
    run.deposited_depth = raster_named(rasters, "deposited_depth");
    run.arrival_time = raster_named(rasters, "arrival_time");
    run.bed = bed;
    run.limit = limit;
    run.bed_change = raster_named(rasters, "bed_change");
    Comparison found = compare(run, survey);
    if (raster_named(rasters, "final_water_depth") != nullptr)
        found.remarks.push_back(
            "free water counts among everything ever covered and in its arrival, a lake of water.level too; what lies "
            "at "
            "the end is compared without it");
    return found;
}

Survey read_survey_files(const SurveyFiles& files, const Raster& like, std::vector<std::string>& log) {
    const GdalReader reader;
    Survey survey;
    if (!files.footprint.empty())
        survey.footprint = reader.read_survey(files.footprint, like.geometry.pixel_extent(), like.crs_wkt, log);
    if (!files.path.empty()) {
        survey.path = read_survey_path(reader, files.path, like.geometry.pixel_extent(), like.crs_wkt, log);
        survey.path_source = files.path.string();
    }
    if (!files.deposit.empty()) {
        survey.deposit = read_survey_deposit(reader, files.deposit, like.geometry, like.crs_wkt, log);
        survey.deposit_source = files.deposit.string();
    }
    if (!files.bed_change.empty()) {
        survey.bed_change = read_bed_change(reader, files.bed_change, like.geometry, like.crs_wkt, log);
        survey.bed_change_source = files.bed_change.string();
        survey.bed_change_noise = files.bed_change_noise;
    }
    return survey;
}

std::string comparison_json(const Comparison& c) {
    Json json;
    if (c.extents) json["survey"] = c.survey;
    json["threshold"] = c.limit;
    json["cell"] = c.cell;
    if (c.extents) add_scores(json, c.trace, c);
    json["runout_path"] = c.path_source;
    if (c.path_is_given) json["path"] = c.path_source;
    for (const OtherRunout& other : c.others)
        json["runout_other_releases"].push_back({{"x", other.path.front().x()},
                                                 {"y", other.path.front().y()},
                                                 {"runout_simulated", number(other.simulated)},
                                                 {"runout_survey", number(other.surveyed)}});
    if (c.deposit) {
        json["deposit"] = c.deposit_source;
        add_deposit(json, *c.deposit);
    }
    if (c.bed_change) json["bed_change"] = bed_change_json(c);
    if (c.final) add_scores(json["final_extent"], *c.final, c);
    json["remarks"] = c.remarks;
    return json.dump(2) + "\n";
}

void write_scores(const fs::path& run_dir, const fs::path& json, const Comparison& c, const std::string& name) {
    write_text(json, comparison_json(c));
    const fs::path file = run_dir / (name + "_bed_change.csv");
    std::error_code none;
    if (c.bed_change_steps.empty()) {  // what an earlier comparison left is not of this one
        fs::remove(file, none);
        fs::remove(run_dir / "figures" / (name + "_bed_change.png"), none);
        return;
    }
    TableWriter table(
        file, {"distance [m]", "x [m]", "y [m]", "simulated_eroded [m3]", "simulated_deposited [m3]",
               "surveyed_eroded [m3]", "surveyed_deposited [m3]", "simulated_balance [m3]", "surveyed_balance [m3]"});
    double ours = 0.0, theirs = 0.0;
    for (const BedChangeStep& step : c.bed_change_steps) {
        ours += step.simulated.deposited - step.simulated.eroded;
        theirs += step.surveyed.deposited - step.surveyed.eroded;
        table.add({step.distance, step.point.x(), step.point.y(), step.simulated.eroded, step.simulated.deposited,
                   step.surveyed.eroded, step.surveyed.deposited, ours, theirs});
    }
    table.flush();
}

std::string comparison_section(const Comparison& c) {
    std::string text = "## Against the survey\n\n";
    if (c.extents)
        text += fmt::format(
            "Survey: `{}`. Simulated is every pixel of {:.6g} m deeper than {:.6g} m; the survey's area in each pixel "
            "is exact. The survey is the reference (true positive + false negative). Runout is the horizontal length "
            "along {} to the farthest point of each outline; reach is the straight distance from the path's start.\n\n",
            c.survey, c.cell, c.limit,
            c.path.empty() ? std::string("no known path")
                           : (c.path_is_given ? "`" + c.path_source + "`" : "the " + c.path_source));
    if (c.extents) text += extent_table(c);
    text += deposit_table(c) + bed_change_table(c);
    for (const std::string& remark : c.remarks) text += fmt::format("- {}\n", remark);
    return text + (c.remarks.empty() ? "" : "\n");
}

std::string comparison_line(const Comparison& c) {
    const Overlap& areas = c.trace.areas;
    return fmt::format("IoU {}, simulated over surveyed area {}, runout {} m", value(areas.iou(), "{:.3f}"),
                       value(areas.area_ratio(), "{:.3g}"),
                       value(c.trace.runout - c.surveyed_runout, ("{:+" + metres(c.cell, 0).substr(2)).c_str()));
}

}  // namespace frana
