#pragma once
// A page to look at a flow on its terrain: one HTML file, which asks for nothing from anywhere.
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/colour.h"
#include "run/web/flow_frames.h"
#include "terrain/triangle_mesh.h"

namespace frana {

/// A raster that can lie on the terrain.
struct PageDrape {
    std::string name;   ///< "peak_depth"
    std::string label;  ///< for people: "peak depth"
    std::string unit;   ///< of the values: "m"
    Colormap colours = Colormap::depth;
    double low = 0.0, high = 1.0;       ///< of the colours
    Raster raster;                      ///< NaN: nothing is shown there
    bool above = false, below = false;  ///< values lie beyond the colours
};

struct PagePlace {
    std::string name;
    Vec2 point{0, 0};
};
struct PageLine {
    std::string name;
    Polyline line;
};

/// A solid: an outline or a line with a top, or a mesh.
struct PageBarrier {
    std::string name;
    Polygons outline;
    Polyline line;
    std::optional<double> level;               ///< elevation of a level top [m]
    double height = 0.0;                       ///< above the ground, where there is none [m]
    std::shared_ptr<const TriangleMesh> mesh;  ///< or nullptr
};

/// How far and how much, through time.
struct PageCurves {
    std::vector<double> time, runout, volume;  ///< [s], [m], [m3]
};

struct WebPage {
    std::string title;
    std::string caption;                                     ///< parameters in a line
    std::vector<std::pair<std::string, std::string>> facts;  ///< "released volume", "24 300 m3"
    std::vector<std::string> remarks;
    Raster bed;
    const FlowFrames* frames = nullptr;  ///< nullptr: none are known
    std::vector<PageDrape> drapes;
    double depth_high = 1.0, speed_high = 1.0;  ///< of the colours of frames [m], [m/s]
    double footprint_depth = 0.1;               ///< what is thinner is not shown [m]
    std::optional<Polygons> survey;
    std::vector<PageLine> lines;
    std::vector<PagePlace> gauges;
    std::vector<PageBarrier> barriers;
    PageCurves curves;
};

/// Empty where this build can make pages; otherwise what is missing and what to do.
std::string no_page_reason();

/// The file's text. Titles and names may hold anything; what is no UTF-8 becomes a mark that says so.
std::string web_page(const WebPage& page);

}  // namespace frana
