// Charts and perspective views.
#include "io_figures_scene.h"
#include "vtk_io/figures/chart_figure.h"
#include "vtk_io/figures/map_figure_perspective.h"
#include "vtk_io/figures/png_file.h"

using namespace frana;
using figures::cannot_draw;

namespace {

/// Two panels: constants 1 and 1.5 on [0, 2], and a gap in a third curve.
ChartFigure two_panels() {
    ChartFigure chart;
    chart.title = "Panels";
    chart.x_label = "time [s]";
    chart.width = 800;
    chart.height = 600;
    Curve one{"one", {0.0, 5.0, 10.0}, {1.0, 1.0, 1.0}, Curve::Kind::line};
    Curve more{"one and a half", {0.0, 5.0, 10.0}, {1.5, 1.5, 1.5}, Curve::Kind::line};
    Curve broken{"broken", {0, 1, 2, 3, 8, 9, 10}, {1, 1, 1, std::nan(""), 1, 1, 1}, Curve::Kind::line};
    chart.panels = {{"depth [m]", {one, more}, false, std::make_pair(0.0, 2.0), 1.0},
                    {"speed [m/s]", {broken}, false, std::make_pair(0.0, 2.0), 1.0}};
    return chart;
}

Pixels drawn(const ChartFigure& figure) {
    const figures::Folder folder;
    std::string why_not;
    REQUIRE(render_chart(figure, folder / "chart.png", why_not));
    return read_png(folder / "chart.png");
}

/// Rows that are black over most of their length: the frames of the panels, lowest first.
std::vector<int> black_rows(const Pixels& picture) {
    std::vector<int> rows;
    for (int y = 0; y < picture.height; ++y) {
        int black = 0;
        for (int x = 0; x < picture.width; ++x) black += figures::distance(picture.at(x, y), colours::black) < 100;
        if (black > 0.7 * picture.width && (rows.empty() || y > rows.back() + 3)) rows.push_back(y);
    }
    return rows;
}

int in_row(const Pixels& picture, int y, const Colour& colour) {
    int found = 0;
    for (int x = 0; x < picture.width; ++x) found += figures::distance(picture.at(x, y), colour) < 70;
    return found;
}

/// The most pixels of a colour in one row within two of `y`: lines do not fall on whole rows.
int near_row(const Pixels& picture, double y, const Colour& colour) {
    int found = 0;
    for (int dy = -2; dy <= 2; ++dy)
        found = std::max(found, in_row(picture, static_cast<int>(std::lround(y)) + dy, colour));
    return found;
}

}  // namespace

TEST_CASE("Curves of a chart stand at their values in their colours, and a NaN breaks them", "[figures]") {
    if (cannot_draw()) return;
    const Pixels picture = drawn(two_panels());
    CHECK(picture.width == 800);
    CHECK(picture.height == 600);
    const auto rows = black_rows(picture);
    REQUIRE(rows.size() == 4);
    const int lower = rows[1] - rows[0], upper = rows[3] - rows[2];
    // 600 to 750 of the 800 columns belong to the frame; a line 1.9 px wide fills at least one row
    CHECK(near_row(picture, rows[2] + 0.5 * upper, curve_colour(0)) > 500);
    CHECK(near_row(picture, rows[2] + 0.6 * upper, curve_colour(0)) == 0);
    const int dashed = near_row(picture, rows[2] + 0.75 * upper, curve_colour(1));
    CHECK(dashed > 300);
    CHECK(dashed < 600);
    const int broken = near_row(picture, rows[0] + 0.5 * lower, curve_colour(0));
    CHECK(broken > 200);  // 4 of 10 s are drawn
    CHECK(broken < 400);
}

TEST_CASE("Terrain in a chart is filled and a logarithmic axis spaces decades evenly", "[figures]") {
    if (cannot_draw()) return;
    ChartFigure chart = two_panels();
    Curve ground{"terrain", {0.0, 10.0}, {1.0, 1.0}, Curve::Kind::ground};
    Curve surface{"surface", {0.0, 10.0}, {1.5, 1.5}, Curve::Kind::water};
    Curve decade{"decade", {0.0, 10.0}, {1e-3, 1e-3}, Curve::Kind::line};
    chart.panels = {{"elevation [m]", {ground, surface}, false, std::make_pair(0.0, 2.0), 1.0},
                    {"error [1]", {decade}, true, std::make_pair(1e-4, 1e-1), 1.0}};
    const Pixels picture = drawn(chart);
    const auto rows = black_rows(picture);
    REQUIRE(rows.size() >= 4);
    const int upper = rows.back() - rows[2];
    CHECK(in_row(picture, rows[2] + upper / 4, colours::ground) > 500);
    CHECK(in_row(picture, rows[2] + upper * 5 / 8, mixed(colours::white, curve_colour(0), 0.3)) > 500);
    CHECK(near_row(picture, rows[0] + (rows[1] - rows[0]) / 3.0, curve_colour(0)) > 500);
}

TEST_CASE("Empty, constant, huge and non-positive curves still make a chart", "[figures]") {
    if (cannot_draw()) return;
    for (const bool log : {false, true})
        for (const std::vector<double>& y : {std::vector<double>{},
                                             {0.0, 0.0},
                                             {-1.0, -2.0},
                                             {1e12, 2e12},
                                             {3.0, 3.0},
                                             {1e-18, 1.0},
                                             {std::nan(""), std::nan("")}}) {
            ChartFigure chart = two_panels();
            chart.width = 500;
            chart.height = 300;
            Curve curve{"curve", {}, y, Curve::Kind::line};
            for (std::size_t i = 0; i < y.size(); ++i) curve.x.push_back(static_cast<double>(i));
            chart.panels = {{"quantity", {curve}, log, std::nullopt, 1.0}};
            INFO("log " << log << ", values " << y.size() << " " << (y.empty() ? 0.0 : y[0]));
            CHECK(black_rows(drawn(chart)).size() >= 2);
        }
}

TEST_CASE("A perspective view has its size, the deposit's colours and white corners", "[figures]") {
    if (cannot_draw()) return;
    const MapFigure map = figures::valley();
    PerspectiveFigure figure;
    figure.bed = map.bed;
    figure.field = map.field;
    figure.range = map.range;
    figure.title = "Valley";
    figure.width = 800;
    figure.height = 600;
    const figures::Folder folder;
    std::string why_not;
    REQUIRE(render_perspective(figure, folder / "view.png", why_not));
    const Pixels picture = read_png(folder / "view.png");
    CHECK(picture.width == 800);
    CHECK(picture.height == 600);
    int coloured = 0;
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < 600; ++x) coloured += figures::saturation(picture.at(x, y)) > 60;
    CHECK(coloured > 0.03 * 800 * 600);  // the deposit fills the picture, not a dot in it
    for (const int x : {0, 799})
        for (const int y : {0, 599}) CHECK(figures::distance(picture.at(x, y), colours::white) == 0);
}

TEST_CASE("Without a renderer charts and views are refused with a reason and leave no file", "[figures]") {
    const figures::Folder folder;
    const MapFigure map = figures::valley();
    PerspectiveFigure view;
    view.bed = map.bed;
    view.field = map.field;
    std::string chart_reason, view_reason;
    ::setenv("FRANA_NO_RENDER", "1", 1);
    const bool chart = render_chart(two_panels(), folder / "chart.png", chart_reason);
    const bool viewed = render_perspective(view, folder / "view.png", view_reason);
    ::unsetenv("FRANA_NO_RENDER");
    CHECK_FALSE(chart);
    CHECK_FALSE(viewed);
    CHECK(chart_reason == "FRANA_NO_RENDER is set");
    CHECK(view_reason == "FRANA_NO_RENDER is set");
    CHECK(folder.files() == 0);
}

TEST_CASE("A picture comes back from its PNG as it was, whatever its shape", "[figures]") {
    const figures::Folder folder;
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 7}, {9, 1}, {64, 48}}) {
        Pixels picture(width, height);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                picture.set(x, y, {static_cast<std::uint8_t>(37 * x + y * y), static_cast<std::uint8_t>(x * y), 200});
        const std::filesystem::path png = folder / "picture.png";
        write_png(picture, png);
        const Pixels found = read_png(png);
        CAPTURE(width, height);
        CHECK(found.width == width);
        CHECK(found.height == height);
        CHECK(found.rgb == picture.rgb);
    }
    CHECK_THROWS_WITH(write_png(Pixels(0, 5), folder / "none.png"),
                      Catch::Matchers::Contains("none.png: libpng could not"));
    CHECK(folder.files() == 1);
}
