#pragma once
// A page that shows a flow on its terrain, or what many runs say of it. It is one HTML file, which loads nothing from
// anywhere.
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
    std::string runout_name, volume_name;      ///< over the charts
};

/// How likely more than each of some thresholds is, and what shares of the runs do not exceed. A row of a table belongs to a
/// place. That is a pixel of PageRuns::reached that has a value, in the order of its values.
struct PageLadder {
    std::string name, label, unit;   ///< "peak_depth", "peak depth", "m"
    std::vector<double> thresholds;  ///< ascending, in `unit`
    std::size_t first = 0;           ///< of them: the page begins with it
    Raster probabilities;            ///< a column for each threshold [1]
    Raster quantiles;                ///< a column for each share of PageRuns, in `unit`; NaN: fewer runs come
};

/// What the runs of an ensemble say.
struct PageRuns {
    Raster reached;                   ///< share of the runs that come; NaN where none does
    double count = 0.0;               ///< of equal weights: their number, of which a probability is a multiple; else 0
    double effective = 0.0;           ///< number of independent runs that tell as much, for bounds of a probability
    double failed_share = 0.0;        ///< of all weights, of runs without an answer
    double shown_above = 0.01;        ///< a probability that is less is not shown
    std::optional<Vec2> start;        ///< where it flows from
    std::vector<double> shares;       ///< of the quantiles
    std::vector<PageLadder> ladders;  ///< the page begins with the first
};

/// The largest value of a scale, and whether there are values beyond.
struct PageTop {
    double high = 1.0;
    bool above = false;
};

struct WebPage {
    std::string title;
    std::string caption;                                     ///< parameters in a line
    std::vector<std::pair<std::string, std::string>> facts;  ///< "released volume", "24 300 m3"
    std::vector<std::string> remarks;
    Raster bed;
    const FlowFrames* frames = nullptr;  ///< nullptr: none are known
    std::vector<PageDrape> drapes;
    PageTop depth, speed;          ///< of the colours of frames [m], [m/s]
    std::optional<PageRuns> runs;  ///< of an ensemble, which has neither frames nor curves
    double footprint_depth = 0.1;  ///< what is thinner is not shown [m]
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
