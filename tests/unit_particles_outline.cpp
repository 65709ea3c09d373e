#include <random>

#include "catch.h"
#include "release_maker.h"
#include "terrain/outline_area.h"

using namespace frana;
using namespace release_maker;

namespace {

std::vector<double> uneven_lines(double low, double high, int count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> between(low, high);
    std::vector<double> lines{low, high};
    for (int k = 0; k < count; ++k) lines.push_back(between(random));
    std::sort(lines.begin(), lines.end());
    return lines;
}

/// Largest difference between the cells' areas and those of the ring cut by each cell.
double worst_cell(const Rings& rings, const std::vector<double>& x, const std::vector<double>& y) {
    OutlineArea outline(rings, x, y);
    std::vector<double> area(x.size() - 1, -1.0);
    double worst = 0.0;
    for (Index j = 0; j + 1 < static_cast<Index>(y.size()); ++j) {
        const auto [first, second] = outline.row(j, area);
        for (Index i = 0; i + 1 < static_cast<Index>(x.size()); ++i) {
            double exact = 0.0;
            for (const Ring& ring : rings)
                exact += (shoelace(ring) > 0 ? 1 : -1) * area_in_box(ring, x[i], y[j], x[i + 1], y[j + 1]);
            worst = std::max(worst, std::abs((i >= first && i < second ? area[i] : 0.0) - exact));
        }
    }
    return worst;
}

}  // namespace

TEST_CASE("Every cell of an uneven grid gets the area of a star with a hole in it", "[particles]") {
    Ring hole = star({51.0, 49.0}, 9.0, 4.0, 5, 0.3);
    std::reverse(hole.begin(), hole.end());
    const Rings rings{star({50.0, 50.0}, 45.0, 20.0, 7, 0.1), hole};
    // 1e-11 m2: coordinates of 100 m have round-off 1e-14 m, edges are 100 m long, some ten pieces meet in a
    // cell.
    CHECK(worst_cell(rings, uneven_lines(0, 100, 37, 1), uneven_lines(0, 100, 41, 2)) < 1e-11);
}

TEST_CASE("An outline that reaches beyond the grid on all sides is cut at its border", "[particles]") {
    const Rings rings{star({50.0, 50.0}, 90.0, 40.0, 6, 0.2)};
    CHECK(worst_cell(rings, uneven_lines(20, 80, 23, 3), uneven_lines(30, 90, 19, 4)) < 1e-11);
}

TEST_CASE("Edges on grid lines and vertices on grid corners are counted once", "[particles]") {
    const Rings rings{{{2, 2}, {6, 2}, {6, 4}, {8, 6}, {6, 8}, {4, 8}, {2, 6}}};
    std::vector<double> lines;
    for (int k = 0; k <= 10; ++k) lines.push_back(k);
    CHECK(worst_cell(rings, lines, lines) == 0.0);
}

TEST_CASE("Overlapping rings count once and are reported", "[particles]") {
    const Rings rings{{{0, 0}, {6, 0}, {6, 4}, {0, 4}}, {{4, 0}, {9, 0}, {9, 4}, {4, 4}}};
    OutlineArea outline(rings, {0, 2, 4, 6, 8, 10}, {0, 4});
    std::vector<double> area(5);
    outline.row(0, area);
    CHECK(area == std::vector<double>{8, 8, 8, 8, 4});
    CHECK(outline.faults().overlap == 8.0);
    CHECK(outline.faults().negative == 0.0);
}

TEST_CASE("A ring that crosses itself shows as negative area", "[particles]") {
    const Rings bow_tie{{{0, 0}, {4, 4}, {4, 0}, {0, 4}}};
    OutlineArea outline(bow_tie, {0, 1, 2, 3, 4}, {0, 4});
    std::vector<double> area(4);
    outline.row(0, area);
    CHECK(outline.faults().negative == Approx(4.0).epsilon(1e-14));
}
