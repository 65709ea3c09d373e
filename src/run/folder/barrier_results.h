#pragma once
// What a run did to barriers, such as buildings, as polygons for a GIS.
#include <filesystem>
#include <string>
#include <vector>

#include "io/gdal_features.h"
#include "observe/barriers.h"
#include "run/folder/products.h"

namespace frana {

class CaseFile;

/// A [[barrier]] of the case with an outline.
struct BarrierSource {
    std::string name;  ///< with `each` the barriers are NAME_1, NAME_2, ... in the order of the file's polygons
    std::filesystem::path outline;
    bool each = false;
};

/// Those of the case, in its order.
std::vector<BarrierSource> barrier_sources(const CaseFile& file);

/// Layer "barriers": every polygon of every outline with the attributes of its feature, and
/// - barrier: its name; peak_force_N: the largest horizontal force on the barrier, `peak_force` of run.json, and
///   peak_force_mean_over_s: the time that it is the mean over, where forces are known;
/// - peak_dynamic_pressure_Pa (density times speed squared), peak_depth_m: the largest, and hit_s: the earliest
///   arrival, at its faces;
///   dynamic_pressure_north_Pa, depth_north_m, ... of each side; area_m2 of the polygon. See hit_on().
/// An attribute of the same name gets "_input" at its end. No shapes without sources. UserError when one cannot be read.
ShapeLayer barrier_layer(const std::vector<BarrierSource>& sources, const std::vector<BarrierSummary>& summaries,
                         const std::vector<ProductRaster>& rasters);

}  // namespace frana
