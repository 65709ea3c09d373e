#pragma once
// A field on its terrain as a map, ready for a paper: north up, with everything needed to read it.
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/colour.h"
#include "terrain/raster.h"

namespace frana {

/// What a line of a map is; each has dashes of its own.
enum class MapLine { profile, section, inflow, path };

struct NamedLine {
    std::string name;
    Polyline line;
    MapLine kind = MapLine::profile;  ///< not of barriers
};
struct NamedPoint {
    std::string name;
    Vec2 point{0, 0};
};

/// A class of places, and its colour.
struct MapClass {
    std::string name;
    Colour colour;
};

struct MapFigure {
    Raster bed;                 ///< terrain [m]; NaN is plain light grey
    std::vector<double> field;  ///< on bed.geometry, row 0 south; NaN is not shown
    double shown_above = 0.1;   ///< shown (and outlined) where |field| exceeds this
    /// With a field here, as large, `field` is shown where this one exceeds `shown_above`, whatever its own value. The
    /// flow is outlined there too. outline_label is its name and unit.
    std::vector<double> outline_field;
    std::string outline_label;
    std::string title;
    std::string field_label = "peak depth [m]";      ///< name and unit, for the colour bar
    std::optional<std::pair<double, double>> range;  ///< of the colours; default: from the field
    bool thick_release = false;                      ///< the depth of a flow: map_range.h, Top::flow
    Colormap colormap = Colormap::depth;
    std::optional<Polygons> survey;  ///< mapped outline
    /// Rings of the simulated extent. With a survey, areas of both, of this one and of the survey only are coloured
    /// instead of the field. The field then only says what has to be in view.
    std::optional<std::vector<Polyline>> simulated;
    /// With classes here, `field` holds their numbers, from 1 on, each node's for all of its pixel; 0 is none. The legend names
    /// them instead of a colour bar.
    std::vector<MapClass> classes;
    std::vector<NamedLine> barriers;  ///< in plan: outlines are closed, faces of walls along lines are not
    std::vector<NamedLine> lines;
    std::vector<NamedPoint> gauges;
    std::string footer;                          ///< model, parameters; wrapped
    std::optional<std::array<double, 4>> focus;  ///< xmin, ymin, xmax, ymax to be in view [m]
    bool explained = true;                       ///< false: colour bar, scale and legend stand elsewhere
    int width = 1400;                            ///< at most [px]
    int height = 1200;                           ///< at most [px]

    const std::vector<double>& outlined() const { return outline_field.empty() ? field : outline_field; }
    bool shows_overlay() const { return simulated && survey; }
    bool has_colour_bar() const { return explained && !shows_overlay() && classes.empty(); }
    /// Thickness of the surveyed outline, in sizes of ordinary text: thinner where adjacent areas are shown.
    double survey_pen() const { return shows_overlay() ? 0.1 : 0.16; }
};

/// Draws the map into a PNG. Where `focus` is not given, the covered area and the survey are in view with a
/// margin. So is at least 30 % of the terrain's width and height. Width and height are met exactly unless the terrain
/// is too narrow to fill 90 % of them. Then the picture is cut to what it needs. False with a reason when pictures are
/// switched off (no file is made); UserError when the file cannot be written.
bool render_map(const MapFigure& figure, const std::filesystem::path& png, std::string& why_not);

}  // namespace frana
