#pragma once
// A field on its terrain in a view up the slope, as a block cut out of the landscape.
#include "vtk_io/figures/map_figure.h"
#include "vtk_io/figures/objects_3d.h"

namespace frana {

struct PerspectiveFigure {
    Raster bed;                 ///< terrain [m]; nothing is drawn where NaN
    std::vector<double> field;  ///< on bed.geometry, row 0 south
    bool raised = true;         ///< the field is a depth [m] and is put on the terrain
    double shown_above = 0.1;
    std::vector<double> outline_field;  ///< as in MapFigure: says where the field is shown; empty: the field itself
    std::string title;
    std::string field_label = "depth [m]";
    std::optional<std::pair<double, double>> range;
    bool thick_release = false;  ///< the depth of a flow: map_range.h, Top::flow
    Colormap colormap = Colormap::depth;
    std::optional<Polygons> survey;
    std::vector<NamedLine> barriers;  ///< as in MapFigure; drawn on the ground, without names
    std::string footer;
    std::optional<std::array<double, 4>> focus;  ///< the block: xmin, ymin, xmax, ymax [m]
    std::optional<double> look_azimuth_deg;      ///< direction of view, clockwise from north; default: up the
                                                 ///< slope under the material, turned by 25 degrees
    double look_down_deg = 32.0;                 ///< angle of view below the horizon
    /// A camera at a place of its own, in map coordinates and elevation [m]. Otherwise the camera moves back until the
    /// block fills the picture. The block is then all of the terrain unless `focus` says otherwise.
    struct Eye {
        std::array<double, 3> position{}, target{};
        double view_angle_deg = 30.0;  ///< upright
    };
    std::optional<Eye> eye;
    Objects3d objects;  ///< stand on the terrain and have to be in view as well
    int width = 1600;   ///< [px]
    int height = 1100;  ///< [px]

    const std::vector<double>& outlined() const { return outline_field.empty() ? field : outline_field; }
};

/// Draws the block into a PNG of width x height, without vertical exaggeration. False with a reason when
/// there is no renderer (no file is made); UserError when the file cannot be written.
bool render_perspective(const PerspectiveFigure& figure, const std::filesystem::path& png, std::string& why_not);

}  // namespace frana
