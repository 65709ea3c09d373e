#include "checks/verify/strained_particle.h"

#include <cmath>

#include "base/constants.h"

namespace frana::verify {

using constants::kDegree;

StructuredMaterial unbroken_clay(double friction_deg, StructuredYield yield, double dilatancy_deg) {
    StructuredMaterial m;
    m.young = 5e6;
    m.friction = friction_deg * kDegree, m.dilatancy = dilatancy_deg * kDegree;
    m.yield = yield;
    m.critical_strain = 1e9;
    return m;
}

StructuredState strained(const StructuredLaw& law, int steps, const StructuredStep& each, double weight,
                         double cohesion, StructuredState state) {
    for (int n = 0; n < steps; ++n) law.update(each, weight, cohesion, state);
    return state;
}

StructuredState squeezed_alone(const StructuredLaw& law, double total, double weight, double cohesion) {
    constexpr int kSteps = 400;
    StructuredState state;
    state.stress.zz = weight;
    for (int n = 0; n < kSteps; ++n) {
        const double dx = total / kSteps;
        double low = -std::abs(dx) * 3.0, high = std::abs(dx) * 3.0;
        StructuredState next;
        for (int pass = 0; pass < 60; ++pass) {
            const double mid = 0.5 * (low + high);
            next = state;
            law.update({dx, mid, 0.0, 0.0}, weight, cohesion, next);
            (next.stress.yy > 0.0 ? high : low) = mid;
        }
        state = next;
    }
    return state;
}

double ShearError::size() const { return std::hypot(shear, along); }

ShearError jaumann_shear_error(double gamma, int steps) {
    constexpr double kUnyielding = 1e12;  // cohesion [Pa]
    const StructuredLaw law(unbroken_clay(28.0));
    const StructuredStress s =
        strained(law, steps, StructuredStep::of(0.0, gamma / steps, 0.0, 0.0, 1.0), 0.0, kUnyielding).stress;
    const double g = law.shear(), normal = 1.0 - std::cos(gamma);
    return {s.xy / g - std::sin(gamma), s.xx / g - normal, s.yy / g + normal};
}

double unconfined_strength(const StructuredLaw& law, double cohesion) {
    if (law.material().yield == StructuredYield::plane_strain)
        return law.strength(cohesion) / (1.0 / std::sqrt(3.0) - law.alpha());
    const double phi = law.material().friction;
    return 2.0 * cohesion * std::cos(phi) / (1.0 - std::sin(phi));
}

double squeezed_strength(const StructuredLaw& law, double cohesion) {
    return -squeezed_alone(law, -0.1, 0.0, cohesion).stress.xx;
}

}  // namespace frana::verify
