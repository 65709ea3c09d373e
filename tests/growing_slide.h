#pragma once
// A slide on a part of a large terrain, which grows.
#include <cmath>
#include <cstring>
#include <memory>

#include "catch.h"
#include "coupling/growing_particles.h"
#include "fake_gis.h"

namespace frana::test {

/// Down to the west, with bumps, and rough at the node: whole metres and eighths, which every grid has alike.
inline double ground(double x, double y) {
    const double bumps = 3.0 * std::sin(0.01 * x) * std::cos(0.013 * y);
    const auto i = static_cast<std::int64_t>(x), j = static_cast<std::int64_t>(y);
    return 0.5 * x + bumps + 0.125 * static_cast<double>((7 * i + 13 * j) % 5);
}

inline Raster ground_on(const GridGeometry& grid) {
    Raster bed = Raster::filled(grid, 0.0);
    for (Index j = 0; j < grid.ny; ++j)
        for (Index i = 0; i < grid.nx; ++i) bed.at(i, j) = ground(grid.x(i), grid.y(j));
    return bed;
}

/// A flow that begins at 4000, 1000 on nodes of 5 m; `held` are nodes of the terrain.
inline Scene slide_on(const GridGeometry& terrain, const NodeBox& held) {
    Scene scene;
    scene.bed = ground_on(held.of(terrain));
    scene.wider = std::make_shared<WiderTerrain>(
        WiderTerrain{terrain, held, [terrain](const NodeBox& box) { return ground_on(box.of(terrain)); }, {}});
    scene.bed_law = bed::Coulomb{0.1};
    for (int j = -4; j < 4; ++j)
        for (int i = -4; i < 4; ++i) {
            Seeds& s = scene.particles;
            s.x.push_back(4000.0 + 2.5 * i), s.y.push_back(1000.0 + 2.5 * j);
            s.vx.push_back(0.0), s.vy.push_back(0.0);
            s.volume.push_back(6.25), s.depth.push_back(1.0), s.size.push_back(2.5);
        }
    scene.end = 1e9;
    return scene;
}

constexpr GridGeometry kLarge{1000, 400, 0.0, 0.0, 5.0};
/// A part of the large terrain's nodes that holds all that the run ever needs, and no multiple of a tile away.
constexpr NodeBox kCut{397, 93, 520, 230};
constexpr NodeBox kBegin{720, 120, 160, 160};  ///< nodes of the large terrain around the start

inline Scene slide_on_large() { return slide_on(kLarge, kBegin); }
inline Scene slide_on_cut() {
    return slide_on(kCut.of(kLarge), {kBegin.i0 - kCut.i0, kBegin.j0 - kCut.j0, kBegin.nx, kBegin.ny});
}

/// A plane that falls to the west, on nodes of which a scene takes a part.
class LargeGis : public FakeGis {
public:
    explicit LargeGis(const GridGeometry& grid) : grid_(grid) {}
    Raster read_dem(const std::filesystem::path&, const DemRequest& request, std::vector<std::string>&) const override {
        return plane_on(request.choose({grid_, {}, "", ""}));
    }
    std::function<Raster(const NodeBox&)> read_dem_later(const std::filesystem::path&,
                                                         const DemRequest&) const override {
        return [this](const NodeBox& box) { return plane_on(box); };
    }
    Raster plane_on(const NodeBox& box) const {
        return sampled(box.of(grid_), [](double x, double) { return 0.1 * x; });
    }

private:
    GridGeometry grid_;
};

inline bool same_bits(const Field& a, const Field& b) {
    return a.name == b.name && a.count == b.count && a.components == b.components &&
           std::memcmp(a.data, b.data, static_cast<std::size_t>(a.count * a.components) * sizeof(double)) == 0;
}

inline void require_same(Simulation& a, Simulation& b) {
    const Frame one = a.frame(), other = b.frame();
    REQUIRE(one.grid == other.grid);
    REQUIRE(one.status.step == other.status.step);
    REQUIRE(one.status.time == other.status.time);
    REQUIRE(one.particles.size() == other.particles.size());
    for (std::size_t n = 0; n < one.particles.size(); ++n) REQUIRE(same_bits(one.particles[n], other.particles[n]));
    REQUIRE(one.nodes.size() == other.nodes.size());
    for (std::size_t n = 0; n < one.nodes.size(); ++n) REQUIRE(same_bits(one.nodes[n], other.nodes[n]));
}

}  // namespace frana::test
