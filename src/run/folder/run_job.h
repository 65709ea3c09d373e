#pragma once
// A run once the scene stands and the folder is ready: observe, run, and leave products, figures and report.
#include <filesystem>
#include <string>

#include "run/folder/checkpoint.h"
#include "run/folder/products.h"
#include "run/folder/run_record.h"
#include "run/run_loop.h"
#include "scene/scene.h"

namespace frana {

/// The observers that the scene's output needs, writing into `run_dir`. `rasters` is filled at the end.
Observers make_observers(const Scene& scene, const std::filesystem::path& run_dir,
                         std::vector<BarrierSummary>& barriers, std::vector<ProductRaster>& rasters);

/// What is said of a run whose pictures were cut off.
std::string cutoff_sentence(const std::filesystem::path& run_dir);

/// When the scene's run is observed, and when it is over.
RunPlan plan_of(const Scene& scene, bool cut_short);

/// Runs `simulation` to the scene's end in a prepared folder and leaves everything a run leaves there. `record` comes
/// from begin_record(). The returned record has the summary, figures and warnings. A NumericsError of the simulation is
/// stored in its summary; UserError when a file cannot be written. With a `keeper` the state is saved while it runs.
/// The run goes on from the keeper's state if it has one. `more` observe after the scene's own observers. `rasters`
/// gets what the run leaves for a GIS.
RunRecord carry_out(const Scene& scene, Simulation& simulation, const std::filesystem::path& run_dir, RunRecord record,
                    const Interrupt& interrupt, Progress& progress, CheckpointKeeper* keeper = nullptr,
                    Observers more = {}, std::vector<ProductRaster>* rasters = nullptr);

/// The same run that leaves nothing on the disk. Returns its record, and the rasters that it would leave for a GIS.
/// Its gauges, sections, profiles, in-situ work and barriers' forces, which are files, are lost.
RunRecord carry_out_in_memory(const Scene& scene, Simulation& simulation, RunRecord record, const Interrupt& interrupt,
                              Progress& progress, Observers more, std::vector<ProductRaster>& rasters);

}  // namespace frana
