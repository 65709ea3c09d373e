#pragma once
// What a run leaves for a GIS: peak and final rasters, and the outline of everything ever covered.
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "observe/observer.h"
#include "scene/parameters.h"
#include "scene/scene.h"
#include "terrain/raster.h"

namespace frana {

/// A raster of the run folder.
struct ProductRaster {
    std::string name;         ///< "peak_depth": rasters/peak_depth.tif
    std::string unit;         ///< "m"
    std::string description;  ///< for the file's band and for people
    Raster raster;            ///< NaN: no terrain, or never reached
};

/// The run's bed as `elevation`. Rasters show the flow on it. It tells nodes without flow from nodes without terrain.
ProductRaster elevation_raster(const Raster& bed);

/// Stores the rasters of the last frame; they are written once the run is over (write_products).
class LastFields : public Observer {
public:
    /// `crs_wkt` goes into every raster.
    LastFields(std::string crs_wkt, std::vector<ProductRaster>& into) : crs_wkt_(std::move(crs_wkt)), into_(into) {}
    std::string name() const override { return "last fields"; }
    void end(const Frame& last) override;
    bool looks_at_fields() const override { return false; }  // at the end it does

private:
    std::string crs_wkt_;
    std::vector<ProductRaster>& into_;
};

/// The rasters of a run as its frame has them:
/// - peak_depth, peak_speed, peak_pressure, peak_dynamic_pressure (when the solver has it), arrival_time;
/// - final_depth, final_velocity_x, final_velocity_y, final_damage of what can break, final_water_depth of the water
///   with it;
/// - eroded_depth, deposited_depth and bed_change of a bed that changes.
/// Negative arrival times and all nodes without terrain become nodata.
std::vector<ProductRaster> product_rasters(const Frame& last, const std::string& crs_wkt);

/// Adds final_elevation to rasters with a bed_change: the bed of the start, and where it follows, that change. The solver's
/// own bed is filtered, and has barriers in it: no later run could begin on that.
void add_ground_at_end(std::vector<ProductRaster>& rasters, const Raster& bed, bool follows);

/// Adds lying_depth to rasters of a run whose bed gains: final_depth, and what of the flow has become bed. Peak depths are
/// described as those of both.
void add_lying_depth(std::vector<ProductRaster>& rasters);

/// What lies there at the end: lying_depth where the run has it, else final_depth; or nullptr.
const ProductRaster* find_lying(const std::vector<ProductRaster>& rasters);

/// The largest depth known of each place: peak_depth, and where it is more, what lies there at the end. Nothing without
/// peak_depth.
std::optional<Raster> ever_covered(const std::vector<ProductRaster>& rasters);

/// The parameters of a spatially varying friction, as the nodes of its bed have them: mu, xi, ...
std::vector<ProductRaster> friction_rasters(const Friction& friction, const Raster& bed);

inline constexpr const char* kForestRaster = "forest_pressure";
/// That raster of a forest that differs spatially: Forest::pressure, and its ground. Nothing of any other.
std::optional<ProductRaster> forest_raster(const Raster& pressure, const Raster& bed);

/// The names that such rasters can have, "mu", "rheology_viscosity", "water_manning_n", "forest_pressure", and their keys
/// in a case.
std::vector<std::pair<std::string, const Parameter*>> friction_keys();
/// Whether a raster of that name is one of those.
bool is_friction(const std::string& name);

/// The raster of that name, or nullptr.
const ProductRaster* find_product(const std::vector<ProductRaster>& rasters, const std::string& name);

/// Area of a depth raster that is deeper than `limit` [m] [m2].
double area_deeper(const Raster& depth, double limit);

/// One of these rasters as its file has it. Zero is nodata where the flow never came: outside of peak_depth above 0. This
/// holds for peaks, depths, velocities and changes of the bed. Zero inside of it stays.
Raster as_in_file(const ProductRaster& product, const std::vector<ProductRaster>& rasters);

/// Writes rasters/<name>.tif, as_in_file(). Each has `title` and the software. It has a date when the environment has
/// SOURCE_DATE_EPOCH. Any other would change the bytes of a run that is resumed. Throws UserError.
void write_rasters(const std::filesystem::path& run_dir, const std::vector<ProductRaster>& rasters,
                   const std::string& title, int threads = 1);

/// Reads rasters/<name>.tif back, those that are there but `elevation`: zero again where the flow never came and there is
/// terrain. Throws UserError when a file cannot be read.
std::vector<ProductRaster> read_rasters(const std::filesystem::path& run_dir);

/// Writes footprint.geojson: where a depth (ever_covered) exceeds `limit` [m]. Throws UserError.
void write_outline(const std::filesystem::path& run_dir, const Raster& covered, double limit);

}  // namespace frana
