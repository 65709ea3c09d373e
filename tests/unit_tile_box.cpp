// Rectangles of a tile's nodes, as far as they reach into the tiles around.
#include "catch.h"
#include "shallow/tile_box.h"

using namespace frana;

namespace {

bool holds(const TileBox& box, Index i, Index j) { return i >= box.i0 && i < box.i1 && j >= box.j0 && j < box.j1; }

}  // namespace

TEST_CASE("What of a box, grown, lies in a tile next to it: node by node", "[erosion]") {
    const Index reach = 2;
    for (const TileBox& box : {TileBox{0, 1, 0, 1}, TileBox{15, 16, 3, 9}, TileBox{5, 7, 14, 16}, TileBox::whole()})
        for (Index dj = -1; dj <= 1; ++dj)
            for (Index di = -1; di <= 1; ++di) {
                const TileBox seen = box.seen_from(di, dj, reach);
                for (Index j = 0; j < kTile; ++j)
                    for (Index i = 0; i < kTile; ++i) {
                        const Index a = i + di * kTile,
                                    b = j + dj * kTile;  // counted from the first node of the box's tile
                        const bool near =
                            a >= box.i0 - reach && a < box.i1 + reach && b >= box.j0 - reach && b < box.j1 + reach;
                        CHECK(holds(seen, i, j) == near);
                    }
            }
}

TEST_CASE("A box that holds nothing adds nothing and is seen from nowhere", "[erosion]") {
    TileBox box;
    box.add(TileBox{3, 3, 0, 16});
    CHECK(box.empty());
    CHECK(box.seen_from(0, 1, 2).empty());
    box.add(TileBox{4, 5, 6, 7}), box.add(TileBox{9, 10, 2, 3}), box.add(TileBox{});
    CHECK((box.i0 == 4 && box.i1 == 10 && box.j0 == 2 && box.j1 == 7));
}
