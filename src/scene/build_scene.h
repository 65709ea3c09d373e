#pragma once
// From a checked case file to a Scene: terrain, releases, particles, laws.
#include <string>
#include <vector>

#include "particles/generate.h"
#include "scene/case_file.h"
#include "scene/scene.h"
#include "scene/toolbox.h"

namespace frana {

/// One release as it was understood, for `frana check` and reports.
struct ReleaseSummary {
    std::string name;              ///< "release.0 (release.geojson)"
    Index table = 0;               ///< number of its [[release]]
    ReleaseReport report;          ///< area, volume, particles: particles/generate.h
    double max_depth = 0.0;        ///< vertical [m]
    double at = 0.0;               ///< when it enters [s]
    bool when_hit = false;         ///< it enters when the flow reaches it
    bool included_in_dem = false;  ///< it is cut out of the bed, at the start or when it enters
    double slope_min_deg = 0.0;    ///< bed slope at the nodes under the release [degrees]
    double slope_mean_deg = 0.0;
    double slope_max_deg = 0.0;
};

struct BuiltScene {
    Scene scene;
    std::vector<ReleaseSummary> releases;
};

/// "12300 m2, mu 0.12, xi 300 to 500 m/s^2".
std::string friction_sentence(const FrictionPart& part);

/// Reads the terrain and the releases through `reader`, barriers of any shape through `meshes`, and makes the
/// particles. Checks all of it: outlines that leave the terrain, releases without volume, nodata within three cells of
/// material. Throws one UserError with every problem found.
BuiltScene build_scene_in_detail(const CaseFile& file, const GisReader& reader, const MeshReader& meshes = {});

/// The same without the summaries.
Scene build_scene(const CaseFile& file, const GisReader& reader, const MeshReader& meshes = {});

}  // namespace frana
