#pragma once
// Where the inflows of a case come in, for maps and a GIS.
#include <string>
#include <vector>

#include "io/gdal_features.h"
#include "scene/scene.h"
#include "vtk_io/figures/map_figure.h"

namespace frana {

class CaseFile;

/// A line or an area. Neither: its file has gone.
struct InflowPlace {
    std::string name;
    Polyline line;
    Polygons area;
};

/// Of all [[inflow]] of a case, in its order, in the CRS `crs_wkt`. A file that cannot be read is a warning.
std::vector<InflowPlace> inflow_places(const CaseFile& file, const std::string& crs_wkt,
                                       std::vector<std::string>& warnings);

/// When a table has brought a volume [m^3], at most its whole [s].
double time_of(const Inflow& inflow, double volume);

/// As maps show them. Every ring of an area is closed.
std::vector<NamedLine> inflow_plans(const std::vector<InflowPlace>& places);

/// Layer "inflow" of the lines, and "inflow_areas" of the polygons. Each has of its table volume_m3,
/// peak_discharge_m3_s, peak_s, start_s and end_s. A polygon has area_m2 too, its own. `places` are those of the scene's
/// inflows.
std::vector<ShapeLayer> inflow_layers(const Scene& scene, const std::vector<InflowPlace>& places);

}  // namespace frana
