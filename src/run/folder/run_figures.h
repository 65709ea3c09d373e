#pragma once
// The pictures of a run: drawn at its end, and again by `frana figures`. Functions named add_... put one into a gallery; the
// source has to stay until it is drawn.
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "run/folder/gallery.h"
#include "run/folder/products.h"
#include "run/folder/run_record.h"
#include "scene/scene.h"
#include "vtk_io/figures/barriers_3d.h"

namespace frana {

/// What there is to draw. Histories, profiles and gauges are read from the tables in the folder.
struct FigureSource {
    std::filesystem::path run_dir;
    std::string title;
    std::string footer;  ///< parameters in a line
    std::string date;    ///< of the run, such as 2026-11-25; empty: not known
    Raster bed;
    std::vector<ProductRaster> rasters;  ///< peak_depth, peak_speed, final_depth are drawn
    double footprint_depth = 0.1;        ///< [m]
    std::optional<Polygons> survey;
    std::vector<Vec2> starts;            ///< where material came in that did not lie at the start [m]
    std::vector<Polyline> runout_paths;  ///< drawn in the overlay with the survey
    std::string comparison = "compare";  ///< names the pictures of the comparison, and its table of bed changes
    std::vector<Profile> profiles;
    std::vector<Gauge> gauges;
    std::vector<Section> sections;
    std::vector<InflowPlace> inflows;
    /// That the front is measured from.
    std::string front_origin = "the release's centre";
    /// Names of barriers.
    std::vector<std::string> never_hit;
    /// The time that `mean_force` in a barrier's table is the mean over, by its name, where forces are known [s].
    std::map<std::string, double> mean_over;
    bool in_3d = false;                    ///< the case has a stage of 3D points
    std::vector<BarrierTop> barrier_tops;  ///< in the case's order
    std::vector<Barrier> barriers;         ///< with what they stand on
    double density = 0.0;                  ///< of the material [kg/m3]; 0: not known
    std::optional<double> time;            ///< of the profiles besides the first and the last [s]
    int width = 1400, height = 1200;       ///< of the maps; charts are as wide and 0.6 as high [pixels]
};

/// All figures but films.
void add_figures(const FigureSource& source, Gallery& gallery);

/// About how long the pictures of a case with `outputs` outputs take on so many threads [s]. 0 where it has none. A
/// forecast for users: it takes each picture to be of the usual size.
double expected_drawing_seconds(const Scene& scene, Index outputs, int threads);

/// A map of one raster on the terrain: figures/map_<name>.png. `what` is its name in plain words. `extent` is the depth
/// that says where the flow is, for a raster that is no depth. nullptr: where the raster is above zero.
void add_map(const FigureSource& source, const ProductRaster& product, const std::string& what,
             const ProductRaster* extent, Gallery& gallery);

/// figures/compare.png, or as `comparison` names it: the simulated extent (all pixels of peak_depth above
/// footprint_depth) and the surveyed one.
/// Nothing without a survey, the terrain or the peak depth.
void add_overlay(const FigureSource& source, Gallery& gallery);

}  // namespace frana
