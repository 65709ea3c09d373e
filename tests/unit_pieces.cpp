// What 3D material has come apart into: exact answers.
#include <omp.h>
#include <algorithm>

#include "catch.h"
#include "solid3d/mpm3d.h"
#include "solid3d/pieces.h"
#include "solid3d/split_points.h"
#include "solid_maker.h"

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
    const Mpm3d flow(s);
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
    const Mpm3d flow(s);
    CHECK(pieces_of(flow.body().points, flow.body().grid).count == 0);
}

namespace {

/// Two points that move apart with the field that both belong to, so many cells from each other.
SolidScene pair(double gap) {
    SolidScene s;
    s.gravity = Vec3::Zero();
    s.grid.cell = 0.5;  // [m]
    s.grid.nodes = {16, 16, 16};
    s.split = true;
    s.points.add({3.0, 4.0, 4.0}, {-1.0, 0.0, 0.0}, 20.0);
    s.points.add({3.0 + 0.5 * gap, 4.0, 4.0}, {1.0, 0.0, 0.0}, 20.0);
    return s;
}

}  // namespace

TEST_CASE("Points become two across a gap that grows, and halves lie evenly", "[solid][pieces]") {
    for (const double gap : {0.79, 1.0, 1.76}) {
        CAPTURE(gap);
        const Mpm3d flow(pair(gap));
        const auto list = points_to_split(flow.body().points, flow.body().grid, {});
        REQUIRE(list.size() == (gap == 1.0 ? 2 : 0));
        if (list.empty()) continue;
        CHECK(list[0].way == Vec3(0.25, 0, 0));
        CHECK(list[1].way == Vec3(-0.25, 0, 0));
    }
    SolidScene closing = pair(1.0);
    std::swap(closing.points.velocity[0], closing.points.velocity[1]);
    const Mpm3d flow(closing);
    CHECK(points_to_split(flow.body().points, flow.body().grid, {}).empty());
}

TEST_CASE("Splitting conserves mass, momentum and its ledger, with the same bits for any threads", "[solid][pieces]") {
    const int threads = omp_get_max_threads();
    for (const SolidLaw& law : all_solid_laws()) {
        CAPTURE(law.index());
        std::vector<std::vector<double>> heights;
        for (const int count : {1, 3}) {
            omp_set_num_threads(count);
            SolidScene scene = kept(lump(law));
            scene.split = true;
            Mpm3d flow(scene);
            const double mass = flow.status().mass;
            const Index before = flow.status().points;
            for (int n = 0; n < 220; ++n) flow.advance(1e9);
            CHECK(flow.status().points == flow.body().points.count());
            CHECK(flow.status().mass + flow.status().mass_left == Approx(mass).epsilon(1e-13));
            CHECK(flow.momentum_residual().norm() < 1e-12 * flow.status().weight_impulse.norm());
            const auto& q = flow.body().points;
            CHECK(*std::max_element(q.id.begin(), q.id.end()) >= before);  // halves were born; others may have left
            heights.emplace_back(q.x[2].begin(), q.x[2].end());
        }
        omp_set_num_threads(threads);
        CHECK(heights[0] == heights[1]);
    }
}
