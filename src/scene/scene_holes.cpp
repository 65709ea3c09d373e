// Holes of the elevation model: walls, or places where mass leaves (boundary.holes).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scene/remarks.h"
#include "scene/scene_parts.h"

namespace frana {

double hole_wall_height(const Scene& scene) {
    double deepest = 0.0;
    for (const Seeds* seeds : scene.all_particles())
        for (const double depth : seeds->depth) deepest = std::max(deepest, depth);
    const double two_cells = 2.0 * scene.bed.geometry.cell;
    return two_cells + std::min(two_cells, deepest);
}

void remark_on_holes(std::vector<std::string>& log, const Holes& holes, const GridGeometry& g, bool open,
                     const std::string& place) {
    if (holes.count == 0) return;
    const double x = g.x(holes.first % g.nx), y = g.y(holes.first / g.nx);
    remark_on(log, open ? Remark::open_holes : Remark::walled_holes, place,
              {double(holes.nodes.size()), double(holes.count),
               fmt::format("{} at x {:.10g}, y {:.10g}", holes.largest, x, y)});
}

void find_holes(const CaseFile& file, Scene& scene) {
    scene.holes = holes_of(scene.bed);
    remark_on_holes(scene.log, scene.holes, scene.bed.geometry, file.word("boundary.holes") == "open",
                    file.place("terrain.dem"));
}

void wall_holes(const CaseFile& file, Scene& scene, Problems& problems) {
    // A part of a terrain may come to holes later on.
    if ((scene.holes.count == 0 && !scene.wider) || file.word("boundary.holes") == "open") return;
    const std::size_t count = scene.holes.nodes.size();
    if (scene.structure && count > 0)
        problems.add(file.place("boundary.holes"),
                     fmt::format("found \"wall\" beside material.structure with {} node{} without elevation inside the "
                                 "terrain",
                                 count, count == 1 ? "" : "s"),
                     "expected none there, since particles that hold together know walls along x and y only",
                     "fill the elevation model (gdal_fillnodata.py), or give boundary.holes = \"open\"");
    scene.hole_top = hole_wall_height(scene);
}

}  // namespace frana
