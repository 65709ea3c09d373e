#pragma once
// results.gpkg: what a run did, as shapes for a GIS.
#include <string>
#include <vector>

#include "io/gdal_features.h"
#include "run/folder/products.h"
#include "run/folder/run_record.h"
#include "scene/scene.h"

namespace frana {

/// The layers of results.gpkg, those that are empty left out:
/// - barriers: barrier_layer() (barrier_results.h);
/// - footprint: outlines of what was ever deeper than the footprint depth; outlines: of 0.5, 1, 2 and 5 m (depth_m, area_m2);
/// - release: release_layer() (release_results.h), and of releases without a shape the pixels where material was at the
///   start (area_m2);
/// - gauges, profiles: the largest peak_depth_m, peak_speed_m_s and peak_dynamic_pressure_Pa (density times speed
///   squared) of the pixels
///   that they lie on, and the earliest arrival_s there;
/// - sections: volume_m3 that passed, peak_discharge_m3_s and peak_s when that was;
/// - inflow, inflow_areas: inflow_layers() (inflow_results.h);
/// - survey: the surveyed footprint.
/// What was never reached has no peaks. Trouble with an outline of a barrier is a warning.
std::vector<ShapeLayer> result_layers(const Scene& scene, const std::vector<ProductRaster>& rasters, RunRecord& record);

}  // namespace frana
