// Rigid surfaces in space: distances, mirror images, shares of an impulse.
#include "catch.h"
#include "solid/surfaces.h"

using namespace frana;

namespace {

std::vector<Image> images_of(const std::vector<Surface>& surfaces, const Vec3& x) {
    const Images images(surfaces, (SurfaceSet{1} << surfaces.size()) - 1, x, 1.0);
    return {images.begin(), images.end()};
}

}  // namespace

TEST_CASE("A point near one plane has one image; beyond the reach of its nodes, none", "[solid]") {
    const std::vector<Surface> floor = {Surface::plane({0, 0, 1}, {0, 0, 1})};
    const auto one = images_of(floor, {5, 6, 3.5});
    REQUIRE(one.size() == 1);
    CHECK((one[0].place - Vec3(5, 6, -1.5)).norm() < 1e-15);
    CHECK((one[0].motion * Vec3(1, 2, 3) - Vec3(1, 2, -3)).norm() < 1e-15);
    CHECK(images_of(floor, {5, 6, 4.1}).empty());
}

TEST_CASE("In a corner of three planes the eight points are symmetric in each plane", "[solid]") {
    const std::vector<Surface> corner = {Surface::plane({0, 0, 0}, {1, 0, 0}),
                                         Surface::plane({0, 0, 0}, {0, 1, 0}),
                                         Surface::plane({0, 0, 0}, {0, 0, 1})};
    const Vec3 x(0.5, 1.0, 1.5);
    const auto seven = images_of(corner, x);
    REQUIRE(seven.size() == 7);
    Vec3 sum = x, motion = Vec3(1, 1, 1);
    for (const Image& image : seven) {
        sum += image.place, motion += image.motion * Vec3(1, 1, 1);
        CHECK((image.place - image.turn * x).norm() < 1e-15);
    }
    CHECK(sum.norm() < 1e-14);
    CHECK(motion.norm() < 1e-14);
}

TEST_CASE("A stuck surface turns velocities round, and two sides of a slice have no common corner",
          "[solid]") {
    const std::vector<Surface> slice = {Surface::plane({0, 0, 0}, {0, 1, 0}, Hold::stuck),
                                        Surface::plane({0, 2, 0}, {0, -1, 0})};
    const auto images = images_of(slice, {0, 0.5, 0});
    REQUIRE(images.size() == 2);
    CHECK((images[0].motion * Vec3(1, 2, 3) + Vec3(1, 2, 3)).norm() < 1e-15);
    CHECK((images[1].place - Vec3(0, 3.5, 0)).norm() < 1e-15);
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

TEST_CASE("In corners of any width no image stands where material may be", "[solid]") {
    const double wide = GENERATE(60.0, 70.0, 90.0, 110.0, 130.0, 150.0, 170.0) * M_PI / 180.0;
    // A floor towards +x, and a plane that rises from the origin at the angle `wide` to it.
    const std::vector<Surface> corner = {Surface::plane({0, 0, 0}, {0, 0, 1}),
                                         Surface::plane({0, 0, 0}, {std::sin(wide), 0, -std::cos(wide)})};
    for (const double share : {0.1, 0.3, 0.5, 0.7, 0.9}) {
        const double angle = share * wide;
        for (const Image& image : images_of(corner, {1.5 * std::cos(angle), 0, 1.5 * std::sin(angle)})) {
            CAPTURE(wide, share, image.place.x(), image.place.z());
            CHECK((contact(corner[0], image.place).distance < 1e-12 ||
                   contact(corner[1], image.place).distance < 1e-12));
        }
    }
}
