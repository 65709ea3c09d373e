// Free water: limiter, flux through a face, friction.
#include <cmath>

#include "base/constants.h"
#include "catch.h"
#include "law/friction_step.h"
#include "law/water_friction.h"
#include "water/face_flux.h"

using namespace frana;

namespace {

using constants::kGravity;

FaceFlux<double> flux(const FaceSide<double>& l, const FaceSide<double>& r) {
    return face_flux<double>(l, r, kGravity);
}

}  // namespace

TEST_CASE("A limited change lies between minmod and the mean, and is none at an extremum", "[water][solver]") {
    CHECK(limited<double>(1.0, 3.0, 1.0) == 1.0);
    CHECK(limited<double>(1.0, 3.0, 1.5) == 1.5);
    CHECK(limited<double>(1.0, 3.0, 2.0) == 2.0);
    CHECK(limited<double>(3.0, 5.0, 2.0) == 4.0);
    CHECK(limited<double>(-3.0, -1.0, 2.0) == -2.0);
    CHECK(limited<double>(-5.0, -5.0, 1.0) == -5.0);
    CHECK(limited<double>(1.0, -1.0, 2.0) == 0.0);
    CHECK(limited<double>(0.0, 1.0, 2.0) == 0.0);
}

TEST_CASE("Water that stands level does not flow through a face, to the last bit", "[water][solver]") {
    for (const double level : {1.0, 0.7, 0.3, 1e-5}) {
        const double low = 0.1, high = 0.25;
        const FaceSide<double> l{std::max(0.0, level - low), low, 0, 0}, r{std::max(0.0, level - high), high, 0, 0};
        for (const FaceFlux<double>& f : {flux(l, r), flux(r, l)}) {
            CHECK(f.mass == 0.0);
            CHECK(std::abs(f.low) < 1e-16);  // (level - low) - (high - low) rounds otherwise than level - high
            CHECK(std::abs(f.high) < 1e-16);
        }
    }
    const FaceFlux<double> flat = flux({0.4, 1.7, 0, 0}, {0.4, 1.7, 0, 0});
    CHECK((flat.low == 0.0 && flat.high == 0.0));
}

TEST_CASE("Flow faster than waves takes its own flux across a face, either way", "[water][solver]") {
    const double h = 0.5, u = 4.0, v = 0.3;
    const FaceFlux<double> east = flux({h, 0, u, v}, {0.1, 0, 5.0, -1.0}),
                           west = flux({0.1, 0, -5.0, -1.0}, {h, 0, -u, v});
    CHECK(east.mass == Approx(h * u).epsilon(1e-14));
    CHECK(east.across == Approx(h * u * v).epsilon(1e-14));
    CHECK(east.along + east.low == Approx(h * u * u).epsilon(1e-14));  // low: less its own pressure
    CHECK(east.along + east.high == Approx(h * u * u + 0.5 * kGravity * (h * h - 0.01)).epsilon(1e-14));
    CHECK(west.mass == Approx(-h * u).epsilon(1e-14));
    CHECK(west.along + west.high == Approx(h * u * u).epsilon(1e-14));
}

TEST_CASE("A flux mirrors, and takes along-face velocity from where the water comes", "[water][solver]") {
    const FaceSide<double> l{1.0, 0.2, 0.7, 0.3}, r{0.4, 0.5, -0.2, -0.6};
    const FaceFlux<double> f = flux(l, r),
                           g = flux({r.depth, r.ground, -r.along, r.across}, {l.depth, l.ground, -l.along, l.across});
    CHECK(f.mass == Approx(-g.mass).epsilon(1e-14));
    CHECK(f.mass > 0.0);
    CHECK(f.across == Approx(0.3 * f.mass).epsilon(1e-14));
    CHECK(f.along + f.low == Approx(g.along + g.high).epsilon(1e-14));
    CHECK(f.along + f.high == Approx(g.along + g.low).epsilon(1e-14));
}

TEST_CASE("Dry ground takes water at the speed of a dam's tip, unless it is a wall", "[water][solver]") {
    const double h = 2.0, c = std::sqrt(kGravity * h);
    const FaceFlux<double> f = flux({h, 0, 0, 0}, {0, 0, 0, 0});
    CHECK(f.mass == Approx(2.0 / 3.0 * h * c).epsilon(1e-14));  // waves from -c to 2 c
    CHECK(f.along + f.low + 0.5 * kGravity * h * h == Approx((2.0 / 3.0) * 0.5 * kGravity * h * h).epsilon(1e-14));
    const FaceFlux<double> wall = flux({h, 0, 0, 0}, {0, 2.5, 0, 0}), none = flux({0, 0, 0, 0}, {0, 1, 0, 0});
    CHECK((wall.mass == 0.0 && wall.low == 0.0 && wall.high == 0.0));
    CHECK((none.mass == 0.0 && none.low == 0.0 && none.high == 0.0));
}

TEST_CASE("Manning's and Darcy and Weisbach's friction brake by their laws, along a steep bed by its own lengths",
          "[water][solver]") {
    using Law = WaterFriction::Law;
    const WaterBed bed{kGravity, 0.8, 1.25};
    const double manning = quadratic_drag({Law::manning, 0.04}, bed),
                 darcy = quadratic_drag({Law::darcy_weisbach, 0.05}, bed);
    CHECK(manning == Approx(kGravity * 0.04 * 0.04 * 1.25 / std::pow(0.8, 4.0 / 3.0)).epsilon(1e-14));
    CHECK(darcy == Approx(0.05 / 8.0 * 1.25 / 0.8).epsilon(1e-14));
    CHECK(quadratic_drag({}, bed) == 0.0);
    // n and f of one stress: f = 8 g n^2 / T^(1/3)
    CHECK(quadratic_drag({Law::darcy_weisbach, 8 * kGravity * 0.04 * 0.04 / std::cbrt(0.8)}, bed) ==
          Approx(manning).epsilon(1e-14));
}
