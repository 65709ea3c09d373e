#pragma once
// What the tests of the figures share: a valley with a deposit, a folder of their own, questions to a
// picture.
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "catch.h"
#include "vtk_io/figures/map_figure.h"
#include "vtk_io/figures/offscreen.h"
#include "vtk_io/figures/png_file.h"

namespace figures {

/// Says so and answers true where no picture can be made, so that the test can stop.
inline bool cannot_draw() {
    const std::string reason = frana::no_renderer_reason();
    if (!reason.empty()) WARN("no pictures here (" << reason << "); this test is skipped");
    return !reason.empty();
}

/// A fresh folder, removed at the end.
class Folder {
public:
    Folder() {
        static int number = 0;
        path_ = std::filesystem::temp_directory_path() /
                ("frana_figures_" + std::to_string(::getpid()) + "_" + std::to_string(number++));
        std::filesystem::create_directories(path_);
    }
    ~Folder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
    std::ptrdiff_t files() const {
        return std::distance(std::filesystem::directory_iterator(path_), std::filesystem::directory_iterator());
    }

private:
    std::filesystem::path path_;
};

inline const frana::Vec2 deposit(1400.0, 1150.0);  ///< its middle: in the north-east of the valley [m]
constexpr double kDeepest = 4.0;                   ///< there [m]
constexpr double kWidth = 150.0;                   ///< its standard deviation times sqrt(2) [m]

/// 2000 x 1600 m in 10 m cells: a valley that falls to the south with a round deposit.
inline frana::MapFigure valley() {
    using namespace frana;
    MapFigure figure;
    figure.bed = Raster::filled(GridGeometry{200, 160, 5.0, 5.0, 10.0}, 0.0);
    const GridGeometry& g = figure.bed.geometry;
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) {
            const double across = (g.x(i) - 1000.0) / 1000.0;
            figure.bed.at(i, j) = 300.0 + 0.2 * g.y(j) + 200.0 * across * across;
            const double r = (Vec2(g.x(i), g.y(j)) - deposit).norm() / kWidth;
            figure.field.push_back(kDeepest * std::exp(-r * r));
        }
    figure.focus = g.pixel_extent();
    figure.range = {0.0, 5.0};
    figure.title = "Valley";
    figure.footer = "a test";
    figure.width = 900;
    figure.height = 800;
    return figure;
}

/// Largest difference of a channel.
inline int distance(const frana::Colour& a, const frana::Colour& b) {
    return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
}

/// Grey, white and black have none.
inline int saturation(const frana::Colour& c) { return std::max({c.r, c.g, c.b}) - std::min({c.r, c.g, c.b}); }

/// Number of pixels within `tolerance` of the colour.
inline int count(const frana::Pixels& picture, const frana::Colour& colour, int tolerance) {
    int found = 0;
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) found += distance(picture.at(x, y), colour) <= tolerance;
    return found;
}

}  // namespace figures
