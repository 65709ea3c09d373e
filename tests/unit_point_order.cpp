// The order of points by tile, and the turns of tiles: the same for any number of threads. How far to the side of their
// points mirror particles stand, which turns in space depend on.
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <random>

#include "catch.h"
#include "mpm/point_order.h"
#include "mpm/tile_grid.h"
#include "shallow/particles.h"
#include "solid3d/material_points.h"
#include "solid3d/surfaces.h"
#include "threads_of_test.h"

using namespace frana;

namespace {

/// Points as they lie after a few steps: most in the tile of the one before, some gone.
std::vector<Index> drifted_keys(Index count, Index tiles, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<Index> keys(static_cast<std::size_t>(count));
    for (Index p = 0; p < count; ++p) {
        const Index own = p * tiles / count;
        const auto drawn = random() % 10;
        keys[static_cast<std::size_t>(p)] = drawn == 0 ? -1 : drawn == 1 ? std::min(own + 1, tiles - 1) : own;
    }
    return keys;
}

struct Ordered {
    std::vector<Index> tile, begin;
    std::vector<double> wide;
    std::vector<float> narrow;
    std::vector<std::int64_t> id;
};

/// Sorts once, goes on with the keys of the points that are left moved to the next tile, and leaves out each seventh.
Ordered ordered(const std::vector<Index>& keys, Index tiles) {
    PointOrder order;
    ActiveTiles active;
    Array wide;
    ArrayOf<float> narrow;
    std::vector<std::int64_t> id;
    std::vector<Index> now = keys;
    for (std::size_t p = 0; p < keys.size(); ++p)
        wide.push_back(0.5 * static_cast<double>(p)), narrow.push_back(static_cast<float>(p)),
            id.push_back(static_cast<std::int64_t>(p));
    const std::vector<PointField> fields{&wide, &narrow, &id};
    for (int round = 0; round < 2; ++round) {
        order.find_tiles(static_cast<Index>(now.size()), tiles, [&](Index p) { return now[p]; });
        order.lay_out(active);
        if (round == 1) {
            std::vector<std::uint8_t> gone(now.size());
            for (std::size_t p = 0; p < gone.size(); p += 7) gone[p] = 1;
            order.leave_out(gone, active);
        }
        order.permute(fields);
        now.resize(id.size());
        for (std::size_t p = 0; p < id.size(); ++p) now[p] = (keys[static_cast<std::size_t>(id[p])] + 1) % tiles;
    }
    return {active.tile, active.begin, {wide.begin(), wide.end()}, {narrow.begin(), narrow.end()}, id};
}

}  // namespace

TEST_CASE("Points are sorted by tile and keep their order within a tile, on any number of threads",
          "[points][threads]") {
    const Index tiles = 40;
    for (const Index count : {Index{100}, Index{20000}}) {
        const std::vector<Index> keys = drifted_keys(count, tiles, 5);
        std::vector<std::int64_t> expected;
        for (Index p = 0; p < count; ++p)
            if (keys[static_cast<std::size_t>(p)] >= 0) expected.push_back(p);
        const auto by = [&](Index shift) {
            return [&, shift](std::int64_t a, std::int64_t b) {
                return (keys[static_cast<std::size_t>(a)] + shift) % tiles <
                       (keys[static_cast<std::size_t>(b)] + shift) % tiles;
            };
        };
        std::stable_sort(expected.begin(), expected.end(), by(0));
        std::vector<std::int64_t> kept;
        for (std::size_t place = 0; place < expected.size(); ++place)
            if (place % 7 != 0) kept.push_back(expected[place]);
        std::stable_sort(kept.begin(), kept.end(), by(1));
        for (const int threads : {1, 2, 3, 16}) {
            const Threads set(threads);
            const Ordered found = ordered(keys, tiles);
            REQUIRE(found.id == kept);
            for (std::size_t p = 0; p < kept.size(); ++p) {
                REQUIRE(found.wide[p] == 0.5 * static_cast<double>(kept[p]));
                REQUIRE(found.narrow[p] == static_cast<float>(kept[p]));
            }
            REQUIRE(found.begin.size() == found.tile.size() + 1);
            for (std::size_t n = 0; n < found.tile.size(); ++n)
                for (Index p = found.begin[n]; p < found.begin[n + 1]; ++p)
                    REQUIRE((keys[static_cast<std::size_t>(kept[static_cast<std::size_t>(p)])] + 1) % tiles ==
                            found.tile[n]);
        }
    }
}

TEST_CASE("Tiles side by side have their turns one after the other, in the same order on any number of threads",
          "[points][threads]") {
    constexpr Index kWidth = 12;
    std::mt19937 random(3);
    std::vector<Index> tile;
    for (Index id = 0; id < kWidth * kWidth; ++id)
        if (random() % 4 != 0) tile.push_back(id);
    const auto colour = [](Index id) { return 2 * (id / kWidth % 2) + id % kWidth % 2; };
    TileTurns turns;
    std::vector<std::vector<Index>> orders;
    for (int list = 0; list < 2; ++list) {  // the second list takes the room of the first
        turns.begin(tile, kWidth * kWidth, 8);
        for (const Index id : tile) {
            turns.add(colour(id));
            for (Index other = 0; other < kWidth * kWidth; ++other)
                if (colour(other) < colour(id) && std::abs(other / kWidth - id / kWidth) <= 1 &&
                    std::abs(other % kWidth - id % kWidth) <= 1)
                    turns.wait_for(other, tile);
        }
        turns.end();
        for (const int threads : {1, 2, 5}) {
            const Threads set(threads);
            // Each tile gives to itself and to those after it; what comes there is written down in its order.
            std::vector<std::vector<Index>> given(kWidth * kWidth);
            turns.run(true, [&](Index n) {
                const Index id = tile[static_cast<std::size_t>(n)], i = id % kWidth, j = id / kWidth;
                for (Index row = j; row < std::min(j + 2, kWidth); ++row)
                    for (Index column = i; column < std::min(i + 2, kWidth); ++column)
                        given[static_cast<std::size_t>(row * kWidth + column)].push_back(id);
            });
            std::vector<Index> all;
            for (const auto& part : given) all.insert(all.end(), part.begin(), part.end()), all.push_back(-1);
            orders.push_back(all);
        }
        for (std::size_t n = orders.size() - 2; n < orders.size(); ++n) REQUIRE(orders[n] == orders[orders.size() - 3]);
        tile.erase(tile.begin() + 5);
    }
    REQUIRE(orders[3] != orders[0]);
}

TEST_CASE("Tiles of a flow on the map have their turns after adjacent ones that come first", "[points][threads]") {
    GridGeometry geometry;
    geometry.nx = geometry.ny = 80;
    const TileGrid grid(geometry);
    Particles particles;
    for (Index j = 0; j < 80; j += 4)
        for (Index i = 0; i < 80; i += 4) {
            const Index p = particles.count();
            particles.resize(p + 1);
            particles.x[p] = static_cast<double>(i) + 0.7, particles.y[p] = static_cast<double>(j) + 0.7,
            particles.id[p] = p;
        }
    ActiveTiles active;
    TileSorter().sort(particles, grid, {}, active);
    REQUIRE(active.count() >= 25);
    std::vector<std::vector<Index>> lists;
    for (const int threads : {1, 4}) {
        const Threads set(threads);
        std::vector<std::vector<Index>> given(static_cast<std::size_t>(grid.tiles()));
        active.turns.run(true, [&](Index n) {
            const Index tile = active.tile[static_cast<std::size_t>(n)], width = grid.tiles_x();
            for (const Index to : {tile, tile + 1, tile + width, tile + width + 1})  // what its points reach
                given[static_cast<std::size_t>(to)].push_back(tile);
        });
        std::vector<Index> all;
        for (const auto& part : given) all.insert(all.end(), part.begin(), part.end()), all.push_back(-1);
        lists.push_back(all);
        // By colour: rows with even numbers first, in them columns with even numbers.
        const auto turn = [&](Index tile) { return 2 * (tile / grid.tiles_x() % 2) + tile % grid.tiles_x() % 2; };
        for (const auto& part : given)
            for (std::size_t k = 1; k < part.size(); ++k) REQUIRE(turn(part[k - 1]) < turn(part[k]));
    }
    REQUIRE(lists[0] == lists[1]);
}

TEST_CASE("Tiles in 3D have their turns after adjacent ones that come first", "[points][solid][threads]") {
    GridGeometry3d geometry;
    geometry.nodes = {40, 40, 40};
    const Grid3d grid(geometry);
    MaterialPoints points;
    for (double z = 1.0; z < 38.0; z += 4.0)
        for (double y = 1.0; y < 38.0; y += 4.0)
            for (double x = 1.0; x < 38.0; x += 4.0) {
                const Index p = points.count();
                points.resize(p + 1);
                points.x[0][p] = x, points.x[1][p] = y, points.x[2][p] = z, points.id[p] = p;
            }
    ActiveTiles active;
    Sorter3d().sort(points, grid, {}, active);
    REQUIRE(active.count() >= 100);
    for (const int threads : {1, 4}) {
        const Threads set(threads);
        std::vector<std::vector<std::array<Index, 3>>> given(static_cast<std::size_t>(grid.tiles()));
        active.turns.run(true, [&](Index n) {
            const std::array<Index, 3> t = grid.tile_place(active.tile[static_cast<std::size_t>(n)]);
            for (int corner = 0; corner < 8; ++corner) {  // what its points reach
                const std::array<Index, 3> to = {t[0] + corner % 2, t[1] + corner / 2 % 2, t[2] + corner / 4};
                bool inside = true;
                for (int axis = 0; axis < 3; ++axis) inside = inside && to[axis] < grid.tiles_along(axis);
                if (inside) given[static_cast<std::size_t>(grid.tile_at(to))].push_back(t);
            }
        });
        const auto turn = [](const std::array<Index, 3>& t) { return t[0] % 2 + 2 * (t[1] % 2) + 4 * (t[2] % 2); };
        for (const auto& part : given)
            for (std::size_t k = 1; k < part.size(); ++k) REQUIRE(turn(part[k - 1]) < turn(part[k]));
    }
}

TEST_CASE("No mirror particle in a plane or a bed stands farther to the side than is said", "[points][solid]") {
    std::mt19937 random(11);
    const auto drawn = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    constexpr double kCell = 0.5;
    for (int n = 0; n < 60; ++n) {
        std::vector<Surface> surfaces;
        if (n % 3 == 0) {
            surfaces = {Surface::plane({2.0, 2.5, 0.0}, {drawn(-1, 1), drawn(-1, 1), drawn(-1, 1)})};
        } else {
            GridGeometry geometry;
            geometry.cell = kCell, geometry.nx = geometry.ny = 12;
            Raster bed = Raster::filled(geometry, 0.0);
            const double a = drawn(-0.5, 0.5), b = drawn(-0.5, 0.5);
            for (Index j = 0; j < 12; ++j)
                for (Index i = 0; i < 12; ++i)
                    bed.at(i, j) = n % 3 == 1 ? a * geometry.x(i) + b * geometry.y(j) : drawn(0.0, 1.5);
            surfaces = {Surface::ground(bed)};
        }
        const double beyond = n % 2 == 0 ? 0.0 : 4.0;  // the bed ends at 5.5 m
        const Vec3 low(1.0 + beyond, 1.5, -10.0), high(3.0 + beyond, 3.5, 10.0);
        const double most = sideways_reach(surfaces[0], low, high);
        double farthest = 0.0;
        for (int p = 0; p < 3000; ++p) {
            Vec3 x(drawn(low.x(), high.x()), drawn(low.y(), high.y()), 0.0);
            const Contact c = contact(surfaces[0], x);
            x += (drawn(0.0, mirror_reach(c.normal) * kCell) - c.distance) * c.normal;  // of a bed: roughly
            if (n % 3 != 0) x.x() = std::clamp(x.x(), low.x(), high.x()), x.y() = std::clamp(x.y(), low.y(), high.y());
            for (const MirrorParticle& mirror : MirrorParticles(surfaces, 1, x, kCell))
                farthest = std::max({farthest, std::abs(mirror.place.x() - x.x()), std::abs(mirror.place.y() - x.y())});
        }
        REQUIRE(farthest / kCell <= most * (1.0 + 1e-12));
        if (n % 3 < 2 && beyond == 0.0) REQUIRE(farthest / kCell > 0.8 * most);  // of 3000 points some are far off
    }
}

// Linux refuses a single block that is larger than the machine's memory, unless it is told that none need be set aside.
TEST_CASE("Nodes of a grid that is larger than the memory are there, where few of them are used", "[points]") {
    int overcommit = 0;
    std::ifstream("/proc/sys/vm/overcommit_memory") >> overcommit;
    if (overcommit == 2) {
        WARN("this system promises no memory that it does not have; this test is skipped");
        return;
    }
    const double memory = double(::sysconf(_SC_PHYS_PAGES)) * double(::sysconf(_SC_PAGESIZE));
    const auto count = static_cast<Index>(4.0 * memory / sizeof(double));
    LazyArray<double> nodes(count, 8);
    CHECK(nodes.count() == count);
    nodes[count - 1] = 3.0;
    for (const Index k : {Index{-8}, Index{0}, count / 2, count - 2, count + 7}) CHECK(nodes[k] == 0.0);
    LazyArray<double> moved = std::move(nodes);
    CHECK(moved[count - 1] == 3.0);
    moved = LazyArray<double>(10);
    CHECK(moved[9] == 0.0);
}
