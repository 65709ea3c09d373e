// `frana compare RUN_DIR --survey FOOTPRINT`: a finished run held against a survey, from the run's own files.
#include <fmt/core.h>

#include <algorithm>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/atomic_file.h"
#include "base/error.h"
#include "frana_commands.h"
#include "frana_compare.h"
#include "frana_figures.h"
#include "frana_wider_run.h"
#include "run/folder/comparison.h"
#include "run/folder/left_terrain.h"
#include "run/folder/record_file.h"
#include "run/folder/release_results.h"
#include "run/folder/run_charts.h"
#include "run/folder/run_folder.h"
#include "run/folder/states.h"
#include "scene/remarks.h"
#include "vtk_io/survey_vtp.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

/// The rasters that scores are made of, on one grid.
void require_rasters(const fs::path& run_dir, const std::vector<ProductRaster>& rasters) {
    const ProductRaster* peak = find_product(rasters, "peak_depth");
    if (peak == nullptr)
        throw UserError(
            fmt::format("{}: is not there; expected the rasters of a finished run; add \"geotiff\" to output.formats "
                        "and run again",
                        (run_dir / "rasters" / "peak_depth.tif").string()));
    for (const ProductRaster& product : rasters)
        if (!(product.raster.geometry == peak->raster.geometry))
            throw UserError(
                fmt::format("{}: has other pixels than peak_depth.tif; expected the rasters of one run; "
                            "run the case again",
                            (run_dir / "rasters" / (product.name + ".tif")).string()));
}

void require_erodible(const CompareOptions& options, const std::vector<ProductRaster>& rasters) {
    if (options.bed_change.empty() || find_product(rasters, "bed_change") != nullptr) return;
    throw UserError(fmt::format(
        "{}: is not there, since the run's bed did not change; expected a bed that does for --bed-change; give the "
        "case an [erodible], a [deposition] or a [forest] table and run it again",
        (options.run_dir / "rasters" / "bed_change.tif").string()));
}

/// Where releases entered after the start, for changes of the bed. An outline that has gone is a warning.
std::optional<Raster> released_later(const CompareOptions& options, const FigureSource& source,
                                     std::vector<std::string>& warnings) {
    if (options.bed_change.empty()) return {};
    try {
        const std::vector<LateEntry> late = late_of_run(options.run_dir);
        if (late.empty()) return {};
        return released_later_on(release_sources(case_of_run(options.run_dir)), late,
                                 find_product(source.rasters, "peak_depth")->raster);
    } catch (const UserError& error) {
        warnings.push_back(fmt::format("ground under later releases is compared as well: {}", error.what()));
        return {};
    }
}

/// Scores must not take the place of what they are made of.
void require_other_json(const CompareOptions& options) {
    std::vector<fs::path> inputs = {options.survey, options.deposit, options.path, options.bed_change};
    const std::vector<fs::path> of_run = product_files(options.run_dir);
    const auto is_scores = [&](const fs::path& file) {
        return file.parent_path() == options.run_dir && file.extension() == ".json" &&
               file.filename().string().rfind("compare", 0) == 0;
    };
    std::copy_if(of_run.begin(), of_run.end(), std::back_inserter(inputs),
                 [&](const fs::path& file) { return !is_scores(file); });
    require_no_input("--json", options.json, inputs);
}

SurveyFiles files_of(const CompareOptions& options) {
    return {options.survey, options.deposit, options.path, options.bed_change, options.bed_change_noise};
}

/// The survey that the run was compared with at its end. Nothing without one.
SurveyFiles files_of_case(const fs::path& run_dir) {
    try {
        return survey_files(case_of_run(run_dir));
    } catch (const UserError&) {
        return {};  // a folder without resolved.toml
    }
}

bool same_file(const fs::path& a, const fs::path& b) {
    std::error_code gone;
    return a == b || fs::weakly_canonical(a, gone) == fs::weakly_canonical(b, gone);
}

bool same_files(const SurveyFiles& a, const SurveyFiles& b) {
    return same_file(a.footprint, b.footprint) && same_file(a.deposit, b.deposit) && same_file(a.path, b.path) &&
           same_file(a.bed_change, b.bed_change) && (a.bed_change.empty() || a.bed_change_noise == b.bed_change_noise);
}

/// What an earlier comparison was made of, by its scores. Nothing where there are none.
std::optional<SurveyFiles> files_in(const fs::path& scores) {
    std::error_code none;
    if (!fs::exists(scores, none)) return {};
    const nlohmann::json json = json_in(scores);
    if (!json.is_object()) return {};
    SurveyFiles files;
    files.footprint = json.value("survey", std::string());
    files.deposit = json.value("deposit", std::string());
    files.path = json.value("path", std::string());
    if (!json.contains("bed_change")) return files;
    files.bed_change = json["bed_change"].value("survey", std::string());
    files.bed_change_noise = json["bed_change"].value("noise", files.bed_change_noise);
    return files;
}

/// How a comparison stands to that of the run's own report: in names of files, and in words.
struct Standing {
    bool apart = false;            ///< the case has another survey
    std::string name = "compare";  ///< of all files
    std::string words;             ///< empty: the case has no survey
};

/// Files of other folders may have the same name. What was made of those stays, and a number tells this one from it.
void number_apart(const fs::path& run_dir, const SurveyFiles& now, Standing& standing) {
    const std::string first = standing.name;
    for (int number = 2;; ++number) {
        const std::optional<SurveyFiles> other = files_in(run_dir / (standing.name + ".json"));
        if (!other || same_files(*other, now)) return;
        standing.words += fmt::format(" `{}.json` is of other files (`{}`), and stays.", standing.name,
                                      (other->footprint.empty() ? other->bed_change : other->footprint).string());
        standing.name = fmt::format("{}_{}", first, number);
    }
}

Standing standing_of(const CompareOptions& options) {
    const SurveyFiles own = files_of_case(options.run_dir), now = files_of(options);
    if (own.footprint.empty()) return {};
    if (same_files(own, now)) return {false, "compare", "These are the survey files of the case, as in `report.md`."};
    std::string name = (now.footprint.empty() ? now.bed_change : now.footprint).stem().string();
    std::replace(name.begin(), name.end(), ' ', '_');  // links of Markdown end at a space
    Standing standing = {
        true, "compare_with_" + name,
        fmt::format("The case has other survey files (`{}`). `report.md`, `compare.json`, `figures/compare.png` and "
                    "the ParaView state `survey` are of those, and stay.",
                    own.footprint.filename().string())};
    number_apart(options.run_dir, now, standing);
    return standing;
}

void require_survey(const CompareOptions& options) {
    if (options.survey.empty() && options.bed_change.empty())
        throw UserError(
            "frana compare: found no survey; expected --survey, --bed-change, or both; give the surveyed extent or the "
            "difference of two surveys");
}

/// The comparison on one page, with its picture.
std::string page(const FigureSource& source, const Comparison& comparison, const Standing& standing,
                 const std::vector<DrawnFigure>& figures) {
    std::string text = fmt::format("# {}\n\n", source.title) + comparison_section(comparison);
    if (!standing.words.empty()) text += standing.words + "\n\n";
    for (const DrawnFigure& figure : figures)
        text += fmt::format("![{0}]({1})\n\n*{0}*\n\n", figure.caption, figure.path);
    return text + source.footer + "\n";
}

/// For ParaView, where the run has files for it. Returns what was written.
std::vector<fs::path> leave_for_paraview(const FigureSource& source, const Comparison& comparison) {
    const fs::path& dir = source.run_dir;
    if (!source.survey || source.bed.values.empty() || !fs::exists(dir / "grid.pvd")) return {};
    write_survey(dir, source.bed, *ever_covered(source.rasters), comparison.limit, rings_of(*source.survey));
    write_states(dir, source.title);
    return {dir / "survey_areas.vtp", dir / "survey_outlines.vtp", dir / "states"};
}

}  // namespace

RunAndSurvey read_run_and_survey(const CompareOptions& options) {
    require_survey(options);
    RunAndSurvey read;
    FigureSource& source = read.run = read_finished_run(options.run_dir, read.warnings);
    require_rasters(options.run_dir, source.rasters);
    require_erodible(options, source.rasters);
    std::vector<std::string> said;  // of what the scores are made of: it belongs to them
    widen_to_survey(source, files_of(options), said);
    const Survey survey =
        read_survey_files(files_of(options), find_product(source.rasters, "peak_depth")->raster, said);
    const std::optional<Raster> later = released_later(options, source, said);
    join_remarks_on_coordinates(said);
    read.comparison = compare_rasters(source.rasters, source.bed.values.empty() ? nullptr : &source.bed,
                                      source.footprint_depth, survey, source.starts, later ? &*later : nullptr);
    if (!read.comparison.stray_path.empty()) throw UserError(read.comparison.stray_path);
    std::vector<std::string>& remarks = read.comparison.remarks;
    remarks.insert(remarks.begin(), said.begin(), said.end());
    read.warnings.insert(read.warnings.end(), said.begin(), said.end());
    remark_on_left(noticeably_left_in(json_in(options.run_dir / "run.json")), read.comparison);
    if (read.comparison.extents) source.survey = survey.footprint;
    source.runout_paths = paths_of(read.comparison);
    return read;
}

int compare_command(const CompareOptions& options) {
    require_survey(options);
    if (!options.json.empty()) require_other_json(options);
    RunAndSurvey read = read_run_and_survey(options);
    FigureSource& source = read.run;
    const Comparison& comparison = read.comparison;
    const Standing standing = standing_of(options);
    const fs::path& dir = options.run_dir;
    source.comparison = standing.name;

    std::vector<fs::path> written = {options.json.empty() ? dir / (standing.name + ".json") : options.json};
    write_scores(dir, written.front(), comparison, standing.name);  // before the picture: scores are worth more
    if (fs::exists(dir / "resolved.toml")) read_places(source, read.warnings);
    Gallery gallery(dir);
    add_overlay(source, gallery);
    if (!comparison.bed_change_steps.empty()) {
        written.push_back(dir / (standing.name + "_bed_change.csv"));
        add_bed_change(source, gallery);
    }
    const std::vector<DrawnFigure> figures = gallery.draw(threads_for_figures(), read.warnings);
    written.insert(written.begin() + 1, dir / (standing.name + ".md"));
    write_text(written[1], page(source, comparison, standing, figures));
    for (const DrawnFigure& figure : figures) written.push_back(dir / figure.path);
    if (!standing.apart)
        for (const fs::path& file : leave_for_paraview(source, comparison)) written.push_back(file);

    std::cout << comparison_section(comparison);
    if (!standing.words.empty()) std::cout << standing.words << "\n\n";
    std::cout << "Written:\n";
    for (const fs::path& file : written) std::cout << file.string() << '\n';
    join_remarks_on_coordinates(read.warnings);
    for (const std::string& warning : read.warnings) std::cerr << "warning: " << warning << '\n';
    return 0;
}

}  // namespace frana
