#include "run/calibrate/predict_folder.h"

#include <fmt/core.h>

#include "base/atomic_file.h"
#include "ensemble/sample_run.h"
#include "ensemble/wanted_maps.h"
#include "io/gdal_reader.h"
#include "run/ensemble/ensemble_run.h"
#include "run/ensemble/kept_rows.h"
#include "run/ensemble/run_pool.h"
#include "run/folder/input_sums.h"
#include "scene/build_scene.h"
#include "scene/case_file.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

fs::path ensemble_file(const fs::path& dir) { return dir / "predict.toml"; }
fs::path maps_folder(const fs::path& dir) { return dir / "predict"; }

/// predict.toml: the ensemble, and a mark of its case and the files that this names. The mark tells whether they have
/// changed.
std::string ensemble_text(const EnsemblePlan& maps) {
    return fmt::format("# case and files {:016x}\n", sum_of(mark_of_inputs(CaseFile::read(maps.case_file)))) +
           ensemble_of_table(maps, "posterior.csv");
}

}  // namespace

void try_prediction(const CalibrationPlan& plan) {
    if (!plan.predict) return;
    std::vector<std::string> middle;
    for (const Vary& vary : plan.vary) middle.push_back(vary.key + "=" + vary.distribution.text(0.5));
    const GdalReader reader;
    const Scene scene = build_scene(CaseFile::read(plan.predict->case_file, middle), reader, meshes_in_turn());
    require_kept_thresholds(*plan.predict, scene.output.footprint_depth, "predict");
}

bool is_predicted(const fs::path& dir, const EnsemblePlan& maps) {
    return fs::exists(maps_folder(dir) / "ensemble.json") && text_in(ensemble_file(dir)) == ensemble_text(maps);
}

void forget_prediction(const fs::path& dir) { remove_ensemble(maps_folder(dir)); }

PredictFolder::PredictFolder(const fs::path& dir, const EnsemblePlan& maps) : dir_(dir), lock_(dir) {
    const std::string text = ensemble_text(maps);
    if (text_in(file()) == text) return;
    forget_prediction(dir);
    write_text(file(), text);
}

fs::path PredictFolder::file() const { return ensemble_file(dir_); }
fs::path PredictFolder::folder() const { return maps_folder(dir_); }

}  // namespace frana
