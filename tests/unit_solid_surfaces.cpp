// 3D rigid surfaces: distances, mirror images, shares of an impulse.
#include "base/constants.h"
#include "catch.h"
#include "law/solid/laws.h"
#include "solid3d/mirror_batch.h"
#include "solid3d/surfaces.h"

using namespace frana;

namespace {

std::vector<MirrorParticle> mirrors_of(const std::vector<Surface>& surfaces, const Vec3& x) {
    const MirrorParticles mirrors(surfaces, (SurfaceSet{1} << surfaces.size()) - 1, x, 1.0);
    return {mirrors.begin(), mirrors.end()};
}

}  // namespace

TEST_CASE("A point near one plane has one mirror particle; beyond the reach of its nodes, none", "[solid]") {
    const std::vector<Surface> floor = {Surface::plane({0, 0, 1}, {0, 0, 1})};
    const auto one = mirrors_of(floor, {5, 6, 3.5});
    REQUIRE(one.size() == 1);
    CHECK((one[0].place - Vec3(5, 6, -1.5)).norm() < 1e-15);
    CHECK((one[0].motion * Vec3(1, 2, 3) - Vec3(1, 2, -3)).norm() < 1e-15);
    CHECK(mirrors_of(floor, {5, 6, 4.1}).empty());
}

TEST_CASE("In a corner of three planes the eight points are symmetric in each plane", "[solid]") {
    const std::vector<Surface> corner = {Surface::plane({0, 0, 0}, {1, 0, 0}), Surface::plane({0, 0, 0}, {0, 1, 0}),
                                         Surface::plane({0, 0, 0}, {0, 0, 1})};
    const Vec3 x(0.5, 1.0, 1.5);
    const auto seven = mirrors_of(corner, x);
    REQUIRE(seven.size() == 7);
    Vec3 sum = x, motion = Vec3(1, 1, 1);
    for (const MirrorParticle& mirror : seven) {
        sum += mirror.place, motion += mirror.motion * Vec3(1, 1, 1);
        CHECK((mirror.place - mirror.turn * x).norm() < 1e-15);
    }
    CHECK(sum.norm() < 1e-14);
    CHECK(motion.norm() < 1e-14);
}

TEST_CASE("A stuck surface turns velocities round, and two sides of a slice have no common corner", "[solid]") {
    const std::vector<Surface> slice = {Surface::plane({0, 0, 0}, {0, 1, 0}, Hold::stuck),
                                        Surface::plane({0, 2, 0}, {0, -1, 0})};
    const auto mirrors = mirrors_of(slice, {0, 0.5, 0});
    REQUIRE(mirrors.size() == 2);
    CHECK((mirrors[0].motion * Vec3(1, 2, 3) + Vec3(1, 2, 3)).norm() < 1e-15);
    CHECK((mirrors[1].place - Vec3(0, 3.5, 0)).norm() < 1e-15);
}

TEST_CASE("Behind a stuck surface mirror particles of a bending flow go on with its bend, also in corners", "[solid]") {
    // Along the floor z = 0 the speeds (2, -1) z + bend z^2: at rest on it; a side at y = 0 mirrors them. Speeds whose
    // gradient is gone at the point have just met the floor: they are turned round as they are. So are those of a layer
    // that is faster over its height than the shear velocity of its stress times sqrt(2).
    const bool bends = GENERATE(true, false), viscous = GENERATE(true, false), settled = bends && viscous;
    const Vec3 slope(2, -1, 0), x(4.0, 1.2, 1.1), bend = (bends ? -0.15 : -0.5 / x.z()) * slope;
    const std::vector<Surface> corner = {Surface::plane({0, 0, 0}, {0, 0, 1}, Hold::stuck),
                                         Surface::plane({0, 0, 0}, {0, 1, 0})};
    MaterialPoints q;
    q.each([](Array& array) { array.assign(1, 0.0); });
    q.mass[0] = 3.0, q.rest_volume[0] = 1.0, q.j[0] = 1.0;
    for (int k = 0; k < 3; ++k) {
        q.v[static_cast<std::size_t>(k)][0] = slope[k] * x.z() + bend[k] * x.z() * x.z();
        q.gradient[static_cast<std::size_t>(6 + k)][0] = slope[k] + 2.0 * bend[k] * x.z();
    }
    // Of a density of 3 and the point's shear rate: (rate z)^2 is the viscosity times the rate over the density.
    const double rate = (slope + 2.0 * bend * x.z()).norm(), least = 3.0 * rate * x.z() * x.z();
    int held = 0;
    for (const MirrorParticle& mirror : mirrors_of(corner, x)) {
        if (mirror.place.z() > 0.0) continue;
        MirrorBatch batch;
        batch.add(0, mirror.place, mirror, 1.0);
        batch.fill();
        const BatchContribution contribution = mirrored_contribution<true>(
            solid::Fluid{1e6, (viscous ? 1.01 : 0.49) * least}, q, batch, Vec3::Zero(), 1e-6);
        const double z = mirror.place.z();
        for (int k = 0; k < 3; ++k) {
            const double side = k == 1 && mirror.place.y() < 0.0 ? -1.0 : 1.0;
            const double speed = settled ? slope[k] * z + bend[k] * z * z : slope[k] * z - bend[k] * z * z;
            const double gradient = slope[k] + (settled ? 2.0 : -2.0) * bend[k] * z;
            CHECK(contribution.momentum[k][0] / 3.0 == Approx(side * speed).margin(1e-14));
            CHECK(contribution.affine[2][k][0] / 3.0 == Approx(side * gradient).margin(1e-14));
            CHECK(contribution.affine[0][k][0] == 0.0);
        }
        ++held;
    }
    CHECK(held == 2);
}

TEST_CASE("A side that meets no other shows its mirror particles as a lone one, also between two others", "[solid]") {
    // Two sides that meet, and one opposite to both: more than 120 degrees from each.
    const std::vector<Surface> sides = {Surface::plane({0, 0, 0}, {1, 0, 0}), Surface::plane({0, 0, 0}, {0.8, 0.6, 0}),
                                        Surface::plane({2, 0, 0}, {-1, 0, 0})};
    int alone = 0;
    for (const MirrorParticle& mirror : mirrors_of(sides, {1.0, 0.5, 0.0})) {
        const bool in_third = mirror.place.x() > 2.0;
        alone += in_third;
        CHECK((mirror.slides == 0) == in_third);
    }
    CHECK(alone == 1);
}

TEST_CASE("Images bend with one stuck plane, not in a corner of two or in one that leans", "[solid]") {
    const Surface floor = Surface::plane({0, 0, 0}, {0, 0, 1}, Hold::stuck);
    const auto bent = [](const Surface& one, const Surface& other, const Vec3& x) {
        int count = 0;
        for (const MirrorParticle& mirror : mirrors_of({one, other}, x)) count += mirror.held_above > 0.0;
        return count;
    };
    const Vec3 x(5.0, 0.5, 0.5);
    CHECK(bent(floor, Surface::plane({0, 0, 0}, {0, 1, 0}), x) == 2);               // its own and the corner's
    CHECK(bent(Surface::plane({0, 0, 0}, {0, 1, 0}), floor, x) == 2);               // whichever comes first
    CHECK(bent(floor, Surface::plane({0, 0, 0}, {0, 1, 0}, Hold::stuck), x) == 2);  // each its own, none in the corner
    CHECK(bent(floor, Surface::plane({0, 0, 0}, {0, 1, 0.2}), x) == 1);
}

TEST_CASE("The ground's tangent plane is exact on a tilted bilinear bed", "[solid]") {
    Raster bed = Raster::filled({5, 4, 10.0, 20.0, 2.0}, 0.0);
    for (Index j = 0; j < 4; ++j)
        for (Index i = 0; i < 5; ++i) bed.at(i, j) = 3.0 + 0.5 * bed.geometry.x(i) - 0.25 * bed.geometry.y(j);
    const Surface ground = Surface::ground(bed);
    const Contact c = contact(ground, {13.3, 23.7, 10.0});
    const Vec3 normal = Vec3(-0.5, 0.25, 1.0).normalized();
    CHECK((c.normal - normal).norm() < 1e-14);
    CHECK(c.distance == Approx((10.0 - 3.0 - 0.5 * 13.3 + 0.25 * 23.7) * normal.z()).epsilon(1e-13));
}

TEST_CASE("A box is near a surface when its nearest corner is", "[solid]") {
    const std::vector<Surface> list = {Surface::plane({0, 0, 0}, {0, 0, 1}),
                                       Surface::ground(Raster::filled({4, 4, 0, 0, 1}, 2.0))};
    CHECK(surfaces_near(list, {0, 0, 1}, {1, 1, 2}, 0.1, 0.0) == 2u);  // below the ground counts
    CHECK(surfaces_near(list, {0, 0, 2.2}, {1, 1, 3}, 0.1, 0.0) == 2u);
    CHECK(surfaces_near(list, {0, 0, 2.4}, {1, 1, 3}, 0.1, 0.0) == 0u);
    CHECK(surfaces_near(list, {0, 0, 2.4}, {1, 1, 3}, 0.1, 0.2) == 2u);
}

TEST_CASE("In corners of any width no mirror particle stands where material may be", "[solid]") {
    const double wide = GENERATE(60.0, 70.0, 90.0, 110.0, 130.0, 150.0, 170.0) * constants::kPi / 180.0;
    // A floor towards +x, and a plane that rises from the origin at the angle `wide` to it.
    const std::vector<Surface> corner = {Surface::plane({0, 0, 0}, {0, 0, 1}),
                                         Surface::plane({0, 0, 0}, {std::sin(wide), 0, -std::cos(wide)})};
    for (const double share : {0.1, 0.3, 0.5, 0.7, 0.9}) {
        const double angle = share * wide;
        for (const MirrorParticle& mirror : mirrors_of(corner, {1.5 * std::cos(angle), 0, 1.5 * std::sin(angle)})) {
            CAPTURE(wide, share, mirror.place.x(), mirror.place.z());
            CHECK((contact(corner[0], mirror.place).distance < 1e-12 ||
                   contact(corner[1], mirror.place).distance < 1e-12));
        }
    }
}
