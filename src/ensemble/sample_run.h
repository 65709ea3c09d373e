#pragma once
// One run of an ensemble. Its input is the case and its overrides. Its result is a row of numbers and the places that
// the flow reached.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "compare/outline.h"
#include "ensemble/gauge_peaks.h"
#include "ensemble/plan.h"
#include "observe/left_terrain.h"
#include "observe/observer.h"
#include "run/end_remarks.h"
#include "run/interrupt.h"
#include "run/run_loop.h"
#include "scene/case_file.h"
#include "scene/toolbox.h"
#include "terrain/sparse_rasters.h"

namespace frana {

/// What all runs share: the case without overrides.
struct EnsembleBase {
    Raster bed;          ///< what of the terrain the case holds at its start
    GridGeometry whole;  ///< nodes of all of the terrain; the maps' pixels
    std::string title;
    double footprint_depth = 0.1;       ///< [m]
    std::optional<Vec2> start;          ///< of the path: the middle of the largest release
    std::optional<Polygons> footprint;  ///< surveyed, where the case has one
    std::optional<Rings> survey;        ///< its rings
    bool bed_changes = false;           ///< it is erodible, or something can be left behind
    std::vector<Gauge> gauges;          ///< of the case
    std::vector<Barrier> barriers;      ///< of the case, which maps show
    Polyline path;                      ///< from there to the edge of all of the terrain, that runouts are measured
                                        ///< along; empty: none is known
    std::vector<Polyline> others;       ///< from other places where material is or comes in; what flows from there
                                        ///< and does not touch the flow along the path is none of its runout
    std::vector<std::string> remarks;   ///< made while the case was built
    std::shared_ptr<const WiderTerrain> wider;  ///< that the bed is a part of; nothing: it is all
};

/// Nothing is stored below the footprint depth [m], so no threshold may lie there. Throws UserError, which names
/// `table`.
void require_kept_thresholds(const EnsemblePlan& plan, double footprint_depth, const std::string& table);

/// A sentence for each key of the bed that varies, but not in zones of the case that set it: theirs wins there.
std::vector<std::string> remarks_on_zones(const EnsemblePlan& plan, const CaseFile& file);

/// Builds the case of the plan once. Throws UserError when it cannot run, or lacks the table of a key that varies.
EnsembleBase ensemble_base(const EnsemblePlan& plan, const GisReader& reader, const MeshReader& meshes);

/// What building the case of a sample remarks and that of the base does not, each with the sample's number. Nothing
/// where it cannot run.
std::vector<std::string> remarks_of_sample(const EnsemblePlan& plan, const EnsembleBase& base, Index sample,
                                           const GisReader& reader, const MeshReader& meshes);

/// What is stored of a run.
struct SampleResult {
    Index sample = 0;
    std::string reason;   ///< as of a run (RunSummary), or "refused": its case cannot run
    std::string message;  ///< of what failed; else empty
    double time = 0.0;    ///< simulated [s]
    Index steps = 0;
    double seconds = 0.0;                     ///< wall time [s]
    double volume = 0.0;                      ///< of all that flowed [m3]
    double runout = 0.0;                      ///< along the path; the straight reach where no path is known [m]
    double reach = 0.0;                       ///< straight from the start [m]
    double footprint_area = 0.0;              ///< [m2]
    double max_depth = 0.0, max_speed = 0.0;  ///< [m], [m/s]
    double eroded = 0.0, deposited = 0.0;     ///< missing of the bed at the end, and lying behind as bed [m3]
    double left_share = 0.0;                  ///< of the mass, that left the terrain [1]
    double mass_error = 0.0;                  ///< of the budget, relative [1]
    bool still_moves = false;                 ///< RunSummary's
    std::optional<double> iou;                ///< of the footprint with the surveyed one, where there is one [1]
    std::optional<double> boundary;           ///< mean distance of their outlines; nothing where nothing flowed [m]
    std::vector<GaugePeak> gauges;            ///< of the base's
    std::vector<EndRemark> remarks;           ///< as a run of its own has them, of what is known here
    SparseRasters peaks;  ///< the plan's fields where the ground was covered, by flow or by what lies there

    bool ended() const { return has_answer(reason); }
    /// Whether its figures are those of a part of the flow.
    bool left_terrain() const { return ended() && left_share > kNoticeablyLeft; }
};

/// Runs a sample on this thread; further observers `also` may be given. Nothing when the interrupt was requested
/// meanwhile.
std::optional<SampleResult> run_sample(const EnsemblePlan& plan, const EnsembleBase& base, Index sample,
                                       const GisReader& reader, const MeshReader& meshes, const Interrupt& interrupt,
                                       std::unique_ptr<Observer> also = nullptr);

}  // namespace frana
