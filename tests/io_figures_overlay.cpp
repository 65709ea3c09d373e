// The picture of two extents: which colour stands where.
#include "io_figures_scene.h"
#include "vtk_io/figures/map_figure_layout.h"
#include "vtk_io/figures/map_figure_overlay.h"
#include "vtk_io/figures/map_figure_paint.h"

using namespace frana;

namespace {

std::vector<Vec2> box(double x0, double y0, double x1, double y1) { return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}; }

/// Smallest distance to an area's colour on any ground the relief can have.
int off_area(const Colour& seen, const Colour& area) {
    int best = 255;
    for (double grey = 0.42; grey <= 0.98; grey += 0.02)
        best = std::min(best, figures::distance(seen, colour_on_ground(area, grey)));
    return best;
}

}  // namespace

TEST_CASE("Nodes inside rings: holes are outside, and a node belongs to one of two boxes that share an edge",
          "[figures]") {
    const GridGeometry grid{10, 10, 0.5, 0.5, 1.0};
    const auto count = [&](const std::vector<Polyline>& rings) {
        const std::vector<char> inside = nodes_inside(rings, grid);
        return std::count(inside.begin(), inside.end(), 1);
    };
    CHECK(count({box(2, 3, 6, 8)}) == 20);
    CHECK(count({box(2, 3, 6, 8), box(3, 4, 5, 6)}) == 16);
    CHECK(count({box(-5, -5, 50, 50)}) == 100);
    CHECK(count({box(20, 0, 30, 10)}) == 0);
    CHECK(count({box(0, 0, 4.5, 10)}) + count({box(4.5, 0, 10, 10)}) == 100);  // the edge runs through nodes
    CHECK(count({{{0, 0}, {10, 0}, {0, 10}}}) == 45);                          // below the diagonal
}

TEST_CASE("Areas of both extents, of one and of the other have the colours that the legend names", "[figures]") {
    if (figures::cannot_draw()) return;
    MapFigure figure = figures::valley();
    figure.survey = Polygons{{Polygon{{box(600, 300, 1200, 900)}}}, "", ""};
    figure.simulated = std::vector<Polyline>{box(300, 300, 900, 900)};
    const figures::Folder folder;
    std::string why_not;
    REQUIRE(render_map(figure, folder / "overlay.png", why_not));
    const Pixels picture = read_png(folder / "overlay.png");
    const MapLayout layout = lay_out(figure);
    const auto at = [&](double x, double y) {
        const Vec2 p = layout.pixel({x, y});
        return picture.at(static_cast<int>(p.x()), static_cast<int>(p.y()));
    };
    // Contours and outlines cross the areas: the most frequent colour near a place is the area's.
    const auto mostly = [&](double x, double y, const Colour& area) {
        int of_area = 0;
        for (double dx = -60; dx <= 60; dx += 20)
            for (double dy = -60; dy <= 60; dy += 20) of_area += off_area(at(x + dx, y + dy), area) <= 6;
        return of_area > 40;  // of 49
    };
    CHECK(mostly(750, 600, colours::hit));
    CHECK(mostly(450, 600, colours::beyond));
    CHECK(mostly(1050, 600, colours::missed));
    CHECK(figures::saturation(at(1600, 150)) < 40);
    for (const Colour& area : {colours::hit, colours::beyond, colours::missed})
        CHECK(figures::count(picture, area, 2) > 100);  // its box in the legend, free of relief
}

TEST_CASE("The three areas differ in grey by a tenth of the scale at least", "[figures]") {
    const double hit = brightness(colours::hit), beyond = brightness(colours::beyond),
                 missed = brightness(colours::missed);
    CHECK(hit - missed > 0.1);
    CHECK(beyond - hit > 0.1);
}

TEST_CASE("Classes of places have the colours that the legend names, for whole pixels", "[figures]") {
    if (figures::cannot_draw()) return;
    MapFigure figure = figures::valley();
    figure.classes = {{"low", {255, 221, 0, 255}}, {"high", {216, 30, 40, 255}}};
    const GridGeometry& g = figure.bed.geometry;
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i)
            figure.field[static_cast<std::size_t>(j * g.nx + i)] = g.x(i) > 900 ? 2.0 : g.x(i) > 300 ? 1.0 : 0.0;
    const figures::Folder folder;
    std::string why_not;
    REQUIRE(render_map(figure, folder / "classes.png", why_not));
    const Pixels picture = read_png(folder / "classes.png");
    const MapLayout layout = lay_out(figure);
    const auto share = [&](double x, const Colour& area) {  // along a line up the map; contours cross it
        int of_area = 0, all = 0;
        for (double y = 300; y <= 900; y += 10, ++all) {
            const Vec2 p = layout.pixel({x, y});
            of_area += off_area(picture.at(static_cast<int>(p.x()), static_cast<int>(p.y())), area) <= 6;
        }
        return static_cast<double>(of_area) / all;
    };
    CHECK(share(600, figure.classes[0].colour) > 0.8);
    CHECK(share(1200, figure.classes[1].colour) > 0.8);
    CHECK(share(600, figure.classes[1].colour) < 0.1);
    // Between two nodes one colour gives way to the other, without those between.
    const double edge = 900.0 + 0.5 * g.cell;
    CHECK(share(edge - 0.4 * g.cell, figure.classes[0].colour) + share(edge - 0.4 * g.cell, figure.classes[1].colour) >
          0.8);
    for (const MapClass& one : figure.classes) CHECK(figures::count(picture, one.colour, 2) > 100);  // in the legend
}
