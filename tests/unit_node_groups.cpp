// Which nodes matter: marks, reach and growth held to a walk over single nodes; untouched nodes hold nothing.
#include <random>
#include <set>

#include "analytic_scene.h"
#include "catch.h"
#include "shallow/depth_averaged.h"

using namespace frana;

namespace {

using SetOfNodes = std::set<std::pair<int, int>>;

/// Whether group bits of the tile at (0, 0) and its neighbours hold node (i, j), -16 <= i, j < 32.
bool holds(const TileReach& reach, int i, int j) {
    const int tile = (j + 16) / 16 * 3 + (i + 16) / 16;
    return reach[static_cast<std::size_t>(tile)] & group_of((i + 16) % 16, (j + 16) % 16);
}

/// Nodes by whose group a node of the set lies.
SetOfNodes filled_up(const SetOfNodes& nodes) {
    SetOfNodes full;
    for (const auto& [i, j] : nodes)
        for (int n = 0; n < 4; ++n) full.insert({(i + 16) / 4 * 4 - 16 + n, j});
    return full;
}

}  // namespace

TEST_CASE("The reach of stencils is every node that one touches, in whole groups", "[solver]") {
    std::mt19937 random(4);
    std::uniform_int_distribution<int> at(-7, 21), few(1, 6);
    for (int trial = 0; trial < 200; ++trial) {
        const int before = trial % 3, after = 1 + trial % 4;
        StencilMarks marks(160, 320);
        SetOfNodes nodes;
        for (int n = few(random); n > 0; --n) {
            const int i = at(random), j = at(random);
            marks.mark(160 + i, 320 + j);
            for (int dj = -before; dj <= after; ++dj)
                for (int di = -before; di <= after; ++di) nodes.insert({i + di, j + dj});
        }
        const SetOfNodes expected = filled_up(nodes);
        const TileReach reach = marks.reach(before, after);
        int wrong = 0;
        for (int j = -16; j < 32; ++j)
            for (int i = -16; i < 32; ++i) wrong += holds(reach, i, j) != (expected.count({i, j}) == 1);
        CHECK(wrong == 0);
    }
}

TEST_CASE("Groups grow by three rows and one group, across tiles", "[solver]") {
    std::mt19937_64 random(5);
    for (int trial = 0; trial < 100; ++trial) {
        TileReach around{};
        for (auto& groups : around) groups = random() & random() & random() & random();
        const NodeGroups now = grown(around);
        int wrong = 0;
        for (int j = 0; j < 16; ++j)
            for (int i = 0; i < 16; i += 4) {
                bool any = false;
                for (int dj = -3; dj <= 3; ++dj)
                    for (int di = -4; di <= 4; di += 4) any = any || holds(around, i + di, j + dj);
                wrong += any != static_cast<bool>(now & group_of(i, j));
            }
        CHECK(wrong == 0);
    }
}

TEST_CASE("Nodes that no point touches hold nothing, and nodes near them are dry", "[solver]") {
    for (const Shape shape : {Shape::linear, Shape::quadratic, Shape::cubic}) {
        Scene scene = verify::scene_on(90, 70, 1.0, [](double x, double y) { return 0.3 * x + 0.1 * y; });
        scene.bed_law = bed::Voellmy{0.1, 500.0};
        scene.scheme.shape = shape;
        verify::fill(scene, [](double x, double y) { return std::hypot(x - 60, y - 30) < 7 ? 1.0 : 0.0; }, {2});
        DepthAveraged simulation(scene);
        Index loaded = 0, dry = 0, passed_over = 0;
        for (int step = 0; step < 80; ++step) {
            simulation.advance(1e9);
            const Flow& flow = simulation.flow();
            for (const Index tile : flow.active.work) {
                for_each_node_of(flow.grid, tile, ~flow.in_reach[tile], [&](Index k, Index, Index) {
                    loaded += flow.nodes.mass[k] != 0.0 || flow.nodes.column_mass[k] != 0.0;
                    ++passed_over;
                });
                for_each_node_of(flow.grid, tile, flow.near[tile] & ~flow.in_reach[tile], [&](Index k, Index, Index) {
                    dry += flow.nodes.depth[k] == 0.0 && flow.nodes.flags[k] == 0 &&
                           flow.nodes.surface[k] == flow.bed.z[k] && flow.nodes.before[k].x == 0.0;
                    --dry;
                });
            }
        }
        CHECK(loaded == 0);
        CHECK(dry == 0);
        CHECK(passed_over > 0);
    }
}
