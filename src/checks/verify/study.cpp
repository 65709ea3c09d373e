#include "checks/verify/study.h"

#include <fmt/core.h>

#include <cmath>
#include <map>
#include <tuple>

#include "base/error.h"
#include "checks/verify/library.h"

namespace frana::verify {
namespace {

/// A change of one number of the scheme.
template <class Member, class Number>
Component with(const std::string& name, Member member, Number number) {
    return {name, [member, number](Scene& scene) { scene.scheme.*member = number; }};
}

}  // namespace

const std::vector<Component>& components() {
    static const std::vector<Component> all = {
        {"default", {}},
        {"shape linear", [](Scene& s) { s.scheme.shape = Shape::linear, s.scheme.cfl = 0.5; }},  // its default
        with("shape cubic", &Scheme::shape, Shape::cubic),
        with("transfer apic", &Scheme::transfer, Transfer::apic),
        with("transfer flip", &Scheme::transfer, Transfer::flip),
        with("transfer pic", &Scheme::transfer, Transfer::pic),
        with("no sub-points", &Scheme::sub_point_reach, 0.0),
        with("no margin", &Scheme::margin, false),
        with("margin linear", &Scheme::margin_limit, 0.0),
        with("no filter", &Scheme::filter, 0.0),
        with("no wave shift", &Scheme::wave_shift, 0.0),
        {"no viscosity", [](Scene& s) { s.scheme.viscosity_linear = s.scheme.viscosity_quadratic = 0.0; }},
        with("viscosity c1 0.1", &Scheme::viscosity_linear, 0.1),
        with("no shock gate", &Scheme::shock_gate, 0.0),
        with("no shock sensor", &Scheme::shock_sensor, 0.0),
        with("no splitting", &Scheme::split, false),
        with("no merging", &Scheme::merge, false),
        with("no domain reset", &Scheme::reset_domains, false),
        with("split at 0.3 m_max", &Scheme::split_min_mass, 0.3),
        with("no mass fit", &Scheme::mass_fit, false),
        with("cfl 0.25", &Scheme::cfl, 0.25),
        with("cfl 0.5", &Scheme::cfl, 0.5),
        {"1 point a cell", [](Scene& s) { s.scheme.split_length = 1.2; }, 1},
        {"9 points a cell", {}, 3},
    };
    return all;
}

const std::vector<StudyColumn>& study_columns() {
    static const std::vector<StudyColumn> all = {
        {"lake_bump", 100, "max_speed", "lake v"},
        {"ritter", 200, "l1_depth", "ritter"},
        {"stoker", 200, "l1_depth", "stoker"},
        {"stoker", 200, "total_variation", "stoker TV"},
        {"thacker_planar", 50, "l1_depth", "planar"},
        {"thacker_radial", 50, "l1_depth", "radial"},
        {"thacker_radial", 50, "energy_drift", "rad. dE"},
        {"coulomb_slope", 200, "l1_depth", "coul.slope"},
        {"sliding_cap", 200, "l1_depth", "cap"},
        {"similarity", 80, "l2_depth", "similarity"},
        {"energy_parabola", 200, "stop_error", "en. line"},
    };
    return all;
}

std::string study_head() {
    std::string text = fmt::format("{:18}", "component");
    for (const StudyColumn& column : study_columns()) text += fmt::format(" {:>10}", column.head);
    return text + fmt::format(" {:>8}", "points");
}

std::string study_row(const Component& component) {
    std::string text = fmt::format("{:18}", component.name);
    std::map<std::pair<std::string, Index>, Measurement> done;  // a run serves all its columns
    Index points = 0;
    for (const StudyColumn& column : study_columns()) {
        const Problem* problem = find_problem(column.problem);
        expect(problem != nullptr, "a problem of the study that the library does not know");
        const auto key = std::make_pair(column.problem, column.cells);
        if (!done.count(key)) {
            Setup setup;
            setup.cells = column.cells;
            setup.per_side = component.per_side;
            setup.edit = component.edit;
            try {
                done[key] = problem->run(setup);
                points += done[key].particles;
            } catch (const NumericsError&) {
                done[key] = Measurement{};
            }
        }
        const double value = done[key].value(column.quantity);
        text += fmt::format(" {:>10}", std::isnan(value) ? "failed" : fmt::format("{:.2e}", value));
    }
    return text + fmt::format(" {:>8}", points);
}

}  // namespace frana::verify
