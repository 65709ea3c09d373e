#pragma once
// Everything run.json and report.md tell about a run.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "compare/comparison.h"
#include "observe/barriers.h"
#include "observe/insitu.h"
#include "observe/sections.h"
#include "run/end_remarks.h"
#include "run/folder/barrier_hits.h"
#include "run/folder/barrier_results.h"
#include "run/folder/checkpoint.h"
#include "run/folder/inflow_results.h"
#include "run/folder/release_results.h"
#include "run/run_loop.h"
#include "scene/scene.h"
#include "scene/survey_files.h"

namespace frana {

class CaseFile;

/// A figure that was drawn.
struct DrawnFigure {
    std::string path;  ///< relative to the run folder: "figures/map_peak_depth.png"
    std::string caption;
};

/// A key that the case file or --set gives, for the report's table.
struct GivenKey {
    std::string key, value, unit;
};

struct RunRecord {
    std::string name, title;
    std::string case_file;
    std::string caption;  ///< material, water, loose bed, terrain model and cell in a line, for figures
    std::vector<GivenKey> given;
    std::string command_line;  ///< overrides of the case: "--set a=b --until 5"; empty when none
    GridGeometry grid;
    bool has_crs = false;
    double density = 1000.0;          ///< [kg/m^3]
    Index particles = 0;              ///< at the start
    double release_volume = 0.0;      ///< at the start, with the lake of water alone [m^3]
    double volume_of_releases = 0.0;  ///< the same without that lake [m^3]
    double end = 0.0;                 ///< planned [s]
    double whole_end = 0.0;           ///< of the case, without --until [s]
    bool netcdf = false;              ///< the case has series.nc
    bool page = false;                ///< figures/view.html is to be made
    bool pictures_cut_off = false;    ///< an end was requested while they were drawn
    double footprint_depth = 0.1;     ///< [m]
    double footprint_area = 0.0;      ///< ever deeper than footprint_depth [m2]
    double peak_depth = 0.0, peak_speed = 0.0, peak_pressure = 0.0;  ///< of the rasters [m], [m/s], [Pa]
    double peak_dynamic_pressure = 0.0;                              ///< [Pa]
    double final_depth = 0.0;       ///< deepest at the end, with what has become bed [m]
    double final_flow_depth = 0.0;  ///< deepest flow at the end [m]
    bool by_trees_alone = false;    ///< what became bed is what trees held back: there is a forest and no deposition
    double taken_of_bed = 0.0;      ///< of that which was there at the start, not of what the flow had left behind [kg]
    std::vector<Vec2> starts;       ///< of paths of runouts, where material came in that did not lie at the start
    double flow_width = Raster::nodata;  ///< median over the footprint's length, compare/flow_width.h [m]
    int threads = 1;
    std::optional<Comparison> comparison;  ///< with the survey, when the case gives one
    SurveyFiles survey_files;
    std::vector<BarrierSource> barrier_sources;
    std::vector<ReleaseSource> release_sources;
    std::vector<InflowPlace> inflows;
    std::vector<Gauge> gauges;
    std::optional<double> inflow_until;  ///< the last row of the only inflow's table that has come in [s]
    /// That the front is measured from.
    std::string front_origin = "the release's centre";
    RunSummary summary;
    std::vector<DrawnFigure> figures;
    std::vector<InsituTally> insitu;
    std::vector<BarrierSummary> barriers;
    std::vector<BarrierHit> barrier_hits;  ///< in their order; none before the end of the run
    std::vector<SectionSummary> sections;
    std::vector<FrictionPart> friction;  ///< where it varies spatially
    bool friction_of_part = false;       ///< their areas are those of the part of the terrain that the run held
    CheckpointKeeper::Progress checkpoints;
    Extras extras;
    std::vector<std::string> warnings;
    std::vector<std::string> files;  ///< that the run made, relative to its folder: run/folder/run_folder.h

    /// Whether free water is all that there was.
    bool of_water_alone() const { return frana::of_water_alone(extras); }
};

/// What the scene and its case file contribute.
RunRecord begin_record(const Scene& scene, const CaseFile& file);

/// "the end of the simulated time", "interrupted", ... for people.
std::string reason_text(const RunRecord& record);

/// Whether nothing was there at the start, and what is to come has not yet.
bool nothing_came(const RunRecord& record);
/// Whether the run ended before all that inflows and releases of a later time are to bring.
bool more_to_come(const RunRecord& record);

/// Volume of the releases that entered after the start [m^3].
double released_later(const RunRecord& record);

/// What the flow took again of what it had left behind, and what of that lies there at the end [kg].
double taken_again(const RunRecord& record);
double lies_behind(const RunRecord& record);

/// run.json as text: contract in the README; numbers in SI, with all their digits.
std::string run_json(const RunRecord& record);

/// report.md as text: the run on one page. Files and figures are those that lie in the folder now.
std::string report_markdown(const RunRecord& record, const std::filesystem::path& run_dir);

/// The ten lines on the console at the end of a run: figures of the result, where to find more.
std::string closing_lines(const RunRecord& record, const std::filesystem::path& run_dir);

}  // namespace frana
