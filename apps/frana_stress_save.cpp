#include "frana_stress_save.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/atomic_file.h"
#include "io/gdal_writer.h"
#include "particles/export.h"
#include "stress/draw.h"

namespace frana {

using namespace stress;

std::string replay_options(const Draft& draft) {
    std::string text = fmt::format("--steps {}", draft.steps);
    if (draft.claims.rests) text += " --rests";
    if (draft.claims.mirror != Mirror::none) text += fmt::format(" --mirror {}", word_of(draft.claims.mirror));
    if (draft.claims.threads) text += " --same-threads";
    return text;
}

void save_draft(const std::filesystem::path& folder, const Draft& draft, const Violation& broken) {
    std::filesystem::create_directories(folder);
    for (const auto& [name, raster] : draft.rasters)
        write_geotiff(folder / name, raster, name[0] == 'v' ? "m/s" : "m", name.substr(0, name.find('.')));
    Draft as_run = draft;  // what `frana run` is to reach: a little beyond the step that fails
    as_run.keys["time.end"] = toml_number(broken.time > 0.0 ? 1.1 * broken.time : 1.0);
    as_run.keys["output.every"] = as_run.keys["time.end"];
    const std::string why = fmt::format("# {}, step {}: {}\n# Watched by: frana stress --case case.toml {}\n",
                                        broken.invariant, broken.step, broken.text, replay_options(draft));
    write_text(folder / "case.toml", why + toml_of(as_run));
    const Scene scene = scene_of(draft);
    write_seeds_csv(folder / "particles.csv", make_seeds_export(scene.particles, scene.density, scene.bed));
}

}  // namespace frana
