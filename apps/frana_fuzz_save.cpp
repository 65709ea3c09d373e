#include "frana_fuzz_save.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/atomic_file.h"
#include "checks/fuzz/draw.h"
#include "io/gdal_writer.h"
#include "particles/export.h"

namespace frana {

std::string replay_options(const fuzz::Draft& draft) {
    std::string text = fmt::format("--steps {}", draft.steps);
    if (draft.claims.rests) text += " --rests";
    if (draft.claims.mirror != fuzz::Mirror::none) text += fmt::format(" --mirror {}", word_of(draft.claims.mirror));
    if (draft.claims.threads) text += " --same-threads";
    if (draft.claims.resumes) text += " --same-resumed";
    return text;
}

namespace {

/// "" where it depends on a law's key.
const char* unit_of(const std::string& raster) {
    if (raster == "vx.tif" || raster == "vy.tif") return "m/s";
    for (const char* length : {"dem.tif", "depth.tif", "loose.tif", "late.tif"})
        if (raster == length) return "m";
    return "";
}

}  // namespace

void save_draft(const std::filesystem::path& folder, const fuzz::Draft& draft, const fuzz::Violation& broken) {
    std::filesystem::create_directories(folder);
    for (const auto& [name, raster] : draft.rasters)
        write_geotiff(folder / name, raster, unit_of(name), name.substr(0, name.find('.')));
    fuzz::Draft as_run = draft;  // what `frana run` is to reach: a little beyond the step that fails
    double end = broken.time > 0.0 ? broken.time : 1.0;
    for (const auto& [key, value] :
         draft.keys) {  // a case whose stage or release begins after its end would be refused
        const std::string part = key.substr(key.find('.'));
        const bool stage = key.rfind("stage#", 0) == 0 && part == ".until";
        if (stage || (key.rfind("release#", 0) == 0 && part == ".at")) end = std::max(end, std::stod(value));
    }
    as_run.keys["time.end"] = fuzz::toml_number(1.1 * end);
    as_run.keys["output.every"] = as_run.keys["time.end"];
    const std::string why = fmt::format("# {}, step {}: {}\n# Watched by: frana stress --case case.toml {}\n",
                                        broken.invariant, broken.step, broken.text, replay_options(draft));
    write_text(folder / "case.toml", why + toml_of(as_run));
    const Scene scene = scene_of(draft);
    write_seeds_csv(folder / "particles.csv", make_seeds_export(scene.particles, scene.density, scene.bed));
}

}  // namespace frana
