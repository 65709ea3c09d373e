// Maps: what is drawn, where, in which colour, and what happens when nothing can be drawn.
#include "io_figures_scene.h"
#include "small_disk.h"
#include "vtk_io/figures/filmstrip.h"
#include "vtk_io/figures/map_figure_layout.h"
#include "vtk_io/figures/map_figure_paint.h"

#include <fmt/core.h>

#include <fstream>
#include <set>

#include "base/error.h"

using namespace frana;
using figures::cannot_draw;

namespace {

Pixels drawn(const MapFigure& figure) {
    const figures::Folder folder;
    std::string why_not;
    const bool done = render_map(figure, folder / "map.png", why_not);
    INFO(why_not);
    REQUIRE(done);
    CHECK(folder.files() == 1);  // nothing temporary is left
    return read_png(folder / "map.png");
}

Colour at(const Pixels& picture, const Vec2& pixel) {
    return picture.at(static_cast<int>(pixel.x()), static_cast<int>(pixel.y()));
}

/// Smallest distance of a pixel to the colour of a value on any ground the relief can have.
int off_colour(const Colour& seen, double value, const MapFigure& figure) {
    const FieldStyle style{
        figure.colormap, {figure.range->first, figure.range->second, false, false}, figure.shown_above, 0.0};
    int best = 255;
    for (double grey = 0.42; grey <= 0.98; grey += 0.02)
        best = std::min(best, figures::distance(seen, on_ground(value, grey, style)));
    return best;
}

/// Middle of the coloured pixels inside a part of the picture.
Vec2 middle_of_colour(const Pixels& picture, const Rectangle& part) {
    Vec2 sum(0, 0);
    double weight = 0.0;
    for (int y = static_cast<int>(part.y0); y < static_cast<int>(part.y1); ++y)
        for (int x = static_cast<int>(part.x0); x < static_cast<int>(part.x1); ++x) {
            if (figures::saturation(picture.at(x, y)) < 60) continue;
            sum += Vec2(x + 0.5, y + 0.5);
            weight += 1.0;
        }
    REQUIRE(weight > 100.0);
    return sum / weight;
}

double resident_megabytes() {
    std::ifstream statm("/proc/self/statm");
    double total = 0.0, resident = 0.0;
    statm >> total >> resident;
    return resident * static_cast<double>(::sysconf(_SC_PAGESIZE)) / 1048576.0;
}

}  // namespace

TEST_CASE("A map has the requested size, and the deposit lies north and east where it is", "[figures]") {
    if (cannot_draw()) return;
    MapFigure figure = figures::valley();
    const Pixels picture = drawn(figure);
    CHECK(picture.width == figure.width);
    CHECK(picture.height == figure.height);

    const MapLayout layout = lay_out(figure);
    const Vec2 seen = middle_of_colour(picture, layout.frame);
    // the frame shows 2000 x 1600 m: the deposit's middle as a share of it, without asking the layout
    const Vec2 share((seen.x() - layout.frame.x0) / layout.frame.width(),
                     (seen.y() - layout.frame.y0) / layout.frame.height());
    const double tolerance = 0.01;  // contours on top of the colour take away pixels, not symmetrically
    CHECK(share.x() == Approx(figures::deposit.x() / 2000.0).margin(tolerance));
    CHECK(share.y() == Approx(figures::deposit.y() / 1600.0).margin(tolerance));
}

TEST_CASE("The colour at a map position is that of the value there", "[figures]") {
    if (cannot_draw()) return;
    const MapFigure figure = figures::valley();
    const Pixels picture = drawn(figure);
    const MapLayout layout = lay_out(figure);
    for (const double r : {0.0, 0.4, 0.8, 1.2}) {  // in widths of the deposit, to the west-south-west
        const Vec2 place = figures::deposit - figures::kWidth * r * Vec2(0.8, 0.6);
        const double value = figures::kDeepest * std::exp(-r * r);
        int best = 255;  // a contour line may cross one of the pixels
        for (int dx = -3; dx <= 3; ++dx)
            best = std::min(best, off_colour(at(picture, layout.pixel(place) + Vec2(dx, 0)), value, figure));
        INFO("at " << r << " widths, value " << value << " m");
        CHECK(best <= 8);  // half a pixel of the gradient and the rounding of the picture
        CHECK(off_colour(at(picture, layout.pixel(place)), value + 1.5, figure) > 8);  // the measure can tell
    }
    const Vec2 dry = layout.pixel({300.0, 300.0});
    CHECK(figures::saturation(at(picture, dry)) < 40);
    CHECK(brightness(at(picture, dry)) > 0.35);
}

TEST_CASE("The colour bar runs from the first to the last colour next to the map", "[figures]") {
    if (cannot_draw()) return;
    const MapFigure figure = figures::valley();
    const Pixels picture = drawn(figure);
    const Rectangle frame = lay_out(figure).frame;
    const auto mid = [](double a, double b) { return static_cast<int>(0.5 * (a + b)); };
    int x = static_cast<int>(frame.x1) + 4;
    while (x < picture.width && figures::saturation(picture.at(x, mid(frame.y0, frame.y1))) < 40) ++x;
    REQUIRE(x + 4 < picture.width);
    x += 4;
    for (const double t : {0.02, 0.25, 0.5, 0.75, 0.98}) {
        const int y = static_cast<int>(frame.y0 + t * frame.height());
        CHECK(figures::distance(picture.at(x, y), colour_at(Colormap::depth, t)) <= 6);  // one pixel of the bar
    }
}

TEST_CASE("The surveyed outline is drawn on its line and nowhere else", "[figures]") {
    if (cannot_draw()) return;
    MapFigure figure = figures::valley();
    figure.survey = Polygons{{Polygon{{{{400, 300}, {800, 300}, {800, 700}, {400, 700}}}}}, "", ""};
    const Pixels picture = drawn(figure);
    const MapLayout layout = lay_out(figure);
    for (const Vec2& on : {Vec2(600, 300), Vec2(800, 500), Vec2(600, 700), Vec2(400, 500)})
        CHECK(figures::distance(at(picture, layout.pixel(on)), colours::survey) <= 10);
    for (const Vec2& off : {Vec2(600, 500), Vec2(900, 500), Vec2(600, 200)})
        CHECK(figures::saturation(at(picture, layout.pixel(off))) < 40);

    figure.survey.reset();
    CHECK(figures::count(picture, colours::survey, 3) > 200);
    CHECK(figures::count(drawn(figure), colours::survey, 3) == 0);
}

TEST_CASE("Barriers are drawn on their lines, and a few of them by name", "[figures]") {
    if (cannot_draw()) return;
    MapFigure figure = figures::valley();
    const Polyline house{{400, 300}, {800, 300}, {800, 700}, {400, 700}, {400, 300}};
    figure.barriers = {{"house", house}, {"dam", {{1000, 300}, {1000, 700}}}};
    const Pixels picture = drawn(figure);
    const MapLayout layout = lay_out(figure);
    for (const Vec2& on : {Vec2(600, 300), Vec2(800, 500), Vec2(600, 700), Vec2(400, 500), Vec2(1000, 500)})
        CHECK(figures::distance(at(picture, layout.pixel(on)), colours::barrier) <= 10);
    for (const Vec2& off : {Vec2(600, 500), Vec2(900, 500), Vec2(600, 200)})
        CHECK(figures::saturation(at(picture, layout.pixel(off))) < 40);
    CHECK(std::count_if(layout.legend.begin(), layout.legend.end(),
                        [](const LegendEntry& e) { return e.text == "barrier"; }) == 1);

    // The name of a wall stands right of its middle, on a white box.
    const auto white_at_name = [&](const MapFigure& of) {
        const Vec2 start = lay_out(of).pixel({1000, 500});
        const Pixels seen = drawn(of);
        int white = 0;
        for (int dx = 20; dx < 60; ++dx)
            for (int dy = -8; dy <= 8; ++dy) white += brightness(at(seen, start + Vec2(dx, dy))) > 0.93;
        return white;
    };
    const int named = white_at_name(figure);
    for (int n = 0; n < 5; ++n) figure.barriers.push_back({"far " + std::to_string(n), {{1900, 100}, {1950, 100}}});
    CHECK(named > white_at_name(figure) + 100);
}

TEST_CASE("Houses are numbered where they are too many for names, up to 29", "[figures]") {
    if (cannot_draw()) return;
    // The texts of eight houses and of the same houses without numbers differ right of each, and of thirty nowhere.
    const auto village = [](int count, const std::string& name) {
        MapFigure figure = figures::valley();
        for (int n = 0; n < count; ++n) {
            const double x = 200.0 + 150.0 * (n % 8), y = 200.0 + 150.0 * (n / 8);
            figure.barriers.push_back({name + std::to_string(n + 1), {{x, y}, {x + 40, y}, {x + 40, y + 40}, {x, y}}});
        }
        return figure;
    };
    const auto differ_right_of = [&](int count, int house) {
        const MapFigure with = village(count, "houses_"), without = village(count, "houses");
        const Pixels one = drawn(with), other = drawn(without);
        const Vec2 corner = lay_out(with).pixel({240.0 + 150.0 * (house % 8), 220.0 + 150.0 * (house / 8)});
        int different = 0;
        for (int dx = 5; dx < 30; ++dx)
            for (int dy = -8; dy <= 8; ++dy) {
                const Vec2 p = corner + Vec2(dx, dy);
                different += figures::distance(at(one, p), at(other, p)) > 60;
            }
        return different;
    };
    for (const int house : {0, 7, 28}) CHECK(differ_right_of(29, house) > 10);
    CHECK(differ_right_of(30, 0) == 0);
}

TEST_CASE("Lines have the pen of their kind, and the name stands at its own line", "[figures]") {
    if (cannot_draw()) return;
    MapFigure figure = figures::valley();
    // A bundle of three that begin at one place: names at their beginnings would be a heap.
    figure.lines = {{"a", {{300, 300}, {900, 300}}, MapLine::profile},
                    {"b", {{300, 310}, {900, 700}}, MapLine::section},
                    {"c", {{300, 320}, {300, 1000}}, MapLine::inflow}};
    const MapLayout layout = lay_out(figure);
    for (const char* kind : {"profile", "section", "inflow"})
        CHECK(std::count_if(layout.legend.begin(), layout.legend.end(),
                            [&](const LegendEntry& e) { return e.text == kind; }) == 1);
    std::set<std::vector<double>> dashes;
    for (const LegendEntry& entry : layout.legend)
        if (entry.kind == LegendEntry::Kind::cased_line) dashes.insert(entry.pen.dash);
    CHECK(dashes.size() == 3);
    // Each name's box is where the picture without names differs: near the middle of its line.
    MapFigure nameless = figure;
    for (NamedLine& line : nameless.lines) line.name = " ";
    const Pixels with = drawn(figure), without = drawn(nameless);
    for (const NamedLine& line : figure.lines) {
        CAPTURE(line.name);
        const Vec2 middle = layout.pixel(0.5 * (line.line.front() + line.line.back()));
        int different = 0;
        for (int dx = -40; dx <= 40; ++dx)
            for (int dy = -30; dy <= 30; ++dy) {
                const Vec2 p = middle + Vec2(dx, dy);
                different += figures::distance(at(with, p), at(without, p)) > 60;
            }
        CHECK(different > 10);
    }
}

TEST_CASE("No name stands on an adjacent house", "[figures]") {
    if (cannot_draw()) return;
    MapFigure figure = figures::valley();
    const auto house = [](double x, double y) {
        return Polyline{{x, y}, {x + 40, y}, {x + 40, y + 40}, {x, y + 40}, {x, y}};
    };
    figure.barriers = {{"the mill of the valley", house(600, 480)}, {"b", house(700, 480)}, {"c", house(720, 560)}};
    const Pixels picture = drawn(figure);
    const MapLayout layout = lay_out(figure);
    for (const Vec2& west : {Vec2(600, 500), Vec2(700, 500), Vec2(720, 580)})
        for (const Vec2& on : {west, Vec2(west + Vec2(40, 0)), Vec2(west + Vec2(20, 20)), Vec2(west + Vec2(20, -20))})
            CHECK(figures::distance(at(picture, layout.pixel(on)), colours::barrier) <= 10);
}

TEST_CASE("Terrain without data is plain light grey", "[figures]") {
    if (cannot_draw()) return;
    MapFigure figure = figures::valley();
    for (Index j = 0; j < 60; ++j)
        for (Index i = 0; i < 60; ++i) figure.bed.at(i, j) = Raster::nodata;
    const Pixels picture = drawn(figure);
    const MapLayout layout = lay_out(figure);
    for (const Vec2& place : {Vec2(100, 100), Vec2(300, 300), Vec2(560, 560), Vec2(40, 560)})
        CHECK(figures::distance(at(picture, layout.pixel(place)), colours::no_data) == 0);
    CHECK(figures::distance(at(picture, layout.pixel({700, 700})), colours::no_data) > 0);
}

TEST_CASE("Small, large, narrow, dry, even and empty terrain all make a map", "[figures]") {
    if (cannot_draw()) return;
    struct Shape {
        Index nx, ny;
        double cell, slope;
        bool wet, data;
    };
    for (const Shape& shape :
         {Shape{2, 2, 1.0, 0.1, true, true}, Shape{87, 61, 10.0, 0.2, true, true}, Shape{300, 40, 0.5, 0.5, true, true},
          Shape{40, 300, 0.5, 0.5, true, true}, Shape{500, 5, 1.0, 0.1, true, true},
          Shape{1500, 1200, 2.0, 0.3, true, true}, Shape{50, 50, 1.0, 0.2, false, true},
          Shape{50, 50, 1.0, 0.0, true, true}, Shape{50, 50, 1.0, 0.0, false, false}}) {
        MapFigure figure;
        figure.width = 700;
        figure.height = 600;
        figure.bed = Raster::filled(GridGeometry{shape.nx, shape.ny, 0.0, 0.0, shape.cell}, Raster::nodata);
        const GridGeometry& g = figure.bed.geometry;
        for (Index j = 0; j < g.ny; ++j)
            for (Index i = 0; i < g.nx; ++i) {
                if (shape.data) figure.bed.at(i, j) = shape.slope * (g.x(i) + g.y(j));
                figure.field.push_back(shape.wet && i > g.nx / 3 ? 1.0 : 0.0);
            }
        INFO(shape.nx << " x " << shape.ny << ", wet " << shape.wet << ", data " << shape.data);
        const Pixels picture = drawn(figure);
        CHECK(picture.width <= figure.width);
        CHECK(picture.height <= figure.height);
        CHECK(picture.width >= figure.width / 2);
        const MapLayout layout = lay_out(figure);
        CHECK(layout.frame.x0 > 0.0);
        CHECK(layout.frame.x1 < picture.width);
        CHECK(layout.frame.y0 > 0.0);
        CHECK(layout.frame.y1 < picture.height);
        CHECK(layout.x_ticks.at.size() >= 2);
        CHECK(layout.y_ticks.at.size() >= 2);
    }
}

// A leak grows the process in every row of ten; caches and allocator arenas, which fill when they please, do not.
TEST_CASE("Maps in a row leave the memory flat", "[figures]") {
    if (cannot_draw()) return;
    const figures::Folder folder;
    std::string why_not;
    const MapFigure figure = figures::valley();
    double least_growth = 1e9;  // [MB]
    for (int row = 0; row < 4; ++row) {
        const double before = resident_megabytes();
        for (int i = 0; i < 10; ++i) REQUIRE(render_map(figure, folder / "map.png", why_not));
        least_growth = std::min(least_growth, resident_megabytes() - before);
    }
    CHECK(least_growth < 14.0);  // half of ten pictures of 900 x 800 in four bytes
}

TEST_CASE("Without a renderer a map is refused with a reason and leaves no file", "[figures]") {
    const figures::Folder folder;
    std::string why_not;
    ::setenv("FRANA_NO_RENDER", "1", 1);
    const bool done = render_map(figures::valley(), folder / "map.png", why_not);
    ::unsetenv("FRANA_NO_RENDER");
    CHECK_FALSE(done);
    CHECK(why_not == "FRANA_NO_RENDER is set");
    CHECK(folder.files() == 0);
}

TEST_CASE("A map for a folder that does not exist names the file", "[figures]") {
    if (cannot_draw()) return;
    const figures::Folder folder;
    std::string why_not;
    CHECK_THROWS_AS(render_map(figures::valley(), folder / "no/map.png", why_not), UserError);
    CHECK_THROWS_WITH(render_map(figures::valley(), folder / "no/map.png", why_not),
                      Catch::Matchers::Contains("no/map.png: cannot be written"));
    CHECK(folder.files() == 0);
}

TEST_CASE("A full disk refuses a map with its name, and the earlier picture stays as it was", "[figures]") {
    if (cannot_draw()) return;
    const figures::Folder folder;
    std::string why_not;
    REQUIRE(render_map(figures::valley(), folder / "map.png", why_not));
    const Pixels before = read_png(folder / "map.png");
    MapFigure other = figures::valley();
    for (double& value : other.field) value = 3.0;
    {
        const SmallDisk disk(4096);
        CHECK_THROWS_WITH(render_map(other, folder / "map.png", why_not),
                          Catch::Matchers::Contains("map.png: cannot be written"));
    }
    CHECK(folder.files() == 1);
    CHECK(read_png(folder / "map.png").rgb == before.rgb);
}

TEST_CASE("A field that is no depth is shown and outlined where the depth says, whatever its own value", "[figures]") {
    MapFigure figure = figures::valley();
    figure.outline_field = figure.field;
    figure.outline_label = "depth [m]";
    figure.field_label = "stress [Pa]";
    figure.colormap = Colormap::diverging;
    for (double& value : figure.field) value = -7.0;  // outside the flow too, where nobody may see it
    for (std::size_t i = 0; i < figure.field.size(); ++i)
        if (!(figure.outline_field[i] > figure.shown_above)) figure.field[i] = 5000.0;
    figure.range.reset();
    const MapLayout layout = lay_out(figure);
    CHECK(layout.colours.low <= -7.0);
    CHECK(layout.colours.high < 100.0);
    CHECK(layout.legend.front().text == fmt::format("depth {:g} m", figure.shown_above));
    if (cannot_draw()) return;
    const Pixels picture = drawn(figure);
    const Vec2 inside = layout.pixel(figures::deposit);
    const Colour seen = at(picture, inside);
    CHECK(seen.b > seen.r + 40);  // blue: below zero
}

TEST_CASE("A filmstrip shows its maps in rows, with one view and one range", "[figures]") {
    if (cannot_draw()) return;
    Filmstrip strip;
    strip.maps = {figures::valley(), figures::valley(), figures::valley()};
    for (MapFigure& map : strip.maps) map.range.reset();
    for (double& value : strip.maps[1].field) value *= 0.5;
    for (double& value : strip.maps[2].field) value = 0.0;
    strip.columns = 2;
    strip.width = 1000;
    const figures::Folder folder;
    std::string why_not;
    REQUIRE(render_filmstrip(strip, folder / "strip.png", why_not));
    CHECK(folder.files() == 1);
    const Pixels picture = read_png(folder / "strip.png");
    CHECK(picture.width <= 1000);
    const int wide = picture.width / 2, high = picture.height / 2;
    // Where the first map has the deposit, the second has half of it in another colour, the third bare ground.
    const auto colour = [&](int column, int row) {
        const Rectangle part{0.2 * wide + column * wide, 0.2 * high + row * high, 0.75 * wide + column * wide,
                             0.9 * high + row * high};
        double most = 0.0;
        for (int y = static_cast<int>(part.y0); y < static_cast<int>(part.y1); ++y)
            for (int x = static_cast<int>(part.x0); x < static_cast<int>(part.x1); ++x)
                most = std::max(most, static_cast<double>(figures::saturation(picture.at(x, y))));
        return most;
    };
    CHECK(colour(0, 1) > 60.0);
    CHECK(colour(1, 1) > 60.0);
    CHECK(colour(0, 0) < colour(0, 1));
}
