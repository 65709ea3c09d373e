#pragma once
// The releases of a run as polygons for a GIS.
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/gdal_features.h"
#include "observe/frame.h"

namespace frana {

class CaseFile;

/// A [[release]] of the case.
struct ReleaseSource {
    Index table = 0;      ///< its number
    std::string outline;  ///< as GDAL opens it, with its layer; empty: a mask, a raster or the whole terrain
    std::string
        mask;  ///< without an outline: the raster above 0 where material is; empty: the whole terrain, or a surface
    bool late = false;  ///< it enters after the start

    bool has_shape() const { return !outline.empty() || !mask.empty(); }
};

/// All of the case, in its order.
std::vector<ReleaseSource> release_sources(const CaseFile& file);

/// Layer "release": outlines and masks of the case, a row each, with `release`, the number of the table from 0, and
/// `area_m2`, overlaps counted once. `entered_s` is empty where it did not enter. `volume_m3` is that of the whole table
/// where it is known. That is so for what enters later (`late`), and for a single release at the start (`at_start` [m3]).
/// Of masks it has the pixels that touch the terrain, `extent`. UserError when a file cannot be read.
ShapeLayer release_layer(const std::vector<ReleaseSource>& sources, const std::vector<LateEntry>& late, double at_start,
                         const std::array<double, 4>& extent, const std::string& crs_wkt);

/// 1 on pixels of `like` whose middle lies in the outline or mask of a release of the start. Else 0. Nothing where no such
/// release has one. UserError when a file cannot be read.
std::optional<Raster> released_at_start(const std::vector<ReleaseSource>& sources, const Raster& like);

/// 1 on pixels of `like` whose middle lies in the outline or mask of a late release that entered. Else 0.
/// Nothing where none did. Those with neither are not known. UserError when a file cannot be read.
std::optional<Raster> released_later_on(const std::vector<ReleaseSource>& sources, const std::vector<LateEntry>& late,
                                        const Raster& like);
/// The same of all that may enter later, whether they do or not.
std::optional<Raster> may_be_released_later_on(const std::vector<ReleaseSource>& sources, const Raster& like);

}  // namespace frana
