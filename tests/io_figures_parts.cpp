// The parts figures are made of: round numbers, relief, level lines, clipping.
#include "catch.h"
#include "vtk_io/figures/canvas.h"
#include "vtk_io/figures/chart_figure_ticks.h"
#include "vtk_io/figures/map_figure_layout.h"
#include "vtk_io/hillshade.h"
#include "vtk_io/level_lines.h"

using namespace frana;

namespace {

Raster plane(Index nx, Index ny, double cell, double east, double north) {
    Raster raster = Raster::filled(GridGeometry{nx, ny, 100.0, 200.0, cell}, 0.0);
    for (Index j = 0; j < ny; ++j)
        for (Index i = 0; i < nx; ++i)
            raster.at(i, j) = 50.0 + east * raster.geometry.x(i) + north * raster.geometry.y(j);
    return raster;
}

}  // namespace

TEST_CASE("Ticks are multiples of 1, 2 or 5 within the range", "[figures]") {
    const Ticks ticks = ticks_between(0.0, 1.0, 6);
    CHECK(ticks.labels == std::vector<std::string>{"0.0", "0.2", "0.4", "0.6", "0.8", "1.0"});
    CHECK(ticks_between(408391.0, 410695.0, 5).labels ==
          std::vector<std::string>{"408500", "409000", "409500", "410000", "410500"});
    CHECK(ticks_between(-30.0, 30.0, 7).labels == std::vector<std::string>{"-30", "-20", "-10", "0", "10", "20", "30"});
    CHECK(ticks_between(1.0, 1.0, 5).at.empty());
    CHECK(log_ticks(1e-4, 1e2, 9).labels == std::vector<std::string>{"1e-4", "0.001", "0.01", "0.1", "1", "10", "100"});
    CHECK(round_down_125(0.3) == Approx(0.2));
    CHECK(round_up_125(36.0) == Approx(50.0));
    CHECK(round_limit(4.01) == Approx(5.0));
    CHECK(round_limit(0.012) == Approx(0.012));
    CHECK(length_text(1500.0) == "1.5 km");
    CHECK(name_and_unit("peak depth [m]") == std::make_pair(std::string("peak depth"), std::string("m")));
}

TEST_CASE("The colour range leaves the largest half per cent to the tip of the bar", "[figures]") {
    std::vector<double> field(1000, 2.9);
    field[7] = 40.0;
    const ColourRange range = colour_range(field, 0.1, Colormap::depth, std::nullopt);
    CHECK(range.low == 0.0);
    CHECK(range.high == Approx(3.0));
    CHECK(range.more_above);
    CHECK_FALSE(range.more_below);
    field.assign(1000, -1.9);
    const ColourRange signed_range = colour_range(field, 0.1, Colormap::diverging, std::nullopt);
    CHECK(signed_range.low == Approx(-2.0));
    CHECK(signed_range.high == Approx(2.0));
    CHECK_FALSE(signed_range.more_below);
}

TEST_CASE("A thick release leaves the colours of the runout, and the bar says how thick it is", "[figures]") {
    std::vector<double> field(1000, 20.0);
    std::fill(field.begin(), field.begin() + 100, 200.0);  // a tenth of the flow: more than the tip of the bar
    const ColourRange range = colour_range(field, 0.1, Colormap::depth, std::nullopt, Top::flow);
    CHECK(range.high == Approx(60.0));
    CHECK(range.more_above);
    CHECK(range.most == 200.0);
    for (std::size_t i = 0; i < field.size(); ++i) field[i] = 0.2 + 0.005 * static_cast<double>(i);  // even, to 5.2
    CHECK(colour_range(field, 0.1, Colormap::depth, std::nullopt, Top::flow).high >= 5.17);  // the 99.5th percentile
}

TEST_CASE("A deep deposit leaves its colours to what the flow eroded", "[figures]") {
    std::vector<double> field(1000, -0.3);
    std::fill(field.begin(), field.begin() + 50, 6.0);
    const ColourRange range = colour_range(field, 0.0, Colormap::diverging, std::nullopt, Top::flow);
    CHECK(range.high == Approx(1.0));  // 0.9, rounded up
    CHECK(range.low == -range.high);
    CHECK((range.more_above && range.most == 6.0));
}

TEST_CASE("All colour maps run evenly from light to dark or through light", "[figures]") {
    for (double t = 0.0; t < 1.0; t += 0.02)
        CHECK(brightness(colour_at(Colormap::depth, t + 0.02)) < brightness(colour_at(Colormap::depth, t)));
    for (double t = 0.0; t < 1.0; t += 0.02) {
        CHECK(brightness(colour_at(Colormap::speed, t + 0.02)) > brightness(colour_at(Colormap::speed, t)));
        CHECK(brightness(colour_at(Colormap::pressure, t + 0.02)) < brightness(colour_at(Colormap::pressure, t)));
    }
    CHECK(brightness(colour_at(Colormap::diverging, 0.5)) > brightness(colour_at(Colormap::diverging, 0.1)));
    CHECK(brightness(colour_at(Colormap::diverging, 0.5)) > brightness(colour_at(Colormap::diverging, 0.9)));
}

TEST_CASE("Level ground is lit by the sine of the lamps' height, and slopes to the lamps more", "[figures]") {
    const auto shade = [](double east, double north) {
        return static_cast<double>(hillshade(plane(5, 5, 1.0, east, north), 1.0)[12]);
    };
    CHECK(shade(0.0, 0.0) == Approx(std::sqrt(0.5)).margin(1e-6));  // single precision
    CHECK(shade(0.5, -0.5) > 0.85);                                 // falls to the north-west
    CHECK(shade(-0.5, 0.5) < 0.4);                                  // falls to the south-east
}

TEST_CASE("Resampling keeps a plane, also to the outer edge of the pixels, and leaves nodata out", "[figures]") {
    Raster raster = plane(20, 15, 10.0, 0.3, -0.2);
    GridGeometry fine{80, 60, 0.0, 0.0, 2.5};
    fine.x0 = raster.geometry.x0 - 5.0 + 1.25;
    fine.y0 = raster.geometry.y0 - 5.0 + 1.25;
    const Raster smooth = resampled(raster, fine, Between::smooth);
    double worst = 0.0;
    for (Index j = 0; j < fine.ny; ++j)
        for (Index i = 0; i < fine.nx; ++i)
            worst = std::max(worst, std::abs(smooth.at(i, j) - (50.0 + 0.3 * fine.x(i) - 0.2 * fine.y(j))));
    CHECK(worst < 1e-10);  // round-off of values near 100

    raster.at(10, 7) = Raster::nodata;
    const Raster holed = resampled(raster, fine, Between::smooth);
    int missing = 0;
    for (const double value : holed.values) missing += std::isnan(value);
    CHECK(missing == 16);  // the pixel of the node, 4 x 4 of the fine ones

    const GridGeometry coarse{4, 3, raster.geometry.x0 + 20.0, raster.geometry.y0 + 20.0, 50.0};
    const Raster means = resampled(plane(20, 15, 10.0, 0.3, -0.2), coarse, Between::linear);
    CHECK(means.at(1, 1) == Approx(50.0 + 0.3 * coarse.x(1) - 0.2 * coarse.y(1)).epsilon(1e-12));
}

TEST_CASE("The level line of a plane is one straight line at the level", "[figures]") {
    const Raster raster = plane(20, 15, 10.0, 0.3, 0.0);
    const double level = 50.0 + 0.3 * 163.0;
    const auto lines = level_lines(raster, level);
    REQUIRE(lines.size() == 1);
    for (const Vec2& p : lines[0]) CHECK(p.x() == Approx(163.0).margin(1e-4));  // node numbers in single precision
    CHECK(std::abs(lines[0].front().y() - lines[0].back().y()) == Approx(140.0));
    CHECK(level_lines(raster, 1e6).empty());
    Raster holed = raster;
    holed.at(6, 7) = Raster::nodata;
    for (const auto& line : level_lines(holed, level))
        for (const Vec2& p : line) CHECK(p.allFinite());
}

TEST_CASE("Clipping cuts lines at the window and keeps the order of the pieces", "[figures]") {
    const Rectangle window{0.0, 0.0, 10.0, 10.0};
    const auto pieces = clipped({{-5, 5}, {5, 5}, {5, 15}, {8, 15}, {8, 5}}, window);
    REQUIRE(pieces.size() == 2);
    CHECK(pieces[0] == std::vector<Vec2>{{0, 5}, {5, 5}, {5, 10}});
    CHECK(pieces[1] == std::vector<Vec2>{{8, 10}, {8, 5}});
    CHECK(clipped({{-5, -5}, {-1, 20}}, window).empty());
}

TEST_CASE("A label is set along the straight part of its line, and the line is cut there", "[figures]") {
    std::vector<Vec2> line;
    for (int i = 0; i <= 300; ++i) line.emplace_back(i, 0.5 * i);
    const auto parts = with_label(line, 40.0, [](const Vec2&) { return true; });
    CHECK(parts.labelled);
    CHECK(parts.angle == Approx(std::atan(0.5) * 180.0 / 3.14159265358979).margin(1e-6));
    REQUIRE(parts.pieces.size() == 2);
    CHECK((parts.pieces[1].front() - parts.pieces[0].back()).norm() == Approx(40.0).epsilon(1e-9));
    CHECK_FALSE(with_label(line, 40.0, [](const Vec2&) { return false; }).labelled);
    CHECK_FALSE(with_label(line, 400.0, [](const Vec2&) { return true; }).labelled);
}

TEST_CASE("Items go into rows no wider than the picture", "[figures]") {
    const Rows rows = in_rows({40.0, 40.0, 40.0, 200.0}, 10.0, 100.0);
    CHECK(rows.count == 3);
    CHECK(rows.places[1] == std::make_pair(50.0, 0));
    CHECK(rows.places[2] == std::make_pair(0.0, 1));
    CHECK(rows.places[3] == std::make_pair(0.0, 2));
}
