#include "checks/bench/body.h"

#include <cmath>

#include "base/constants.h"
#include "base/error.h"

namespace frana::bench {
namespace {

constexpr double kBodyCell = 0.5, kDensity = 1500.0, kSoundSpeed = 40.0, kSpeed = 4.0;
constexpr Index kFreeCells = 12;  ///< free cells around the block

SolidLaw law_of(BodyLaw law) {
    const double bulk = kDensity * kSoundSpeed * kSoundSpeed;
    switch (law) {
        case BodyLaw::fluid:
            return solid::Fluid{bulk, 0.0};
        case BodyLaw::bingham:
            return solid::Bingham{bulk, 5e4, 10.0, 500.0};
        case BodyLaw::drucker_prager: {
            constexpr double kPoisson = 0.3;
            return solid::DruckerPrager::of(solid::Elastic::of_sound(bulk, kPoisson), 30.0 * constants::kPi / 180.0,
                                            0.0);
        }
    }
    throw InternalError("unknown law");
}

}  // namespace

const char* name_of(BodyLaw law) {
    switch (law) {
        case BodyLaw::fluid:
            return "solid_flow";
        case BodyLaw::bingham:
            return "solid_flow_bingham";
        case BodyLaw::drucker_prager:
            return "solid_flow_drucker_prager";
    }
    throw InternalError("unknown law");
}

SolidScene body_scene(BodyLaw law, Index particles) {
    const Index half = std::max<Index>(2, std::lround(std::cbrt(static_cast<double>(particles) / 32.0)));
    SolidScene scene;
    scene.law = law_of(law);
    scene.density = kDensity;
    scene.flip = law == BodyLaw::drucker_prager;  // as stages have sand
    scene.blending = std::sqrt(kBodyCell / 9.81);
    scene.grid.cell = kBodyCell;
    const double room = kBodyCell * static_cast<double>(kFreeCells);
    scene.grid.origin = {-room, -room, -0.5 * room};
    scene.grid.nodes = {2 * half + 2 * kFreeCells + 1, 2 * half + 2 * kFreeCells + 1, half + kFreeCells + 1};
    scene.surfaces = {Surface::plane({0, 0, 0}, {0, 0, 1}, Hold::free, 0.3)};
    const double spacing = 0.5 * kBodyCell, mass = kDensity * spacing * spacing * spacing;
    for (Index k = 0; k < 2 * half; ++k)
        for (Index j = 0; j < 4 * half; ++j)
            for (Index i = 0; i < 4 * half; ++i) {
                const Vec3 x = spacing * Vec3(static_cast<double>(i) + 0.5, static_cast<double>(j) + 0.5,
                                              static_cast<double>(k) + 0.5);
                const double deeper = kBodyCell * static_cast<double>(half) - x.z();
                scene.points.add(x, {kSpeed, 0.25 * kSpeed, 0.0}, mass, kDensity * 9.81 * deeper);
            }
    return scene;
}

}  // namespace frana::bench
