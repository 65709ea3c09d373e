#include "checks/bench/blob.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/constants.h"
#include "mpm/tile_grid.h"

namespace frana::bench {
namespace {

constexpr double kCell = 5.0;   ///< [m]
constexpr Index kRoom = 48;     ///< [cells]
constexpr double kDepth = 4.0;  ///< [m]

/// A place of the lattice, in half cells from the blob's centre.
struct Place {
    Index i, j;
    Index distance2() const { return (2 * i + 1) * (2 * i + 1) + (2 * j + 1) * (2 * j + 1); }
};

/// The `count` places nearest to the centre, row by row.
std::vector<Place> nearest_places(Index count) {
    const Index reach = static_cast<Index>(std::ceil(std::sqrt(static_cast<double>(count) / constants::kPi))) + 2;
    std::vector<Place> places;
    for (Index j = -reach; j < reach; ++j)
        for (Index i = -reach; i < reach; ++i) places.push_back({i, j});
    std::nth_element(places.begin(), places.begin() + count - 1, places.end(), [](const Place& a, const Place& b) {
        return std::make_tuple(a.distance2(), a.j, a.i) < std::make_tuple(b.distance2(), b.j, b.i);
    });
    places.resize(static_cast<std::size_t>(count));
    std::sort(places.begin(), places.end(),
              [](const Place& a, const Place& b) { return std::make_pair(a.j, a.i) < std::make_pair(b.j, b.i); });
    return places;
}

/// The column of places from which on points move, when a share of them rests.
Index first_moving(const std::vector<Place>& places, double resting) {
    if (resting <= 0.0) return std::numeric_limits<Index>::min();
    std::vector<Index> columns;
    columns.reserve(places.size());
    for (const Place& place : places) columns.push_back(place.i);
    const auto nth = static_cast<std::ptrdiff_t>(resting * static_cast<double>(places.size()));
    std::nth_element(columns.begin(), columns.begin() + nth, columns.end());
    return columns[static_cast<std::size_t>(nth)];
}

/// Bed elevation at (x, y) from the blob's centre [m].
double ground(double x, double y) {
    return 2000.0 - 0.5 * x +
           4.0 * std::sin(2.0 * constants::kPi * x / 190.0) * std::cos(2.0 * constants::kPi * y / 230.0);
}

Raster bed_of(const Blob& blob, Index nodes, Index centre) {
    Raster bed = Raster::filled(GridGeometry{nodes, nodes, 0.0, 0.0, kCell}, 0.0);
    if (!blob.topography) return bed;
#pragma omp parallel for schedule(static)
    for (Index j = 0; j < nodes; ++j)
        for (Index i = 0; i < nodes; ++i)
            bed.at(i, j) = ground(kCell * static_cast<double>(i - centre), kCell * static_cast<double>(j - centre));
    return bed;
}

/// So little that the flow stays as it is without.
ErodibleBed loose_ground(const Raster& bed) {
    ErodibleBed loose;
    loose.depth = Raster::filled(bed.geometry, 1.0);
    loose.law = erosion::Growth{1e-5};
    return loose;
}

std::shared_ptr<const Friction> striped(const bed::Voellmy& law, const Raster& bed) {
    constexpr Index kStripe = 10;  // [cells]
    std::vector<bed::Voellmy> of_nodes;
    of_nodes.reserve(static_cast<std::size_t>(bed.geometry.size()));
    for (Index j = 0; j < bed.geometry.ny; ++j)
        for (Index i = 0; i < bed.geometry.nx; ++i)
            of_nodes.push_back({law.mu * (i / kStripe % 2 == 0 ? 1.0 : 1.01), law.xi});
    Friction friction;
    friction.laws = bed::law_map(of_nodes);
    friction.keys = {"mu"};
    return std::make_shared<const Friction>(std::move(friction));
}

/// In rows from the south-west corner, a house's breadth apart.
std::vector<Barrier> village(Index houses, const GridGeometry& g) {
    constexpr double kBreadth = 2.0 * kCell;
    const Index row = static_cast<Index>(static_cast<double>(g.nx - 8) * kCell / (2.0 * kBreadth));
    std::vector<Barrier> all;
    for (Index n = 0; n < houses; ++n) {
        const Index line = n / row;
        const double x = g.x0 + 4.0 * kCell + 2.0 * kBreadth * static_cast<double>(n - line * row),
                     y = g.y0 + 4.0 * kCell + 2.0 * kBreadth * static_cast<double>(line);
        Barrier house;
        house.name = "house_" + std::to_string(n + 1);
        house.outline.parts = {
            Polygon{{{{x, y}, {x + kBreadth, y}, {x + kBreadth, y + kBreadth}, {x, y + kBreadth}, {x, y}}}}};
        house.height = 8.0;
        all.push_back(house);
    }
    return all;
}

}  // namespace

Scene blob_scene(const Blob& blob) {
    const double cells = static_cast<double>(blob.particles) / 4.0,
                 radius = std::sqrt(cells / constants::kPi);  // [cells]
    const Index tight = 2 * (static_cast<Index>(std::ceil(radius)) + kRoom + kTile);
    const Index nodes = std::max(tight, static_cast<Index>(std::lround(std::sqrt(blob.emptiness * cells))));
    const Index centre = nodes / 2 / kTile * kTile;

    Scene scene;
    scene.bed = bed_of(blob, nodes, centre);
    scene.density = 1291.0;
    const bed::Voellmy voellmy{0.2, 500.0};
    if (blob.friction) scene.bed_law = voellmy;
    if (blob.zones) scene.friction = striped(voellmy, scene.bed);
    if (blob.houses > 0) scene.barriers = village(blob.houses, scene.bed.geometry);
    if (blob.erodes) scene.erodible = loose_ground(scene.bed);
    if (blob.rheology) scene.rheology = rheology::Bingham{2000.0, 50.0};
    scene.scheme.sleep = blob.sleeps;
    if (blob.single) scene.scheme.precision = Precision::single;
    Seeds& seeds = scene.particles;
    const std::vector<Place> places = nearest_places(blob.particles);
    const Index front = first_moving(places, blob.resting);
    for (const Place& place : places) {
        const double x = 0.5 * static_cast<double>(place.i) + 0.25, y = 0.5 * static_cast<double>(place.j) + 0.25;
        const double out = std::hypot(x, y) / radius, depth = kDepth * std::max(0.02, 1.0 - std::pow(out, 4));
        seeds.x.push_back(kCell * (static_cast<double>(centre) + x));
        seeds.y.push_back(kCell * (static_cast<double>(centre) + y));
        const bool moves = place.i >= front;
        seeds.vx.push_back(moves ? 8.0 + 3.0 * x / radius : 0.0);
        seeds.vy.push_back(moves ? 3.0 * y / radius : 0.0);
        seeds.depth.push_back(depth);
        seeds.size.push_back(0.5 * kCell);
        seeds.volume.push_back(depth * 0.25 * kCell * kCell);
    }
    return scene;
}

}  // namespace frana::bench
