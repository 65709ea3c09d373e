#pragma once
// Curves over a common abscissa in one panel or several, ready for a paper.
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace frana {

/// One curve; a NaN breaks it.
struct Curve {
    enum class Kind {
        line,
        ground,  ///< terrain: filled below, black; drawn before the lines
        water,   ///< a surface on the terrain: the space down to the ground is tinted in the curve's colour
    };
    std::string name;
    std::vector<double> x, y;
    Kind kind = Kind::line;
    bool marks = false;  ///< a disc at each point of the line
};

struct ChartPanel {
    std::string y_label;  ///< with unit: "depth [m]"
    std::vector<Curve> curves;
    bool log_y = false;                                ///< values <= 0 are left out
    std::optional<std::pair<double, double>> y_range;  ///< default: from the curves
    double share = 1.0;                                ///< of the height, relative to the other panels
};

struct ChartFigure {
    std::string title;
    std::string x_label;  ///< with unit: "time [s]"
    bool log_x = false;
    std::optional<std::pair<double, double>> x_range;
    std::vector<ChartPanel> panels;
    std::string footer;
    int width = 1400;  ///< [px]
    int height = 900;  ///< [px]
};

/// Draws the panels one above the other into a PNG of width x height. Curves differ by colour (safe for the
/// colour-blind) and by dashes (readable in grey), the same in all panels. Each panel has its legend above. False with
/// a reason when pictures are switched off (no file is made); UserError when the file cannot be written.
bool render_chart(const ChartFigure& figure, const std::filesystem::path& png, std::string& why_not);

}  // namespace frana
