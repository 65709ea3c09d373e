// The keys of [material.structure]: solids that hold together.
#include "law/structured_keys.h"
#include "scene/parameter_makers.h"

namespace frana {

void add_structure(Table& table) {
    using namespace rows;
    const char* const law = "material.structure.law";
    const auto of = [keys = laws::structured_keys()](const char* name) {
        return of_law("material.structure.", keys, name);
    };
    const std::vector<std::string> any_law = {"drucker_prager", "mohr_coulomb"};
    const auto used = [&](Parameter parameter) { return with(std::move(parameter), law, any_law); };
    const auto needed = [&](Parameter parameter) { return with(std::move(parameter), law, any_law, any_law); };
    table.push_back(
        choice(law, {"none", "drucker_prager", "mohr_coulomb"}, "none",
               "where particles that hold together yield: Drucker and Prager's cone or Mohr and Coulomb's pyramid, "
               "the stress across the bed being given by the weight"));
    table.push_back(
        needed(number("material.structure.cohesion", "Pa", not_negative, "cohesion of the undamaged structure")));
    table.push_back(needed(of("friction_angle_deg")));
    table.push_back(used(of("dilatancy_angle_deg")));
    table.push_back(with(choice("material.structure.cone", {"triaxial", "plane_strain"}, "triaxial",
                                "where drucker_prager is as strong as mohr_coulomb"),
                         law, {"drucker_prager"}));
    table.push_back(needed(of("young_modulus")));
    table.push_back(used(of("poisson_ratio")));
    table.push_back(
        absent(instead(used(number("material.structure.bulk_modulus", "Pa", positive,
                                   "stiffness against a change of volume, more than a third of young_modulus")),
                       "material.structure.poisson_ratio"),
               "poisson_ratio decides"));
    table.push_back(used(number("material.structure.fraction", "1", fraction, 1.0,
                                "share of the solids that have structure; the others are grains from the start")));
    table.push_back(
        used(choice("material.structure.earth_pressure", {"rankine", "hydrostatic"}, "rankine",
                    "lateral pressure of grains: by Ka where they spread or rest and towards Kp where they are "
                    "squeezed, or as in the depth-averaged flow, by the pressure of their weight")));
    table.push_back(
        used(number("material.structure.confined_water", "1", {0.0, 1.0, false, true}, 0.0,
                    "share of the particles' volume that is water within the structure; what breaks sets it "
                    "free, and needs water.model")));
    table.push_back(
        used(choice("material.structure.damage", {"dilation", "extension", "strain"}, "dilation",
                    "what breaks bonds while the structure yields: plastic dilation in the plane (van den Bout et "
                    "al. 2021), the largest plastic strain in the plane, or any strain, exponentially (their "
                    "program)")));
    table.push_back(used(of("critical_strain")));
    table.push_back(absent(used(number("material.structure.critical_length", "m", positive,
                                       "cell on which critical_strain holds; on others it is taken times "
                                       "critical_length / cell, so that a crack opens by the same way")),
                           "critical_strain holds on any cell"));
    table.push_back(with(of("onset"), "material.structure.damage", {"strain"}));
    table.push_back(used(number("material.structure.cfl", "1", above_to(0.0, 1.0), 0.4,
                                "largest way of sound and flow in one time step, in cells")));
}

}  // namespace frana
