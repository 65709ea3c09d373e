// `frana compare RUN_DIR --survey FOOTPRINT`: a finished run held against a survey, from the run's own files.
#include <fmt/core.h>

#include <algorithm>
#include <iostream>
#include <iterator>

#include "base/atomic_file.h"
#include "base/error.h"
#include "frana_commands.h"
#include "frana_compare.h"
#include "frana_figures.h"
#include "run/folder/comparison.h"
#include "run/folder/release_results.h"
#include "run/folder/run_charts.h"
#include "run/folder/run_folder.h"
#include "run/folder/states.h"
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
    const fs::path own = options.run_dir / "compare.json";
    std::copy_if(of_run.begin(), of_run.end(), std::back_inserter(inputs),
                 [&](const fs::path& file) { return file != own; });
    require_no_input("--json", options.json, inputs);
}

/// compare.md: the comparison on one page, with its picture.
std::string page(const FigureSource& source, const Comparison& comparison, const std::vector<DrawnFigure>& figures) {
    std::string text = fmt::format("# {}\n\n", source.title) + comparison_section(comparison);
    for (const DrawnFigure& figure : figures)
        text += fmt::format("![{0}]({1})\n\n*{0}*\n\n", figure.caption, figure.path);
    return text + source.footer + "\n";
}

}  // namespace

RunAndSurvey read_run_and_survey(const CompareOptions& options) {
    RunAndSurvey read;
    FigureSource& source = read.run = read_finished_run(options.run_dir, read.warnings);
    require_rasters(options.run_dir, source.rasters);
    require_erodible(options, source.rasters);
    const Survey survey =
        read_survey_files({options.survey, options.deposit, options.path, options.bed_change, options.bed_change_noise},
                          find_product(source.rasters, "peak_depth")->raster, read.warnings);
    const std::optional<Raster> later = released_later(options, source, read.warnings);
    read.comparison = compare_rasters(source.rasters, source.bed.values.empty() ? nullptr : &source.bed,
                                      source.footprint_depth, survey, source.start, later ? &*later : nullptr);
    source.survey = survey.footprint;
    source.runout_path = read.comparison.path;
    return read;
}

int compare_command(const CompareOptions& options) {
    if (!options.json.empty()) require_other_json(options);
    RunAndSurvey read = read_run_and_survey(options);
    FigureSource& source = read.run;
    const Comparison& comparison = read.comparison;
    std::vector<std::string>& warnings = read.warnings;
    const bool bed_known = !source.bed.values.empty();

    const fs::path json = options.json.empty() ? options.run_dir / "compare.json" : options.json;
    write_scores(options.run_dir, json, comparison);  // before the picture: scores are worth more
    Gallery gallery(options.run_dir);
    if (bed_known) add_overlay(source, gallery);
    if (!comparison.bed_change_steps.empty()) add_bed_change(source, gallery);
    const std::vector<DrawnFigure> figures = gallery.draw(threads_for_figures(), warnings);
    write_text(options.run_dir / "compare.md", page(source, comparison, figures));

    if (bed_known && fs::exists(options.run_dir / "grid.pvd")) {
        write_survey(options.run_dir, source.bed, *ever_covered(source.rasters), comparison.limit,
                     rings_of(*source.survey));
        write_states(options.run_dir, source.title);
    }

    std::cout << comparison_section(comparison) << json.string() << '\n'
              << (options.run_dir / "compare.md").string() << '\n';
    for (const DrawnFigure& figure : figures) std::cout << (options.run_dir / figure.path).string() << '\n';
    for (const std::string& warning : warnings) std::cerr << "warning: " << warning << '\n';
    return 0;
}

}  // namespace frana
