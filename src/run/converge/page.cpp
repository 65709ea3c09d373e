// What a study of several cells leaves: converge.json, converge.md and converge.png.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/version.h"
#include "compare/flow_width.h"
#include "run/converge/study.h"
#include "vtk_io/figures/chart_figure.h"

namespace frana {
namespace {

using Json = nlohmann::ordered_json;

/// What differences between runs are measured against before an order is read from them.
enum class Order { none, cells, share };

/// A row of the table, and a list of converge.json.
struct Quantity {
    const char* key;
    const char* name;
    const char* form;
    double CellFigures::*value;
    double scale;  ///< of the table over SI
    Order order;
};

const std::vector<Quantity>& quantities() {
    using F = CellFigures;
    static const std::vector<Quantity> all = {
        {"runout", "runout along the path [m]", "{:.1f}", &F::runout, 1.0, Order::cells},
        {"reach", "straight reach [m]", "{:.1f}", &F::reach, 1.0, Order::cells},
        {"footprint_area", "footprint [m2]", "{:.5g}", &F::footprint_area, 1.0, Order::share},
        {"deposit_area", "deposit, area [m2]", "{:.5g}", &F::deposit_area, 1.0, Order::share},
        {"deposit_volume", "deposit, volume [m3]", "{:.5g}", &F::deposit_volume, 1.0, Order::none},
        {"eroded_volume", "taken of the bed [m3]", "{:.5g}", &F::eroded_volume, 1.0, Order::share},
        {"deposited_volume", "of the deposit, become bed [m3]", "{:.5g}", &F::deposited_volume, 1.0, Order::none},
        {"peak_depth", "peak depth, 99.9 % [m]", "{:.3g}", &F::peak_depth, 1.0, Order::share},
        {"largest_depth", "peak depth, largest [m]", "{:.3g}", &F::largest_depth, 1.0, Order::none},
        {"peak_speed", "peak speed, 99.9 % [m/s]", "{:.3g}", &F::peak_speed, 1.0, Order::share},
        {"largest_speed", "peak speed, largest [m/s]", "{:.3g}", &F::largest_speed, 1.0, Order::none},
        {"iou_with_finest", "IoU of the footprint with the finest", "{:.3f}", &F::iou, 1.0, Order::none},
        {"deposit_elsewhere", "deposit elsewhere than the finest [%]", "{:.1f}", &F::elsewhere, 100.0, Order::none},
        {"cells_across", "cells across the flow", "{:.1f}", &F::cells_across, 1.0, Order::none},
        {"wall_seconds", "run time [s]", "{:.3g}", &F::seconds, 1.0, Order::none}};
    return all;
}

/// Some are of an erodible bed or of deposits alone.
bool is_known(const Quantity& quantity, const std::vector<CellFigures>& runs) {
    return std::any_of(runs.begin(), runs.end(),
                       [&](const CellFigures& run) { return std::isfinite(run.*quantity.value); });
}
bool is_of_bed(const Quantity& quantity) {
    return quantity.value == &CellFigures::eroded_volume || quantity.value == &CellFigures::deposited_volume;
}

/// On the three finest cells.
std::optional<double> order_of(const Quantity& quantity, const std::vector<CellFigures>& runs) {
    if (quantity.order == Order::none || runs.size() < 3) return std::nullopt;
    std::array<double, 3> cells{}, values{};
    for (std::size_t k = 0; k < 3; ++k) {
        const CellFigures& run = runs[runs.size() - 3 + k];
        cells[k] = run.cell;
        values[k] = run.*quantity.value;
    }
    constexpr double round_off = 1e-3;  // of the value: what a raster of some thousand nodes tells
    return observed_order(cells, values, quantity.order == Order::cells ? cells[1] : round_off * std::abs(values[2]));
}

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

/// What was varied on the finest cell: a list for each of the quantities that tell answers apart.
Json variations_of(const ConvergenceStudy& study) {
    Json all = Json::array();
    for (const Variation& varied : study.variations) {
        Json one = {{"key", varied.key}, {"values", varied.values}, {"folders", Json::array()}};
        for (const auto& folder : varied.folders)
            one["folders"].push_back(folder.lexically_relative(study.folder).generic_string());
        for (const Quantity& quantity : quantities()) {
            one[quantity.key] = Json::array();
            for (const CellFigures& run : varied.figures) one[quantity.key].push_back(number(run.*quantity.value));
        }
        one["spread_cells"] = number(runout_spread(varied.figures));
        one["sentence"] = varied.sentence;
        all.push_back(one);
    }
    return all;
}

std::string json_of(const ConvergenceStudy& study) {
    Json json = {{"version", FRANA_VERSION},
                 {"title", study.title},
                 {"case_file", study.case_file},
                 {"overrides", study.overrides}};
    for (const char* list : {"cells", "folders"}) json[list] = Json::array();
    for (const StudiedRun& run : study.runs) {
        json["cells"].push_back(run.cell);
        json["folders"].push_back(run.folder.lexically_relative(study.folder).generic_string());
    }
    Json orders = Json::object();
    for (const Quantity& quantity : quantities()) {
        json[quantity.key] = Json::array();
        for (const CellFigures& run : study.figures) json[quantity.key].push_back(number(run.*quantity.value));
        if (quantity.order == Order::none) continue;
        const auto order = order_of(quantity, study.figures);
        orders[quantity.key] = order ? Json(*order) : Json(nullptr);
    }
    json["exit_reason"] = study.ends;
    json["left_share"] = study.left;
    json["observed_order"] = orders;
    json["footprint_depth"] = study.footprint_depth;
    json["rule"] = {{"runout_cells", study.rule.runout_cells},
                    {"iou", study.rule.iou},
                    {"deposit_elsewhere", study.rule.elsewhere},
                    {"peaks", study.rule.peaks},
                    {"eroded_volume", study.rule.eroded}};
    json["converged"] = study.verdict.converged;
    json["enough"] = study.verdict.enough ? Json(*study.verdict.enough) : Json(nullptr);
    json["verdict"] = study.verdict.sentence;
    json["variations"] = variations_of(study);
    json["remarks"] = study.remarks;
    json["files"] = study.files;
    return json.dump(2) + "\n";
}

std::string table_of(const ConvergenceStudy& study) {
    const bool orders = study.figures.size() >= 3;
    std::string head = "| Cell |", rule = "|---|";
    for (const StudiedRun& run : study.runs) head += fmt::format(" {:g} m |", run.cell), rule += "---|";
    if (orders) head += " order |", rule += "---|";
    std::string text = head + "\n" + rule + "\n";
    for (const Quantity& quantity : quantities()) {
        if (is_of_bed(quantity) && !is_known(quantity, study.figures)) continue;
        if (quantity.value == &CellFigures::runout && !study.along_path) continue;  // the next row has it
        text += fmt::format("| {} |", quantity.name);
        for (const CellFigures& run : study.figures) {
            const double value = run.*quantity.value * quantity.scale;
            text += fmt::format(" {} |", std::isfinite(value) ? fmt::format(fmt::runtime(quantity.form), value) : "-");
        }
        const auto order = order_of(quantity, study.figures);
        if (orders) text += order ? fmt::format(" {:.2g} |", *order) : quantity.order == Order::none ? "  |" : " - |";
        text += "\n";
    }
    text += "| ended by |";
    for (const std::string& end : study.ends) text += fmt::format(" {} |", end);
    return text + (orders ? "  |\n\n" : "\n\n");
}

/// A panel with a curve for each of the quantities, over the cell.
ChartPanel panel_of(const ConvergenceStudy& study, const char* label,
                    const std::vector<std::pair<const char*, double CellFigures::*>>& curves) {
    ChartPanel panel;
    panel.y_label = label;
    for (const auto& [name, value] : curves) {
        Curve curve{name, {}, {}, Curve::Kind::line, true};
        for (const CellFigures& run : study.figures) {
            curve.x.push_back(run.cell);
            curve.y.push_back(run.*value);
        }
        panel.curves.push_back(curve);
    }
    return panel;
}

/// Which values the rule requires.
Curve bound(const std::string& name, double from, double to, double value) {
    return {name, {from, to}, {value, value}, Curve::Kind::line, false};
}

double largest_in(const ChartPanel& panel) {
    double largest = 0.0;
    for (const Curve& curve : panel.curves)
        for (const double y : curve.y)
            if (std::isfinite(y)) largest = std::max(largest, y);
    return largest > 0.0 ? largest : 1.0;
}

/// Runouts less the finest one, which the legend names. At least a coarsest cell above and below is shown. Otherwise
/// what a raster cannot tell would seem to be a change.
ChartPanel runout_panel(const ConvergenceStudy& study) {
    using F = CellFigures;
    std::vector<std::pair<const char*, double F::*>> runouts = {{"along the path", &F::runout},
                                                                {"straight", &F::reach}};
    if (!study.along_path) runouts.erase(runouts.begin());
    ChartPanel panel = panel_of(study, "runout, change [m]", runouts);
    double most = 1.2 * study.figures.front().cell;
    for (Curve& curve : panel.curves) {
        const double finest = curve.y.back();
        curve.name += fmt::format(", from {:.5g} m", finest);
        for (double& y : curve.y) {
            y -= finest;
            if (std::isfinite(y)) most = std::max(most, 1.1 * std::abs(y));
        }
    }
    panel.y_range = std::make_pair(-most, most);
    return panel;
}

ChartFigure chart_of(const ConvergenceStudy& study) {
    using F = CellFigures;
    ChartFigure figure;
    figure.title = fmt::format("{}: on several cells", study.title);
    figure.x_label = "cell [m]";
    const double coarsest = study.figures.front().cell;
    figure.x_range = std::make_pair(0.0, 1.05 * coarsest);
    figure.panels = {
        runout_panel(study),
        panel_of(study, "area [m2]", {{"footprint", &F::footprint_area}, {"deposit", &F::deposit_area}}),
        panel_of(study, "peak depth [m]", {{"99.9 %", &F::peak_depth}, {"largest", &F::largest_depth}}),
        panel_of(study, "peak speed [m/s]", {{"99.9 %", &F::peak_speed}, {"largest", &F::largest_speed}}),
        panel_of(study, "share [1]", {{"IoU with the finest", &F::iou}, {"deposit elsewhere", &F::elsewhere}}),
        panel_of(study, "cells across [1]", {{"median width of the flow", &F::cells_across}})};
    std::vector<std::pair<const char*, double F::*>> of_bed;
    for (const Quantity& quantity : quantities())
        if (is_of_bed(quantity) && is_known(quantity, study.figures))
            of_bed.emplace_back(quantity.value == &F::eroded_volume ? "taken" : "left behind", quantity.value);
    if (!of_bed.empty()) figure.panels.push_back(panel_of(study, "bed, volume [m3]", of_bed));
    for (ChartPanel& panel : figure.panels)
        if (!panel.y_range) panel.y_range = std::make_pair(0.0, 1.08 * largest_in(panel));
    figure.panels[5].y_range->second = std::max(figure.panels[5].y_range->second, 1.5 * least_cells_across);
    figure.panels[5].curves.push_back(bound("resolved from here on", 0.0, 1.05 * coarsest, least_cells_across));
    figure.width = 1400;
    figure.height = 260 + 300 * static_cast<int>(figure.panels.size());
    figure.footer = fmt::format("frana {}: {}", FRANA_VERSION, study.verdict.sentence);
    return figure;
}

std::string page_of(const ConvergenceStudy& study, bool drawn) {
    std::string text = fmt::format("# {}: on several cells\n\n", study.title) + study_section(study);
    if (drawn) text += "![What changes with the cell](converge.png)\n\n*What changes with the cell*\n\n";
    text +=
        study.rule.text() +
        fmt::format(
            " The finest cell is held against nothing: where its own error is large, agreement says little.\n\n"
            "The footprint is everything ever deeper than {0:g} m, the deposit's area what is deeper at the end; its "
            "volume is all that is left. What is taken of the bed is what is missing of it at the end. Footprints and "
            "deposits are overlaid as their pixels lie. The runout is the {1}. Cells across: the flow's "
            "median width, over its length. The order is that of the three finest cells; it is left out where values "
            "go to "
            "and fro, do not approach, or differ by less than the raster tells.\n\n",
            study.footprint_depth,
            study.along_path ? "horizontal length along the steepest path on the finest grid, the same for all"
                             : "straight reach");
    text += "| Run | |\n|---|---|\n";
    for (const StudiedRun& run : study.runs) {
        const std::string folder = run.folder.lexically_relative(study.folder).generic_string();
        text += fmt::format("| cells of {:g} m | [{}/report.md]({}/report.md) |\n", run.cell, folder, folder);
    }
    for (const Variation& varied : study.variations)
        for (std::size_t k = 0; k < varied.values.size(); ++k) {
            const std::string folder = varied.folders[k].lexically_relative(study.folder).generic_string();
            text += fmt::format("| {} = {:g} | [{}/report.md]({}/report.md) |\n", varied.key, varied.values[k], folder,
                                folder);
        }
    const std::string by = study.overrides.empty() ? "" : fmt::format(", overridden by `{}`", study.overrides);
    return text + fmt::format("\nCase `{}`{}, frana {}.\n", study.case_file, by, FRANA_VERSION);
}

}  // namespace

const std::vector<std::string>& study_files() {
    static const std::vector<std::string> names = {"converge.json", "converge.md", "converge.png"};
    return names;
}

std::string study_section(const ConvergenceStudy& study) {
    std::string text = study.verdict.sentence + "\n\n";
    for (const Variation& varied : study.variations) text += varied.sentence + "\n\n";
    text += table_of(study);
    for (const std::string& remark : study.remarks) text += fmt::format("- {}\n", remark);
    return text + (study.remarks.empty() ? "" : "\n");
}

void write_study(ConvergenceStudy& study) {
    std::string why_not;
    const bool drawn = render_chart(chart_of(study), study.folder / "converge.png", why_not);
    if (!drawn) study.remarks.push_back("there is no picture: " + why_not);
    for (const std::string& name : study_files())
        if (drawn || name != "converge.png") study.files.push_back(name);
    write_text(study.folder / "converge.md", page_of(study, drawn));
    write_text(study.folder / "converge.json", json_of(study));
}

}  // namespace frana
