#pragma once
// 3D points on their terrain and against barriers: seen obliquely, and in a vertical section.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "vtk_io/figures/moment_3d.h"

namespace frana {

struct ViewAngles3d {
    double azimuth = 0.0,
           down = 0.4;  ///< of the direction of view: clockwise from north, below the horizon [radians]
};

struct Figure3d {
    Raster bed;  ///< terrain [m]
    Moment3d moment;
    View3d view;
    std::optional<ViewAngles3d> look;  ///< nothing: best_view()
    std::vector<Vec3> room;            ///< places that the picture has room for; none: those of the moment [m]
    std::string title, footer;
    std::string struck;               ///< caption of the most loaded barrier's faces, shown by themselves
    int width = 1600, height = 1100;  ///< [px]; a section is as high as it needs, and at most this
};

/// From the side and a little upstream is best, the flow from left to right. Then come higher places, and other sides.
/// What counts besides is how much the ground hides.
ViewAngles3d best_view(const Figure3d& figure);

/// The block of terrain in view with all points as balls of their size in the colours of their speed. Particles are
/// balls on their surface. Barriers have the colours of the pressure on them. The struck faces of the most loaded one
/// are shown by themselves, for there the points are in front. False with a reason when there is no renderer (no file
/// is made); UserError when the file cannot be written.
bool render_3d(const Figure3d& figure, const std::filesystem::path& png, std::string& why_not);

/// The vertical section along the flow through the middle of what happens. It shows ground, barriers with the pressure
/// on their sides there, and particles as bars. Points are no further from the plane than twice their typical size
/// (about a cell of their grid). Heights and lengths have one scale. False with a reason when no point is near or
/// pictures are switched off; else as above.
bool render_section(const Figure3d& figure, const std::filesystem::path& png, std::string& why_not);

}  // namespace frana
