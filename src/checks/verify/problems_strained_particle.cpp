// One structured particle against closed forms of its law: simple shear, unconfined compression.
#include <algorithm>
#include <chrono>
#include <cmath>

#include "checks/verify/library.h"
#include "checks/verify/strained_particle.h"

namespace frana::verify {
namespace {

constexpr double kShear = 2.0;  ///< gamma: the shear stress is past its maximum, the normal stresses are as large

Measurement timed(const std::function<void(Measurement&)>& measure) {
    const auto start = std::chrono::steady_clock::now();
    Measurement m;
    m.particles = 1;
    measure(m);
    m.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return m;
}

Measurement run_jaumann_shear(const Setup& setup) {
    return timed([&](Measurement& m) {
        const ShearError error = jaumann_shear_error(kShear, static_cast<int>(setup.cells));
        m.steps = setup.cells;
        m.add("shear_error", error.shear);
        m.add("normal_error", error.along);
        m.add("error", error.size());
        m.add("plane_error", error.along + error.across);
    });
}

/// Two clays, whose strengths are printed in van den Bout et al. (2021, doi:10.5194/gmd-14-1841-2021).
struct PrintedStrength {
    double cohesion, friction_deg, bears;  ///< [Pa], [deg], [Pa]
};
constexpr PrintedStrength kStiff{26.7e3, 28.0, 88.87e3}, kSoft{18.3e3, 27.0, 59.73e3};

Measurement run_unconfined_compression(const Setup&) {
    return timed([](Measurement& m) {
        const auto worst = [](StructuredYield yield) {
            double error = 0.0;
            for (const PrintedStrength& clay : {kStiff, kSoft}) {
                const StructuredLaw law(unbroken_clay(clay.friction_deg, yield));
                error = std::max(
                    error,
                    std::abs(squeezed_strength(law, clay.cohesion) / unconfined_strength(law, clay.cohesion) - 1.0));
            }
            return error;
        };
        m.add("strength", squeezed_strength(StructuredLaw(unbroken_clay(kStiff.friction_deg)), kStiff.cohesion), "Pa");
        m.add("cone_error", worst(StructuredYield::compression));
        m.add("hexagon_error", worst(StructuredYield::hexagon));
        m.add("plane_strain_error", worst(StructuredYield::plane_strain));
    });
}

std::vector<Residual> unconfined_residuals() {
    std::vector<Residual> list;
    for (const PrintedStrength& clay : {kStiff, kSoft})
        list.push_back(
            {"strength of a clay less what is printed [Pa]",
             unconfined_strength(StructuredLaw(unbroken_clay(clay.friction_deg)), clay.cohesion) - clay.bears,
             5.0});  // the last digit
    return list;
}

}  // namespace

std::vector<Problem> strained_particle_problems() {
    Problem shear{"jaumann_shear",
                  "a structured particle in simple shear by 2, on so many steps: G sin(2) and G (1 - cos(2))",
                  {100, 200, 400},
                  {},
                  run_jaumann_shear};
    shear.order_of = "error";
    const std::string second = "a return of first order has 1.4e-2 at 100 steps; falls with the square of their number";
    shear.gates = {{100, "error", 1e-4, second},
                   {200, "error", 2.5e-5, second},
                   {400, "error", 6.25e-6, second},
                   {0, "plane_error", 1e-12, "round-off"}};
    Problem unconfined{"unconfined_compression",
                       "a structured particle squeezed along x bears 2 c cos(phi) / (1 - sin(phi))",
                       {400},
                       unconfined_residuals,
                       run_unconfined_compression};
    unconfined.order_of = "cone_error";
    const std::string returned = "the return stops within 1e-7 of the strength, which the cone's slope multiplies";
    unconfined.gates = {{0, "cone_error", 1e-6, returned},
                        {0, "hexagon_error", 1e-6, returned},
                        {0, "plane_strain_error", 1e-6, returned}};
    shear.has_presets = unconfined.has_presets = false;
    return {shear, unconfined};
}

}  // namespace frana::verify
