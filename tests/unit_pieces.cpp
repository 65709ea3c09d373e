// What material in space has come apart into: exact answers.
#include "catch.h"
#include "solid/pieces.h"
#include "solid/solid_flow.h"
#include "verify/body.h"

using namespace frana;

namespace {

/// A cube of 2 x 2 x 2 cells, and behind a gap along an axis one of 1 x 1 x 1, eight points a cell.
Pieces with_gap(int axis, double gap) {
    SolidScene s;
    s.grid.cell = 0.5;  // [m]
    s.grid.nodes = {20, 20, 20};
    const auto cube = [&](const Vec3& low, double side) {
        verify::for_each_part(s.grid.cell * low, s.grid.cell * (low + Vec3::Constant(side)), s.grid.cell, 2,
                              [&](const Vec3& x, double volume) { s.points.add(x, Vec3::Zero(), volume); });
    };
    Vec3 low = Vec3::Constant(3.0);
    cube(low, 2.0);
    low[axis] += 2.0 + gap;
    cube(low, 1.0);
    const SolidFlow flow(s);
    return pieces_of(flow.body().points, flow.body().grid);
}

}  // namespace

TEST_CASE("Points no farther apart than a cell are one piece, wherever cells end", "[solid][pieces]") {
    for (int axis = 0; axis < 3; ++axis) {
        CAPTURE(axis);
        // Outer points lie a quarter of a cell inside.
        for (const double gap : {0.0, 0.3, 0.499}) {
            const Pieces one = with_gap(axis, gap);
            CHECK(one.count == 1);
            CHECK(one.apart == 0.0);
            CHECK(one.alone == 0.0);
        }
        for (const double gap : {0.501, 1.0, 1.5}) {
            const Pieces two = with_gap(axis, gap);
            CHECK(two.count == 2);
            CHECK(two.apart == 1.0 / 9.0);
            CHECK(two.alone == 0.0);  // first nodes of the nearest: 4 and at most 6
        }
        const Pieces far = with_gap(axis, 3.0);
        CHECK(far.count == 2);
        CHECK(far.alone == 1.0 / 9.0);
    }
}

TEST_CASE("Without points there are no pieces", "[solid][pieces]") {
    SolidScene s;
    s.grid.nodes = {8, 8, 8};
    const SolidFlow flow(s);
    CHECK(pieces_of(flow.body().points, flow.body().grid).count == 0);
}
