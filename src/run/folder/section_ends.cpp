#include "run/folder/section_ends.h"

#include <fmt/core.h>

#include <cmath>

namespace frana {
namespace {

/// Of the nearest node; nodata outside of the raster.
double depth_at(const Raster& depth, const Vec2& place) {
    const GridGeometry& g = depth.geometry;
    const auto i = static_cast<Index>(std::lround((place.x() - g.x0) / g.cell)),
               j = static_cast<Index>(std::lround((place.y() - g.y0) / g.cell));
    return i >= 0 && j >= 0 && i < g.nx && j < g.ny ? depth.at(i, j) : Raster::nodata;
}

}  // namespace

std::vector<std::string> remarks_on_ends(const std::vector<Section>& sections, const Raster& peak_depth, double limit) {
    std::vector<std::string> remarks;
    const auto look = [&](const Section& section, const Vec2& end, const Vec2& before) {
        const double depth = depth_at(peak_depth, end),
                     beyond = depth_at(peak_depth, end + peak_depth.geometry.cell * (end - before).normalized());
        if (depth > limit && beyond > limit)
            remarks.push_back(
                fmt::format("the flow passed beyond the end of section {} at ({:.10g}, {:.10g}), {:.2g} m deep: draw "
                            "the line longer",
                            section.name, end.x(), end.y(), depth));
    };
    for (const Section& section : sections) {
        const Polyline& line = section.line;
        if (line.size() < 2) continue;
        look(section, line.front(), line[1]);
        look(section, line.back(), line[line.size() - 2]);
    }
    return remarks;
}

}  // namespace frana
