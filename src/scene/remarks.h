#pragma once
// Remarks on a case that runs, but may not be what was meant. All of them stand in one table: from which number on each
// is made, and what it says.
#include <limits>
#include <string>
#include <vector>

#include "terrain/holes.h"

namespace frana {

enum class Remark {
    density_not_given,
    density,
    friction,
    xi,
    kind_range,
    water_range,
    size_class,
    release_slope,
    release_depth,
    release_speed,
    gravity,
    rain,
    detrainment,
    few_particles,
    depth_without_data,
    zero_margin,
    steep_as_in_feet,
    high_as_in_feet,
    named_feet,
    walled_holes,
    open_holes,
};

/// A row of the table. The text may name {value}, {low}, {high}, {other} and {what}.
struct RemarkRow {
    Remark remark;
    const char* title;  ///< what it is about, in a few words
    double low, high;   ///< values within need no remark
    const char* text;
};

const std::vector<RemarkRow>& remark_table();

/// What was found, together with the number that the table judges.
struct Found {
    double value = std::numeric_limits<double>::quiet_NaN();
    double other = 0.0;
    std::string what = {};
};

/// Appends "place: what was found; what is expected; what to do" to `log`. Nothing if the value is within the row's
/// limits.
void remark_on(std::vector<std::string>& log, Remark remark, const std::string& place, const Found& found);
/// The same of the holes of a terrain, when it has any: walls, or open.
void remark_on_holes(std::vector<std::string>& log, const Holes& holes, const GridGeometry& grid, bool open,
                     const std::string& place);

/// Of remarks "FILE: text" that say of several files how their coordinates are taken, the first names all of them:
/// "FILE, FILE: text". The others are taken out.
void join_remarks_on_coordinates(std::vector<std::string>& log);

}  // namespace frana
