// The width of flows whose width is known.
#include <cmath>

#include "catch.h"
#include "compare/flow_width.h"

using namespace frana;

namespace {

constexpr double cell = 5.0;

/// 1 m deep where `inside` says so, on 400 x 300 nodes around (0, 0).
template <class Inside>
Raster flow_of(const Inside& inside) {
    Raster raster = Raster::filled({400, 300, -200 * cell + 1.3, -150 * cell + 0.7, cell}, 0.0);
    const GridGeometry& g = raster.geometry;
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i)
            if (inside(g.x(i), g.y(j))) raster.at(i, j) = 1.0;
    return raster;
}

/// 1000 m long, turned from the x axis.
Raster channel(double width, double degrees) {
    const double turn = degrees * 0.017453292519943295, c = std::cos(turn), s = std::sin(turn);
    return flow_of(
        [=](double x, double y) { return std::abs(c * y - s * x) < 0.5 * width && std::abs(c * x + s * y) < 500.0; });
}

/// Half a cell: where an edge lies between nodes, the raster does not know.
Approx to_half_a_cell(double width) { return Approx(width).margin(0.5 * cell).epsilon(0.0); }

}  // namespace

TEST_CASE("A straight channel at any angle has its width, to half a cell", "[width]") {
    for (const double cells : {2.5, 3.0, 4.3, 6.0, 9.7, 20.0, 41.0})
        for (const double degrees : {7.0, 14.0, 20.0, 26.57, 33.0, 60.0, 107.0, 150.0}) {
            CAPTURE(cells, degrees);
            CHECK(flow_width(channel(cells * cell, degrees), 0.1) == to_half_a_cell(cells * cell));
        }
}

TEST_CASE("A channel along rows of nodes has its width, to one row: nothing tells where in a row it ends", "[width]") {
    for (const double cells : {2.5, 3.0, 4.3, 6.0, 9.7, 20.0, 41.0})
        for (const double degrees : {0.0, 45.0, 90.0, 135.0}) {
            CAPTURE(cells, degrees);
            const double row = std::fmod(degrees, 90.0) > 0.0 ? cell * std::sqrt(0.5) : cell;
            CHECK(flow_width(channel(cells * cell, degrees), 0.1) == Approx(cells * cell).margin(row).epsilon(0.0));
        }
}

TEST_CASE("A bent channel has its width, and so has a disc", "[width]") {
    const Raster ring = flow_of([](double x, double y) { return std::abs(std::hypot(x, y) - 400.0) < 30.0; });
    CHECK(flow_width(ring, 0.1) == to_half_a_cell(60.0));
    const Raster disc = flow_of([](double x, double y) { return std::hypot(x, y) < 200.0; });
    CHECK(flow_width(disc, 0.1) == to_half_a_cell(400.0));
}

TEST_CASE("A rhombus is as wide as the largest circle in it, whatever notches its edge has", "[width]") {
    const double deep = GENERATE(0.0, 5.0, 10.0);  // [m], a notch each 40 m
    const Raster rhombus = flow_of([deep](double x, double y) {
        const bool notch = std::abs(std::remainder(x, 40.0)) < 0.5 * cell;
        return std::abs(x) + std::abs(y) < 300.0 - (notch ? deep : 0.0);
    });
    // To the notches' depth, and half a cell on either side.
    CHECK(flow_width(rhombus, 0.1) == Approx(600.0 * std::sqrt(0.5)).margin(cell + deep).epsilon(0.0));
}

TEST_CASE("The median goes by the flow's length, not by its area", "[width]") {
    // 300 m of a fan that has twice the area of the 700 m long channel before it.
    const Raster flow =
        flow_of([](double x, double y) { return std::abs(y) < (x < 200.0 ? 20.0 : 100.0) && x > -500.0 && x < 500.0; });
    CHECK(flow_width(flow, 0.1) == to_half_a_cell(40.0));
}

TEST_CASE("Small holes are no banks, an island is", "[width]") {
    const auto flow = [](double hole) {
        return flow_of([hole](double x, double y) {
            const double to_next = std::remainder(x, 100.0);  // one hole each 100 m
            const bool in_hole = std::abs(to_next) < hole && std::abs(y) < hole;
            return std::abs(y) < 60.0 && std::abs(x) < 500.0 && !in_hole;
        });
    };
    CHECK(flow_width(flow(1.4 * cell), 0.1) == to_half_a_cell(120.0));
    CHECK(flow_width(flow(40.0), 0.1) < 60.0);
}

TEST_CASE("Single nodes around a wide flow do not count", "[width]") {
    const Raster flow = flow_of([](double x, double y) {
        const bool spray = y > 150.0 && y < 400.0 && std::abs(std::remainder(x, 40.0)) < 3.0 &&
                           std::abs(std::remainder(y, 40.0)) < 3.0;
        return std::abs(x) < 500.0 && (std::abs(y) < 100.0 || spray);
    });
    CHECK(flow_width(flow, 0.1) == to_half_a_cell(200.0));
}

TEST_CASE("A flow of single nodes is a cell wide; where nothing flowed there is no width", "[width]") {
    const Raster line = flow_of([](double x, double y) { return std::abs(y) < 0.5 * cell && std::abs(x) < 300.0; });
    CHECK(flow_width(line, 0.1) == Approx(cell));  // sections are sums of steps
    for (const double cells : {0.5, 1.5}) {        // one node; a square of four
        const double size = cells * cell;
        const Raster few = flow_of([=](double x, double y) { return std::abs(x) < size && std::abs(y) < size; });
        CHECK(flow_width(few, 0.1) == Approx(2.0 * size).margin(cell).epsilon(0.0));
    }
    CHECK(std::isnan(flow_width(line, 2.0)));
    Raster unknown = line;
    for (double& h : unknown.values) h = Raster::nodata;
    CHECK(std::isnan(flow_width(unknown, 0.1)));
}

TEST_CASE("A flow at the edge of the terrain ends there", "[width]") {
    const Raster flow = flow_of([](double, double y) { return y < -650.0; });
    CHECK(flow_width(flow, 0.1) == to_half_a_cell(-650.0 - flow.geometry.y0 + 0.5 * cell));
}

TEST_CASE("The cell that would do has six across and is a round number", "[width]") {
    CHECK(cell_that_resolves(60.0) == Approx(10.0));
    CHECK(cell_that_resolves(59.9) == Approx(5.0));
    CHECK(cell_that_resolves(15.0) == Approx(2.5));
    CHECK(cell_that_resolves(14.9) == Approx(2.0));
    CHECK(cell_that_resolves(0.7) == Approx(0.1));
}

TEST_CASE("Fewer than six cells across are a remark with the cell that would do", "[width]") {
    CHECK(width_remark(60.0, 10.0, true).empty());
    CHECK(width_remark(Raster::nodata, 10.0, true).empty());
    CHECK(width_remark(40.0, 10.0, true) ==
          "the flow is 4 cells wide (40 m, median over its length); expected 6 or more, or its path and runout hang on "
          "the grid, and by a few cells on particles.per_cell (frana converge --per-cell 4,9,16 measures it); "
          "grid.cell = 5 "
          "would do");
    CHECK(width_remark(40.0, 10.0, false) ==
          "the flow is 4 cells wide (40 m, median over its length); expected 6 or more, or its path and runout hang on "
          "the grid; grid.cell = 5 would do");
}

TEST_CASE("A width just below the limit is told as less than the limit", "[compare]") {
    for (const double width : {59.9, 59.99, 59.6}) {
        const std::string said = width_remark(width, 10.0, true);
        CAPTURE(said);
        CHECK(said.find("the flow is 6 cells") == std::string::npos);
        CHECK(said.find("the flow is 5.9") == 0);
        CHECK(said.find("(60 m") == std::string::npos);
    }
}
