#include "checks/verify/problem.h"

#include <fmt/core.h>

#include <cmath>

namespace frana::verify {

double Measurement::value(const std::string& quantity) const {
    const std::pair<const char*, double> known[] = {
        {"l1_depth", l1_depth},        {"l2_depth", l2_depth},         {"linf_depth", linf_depth},
        {"l1_momentum", l1_momentum},  {"l2_momentum", l2_momentum},   {"front_error", front_error},
        {"mass_error", mass_error},    {"energy_error", energy_error}, {"observed_order", observed_order},
        {"wall_seconds", wall_seconds}};
    for (const auto& [name_of, number] : known)
        if (quantity == name_of) return number;
    for (const Extra& extra : extras)
        if (quantity == extra.name) return extra.value;
    return kNone;
}

void Measurement::add(const std::string& extra, double number, const std::string& unit) {
    extras.push_back({extra, number, unit});
}

std::vector<Index> grids_of(const Problem& problem, bool coarse) {
    std::vector<Index> grids = problem.grids;
    if (coarse && problem.finest_is_long) grids.pop_back();
    return grids;
}

std::vector<Measurement> measure(const Problem& problem, Setup setup, const std::vector<Index>& grids) {
    std::vector<Measurement> results;
    for (const Index cells : grids) {
        setup.cells = cells;
        Measurement m = problem.run(setup);
        m.name = problem.name;
        m.preset = setup.preset;
        m.cells = cells;
        m.per_side = setup.per_side;
        m.dimensions = problem.in_3d ? 3 : 2;
        if (!results.empty() && results.back().cells != cells) {
            const double coarse = std::abs(results.back().value(problem.order_of));
            const double fine = std::abs(m.value(problem.order_of));
            const double ratio = static_cast<double>(cells) / static_cast<double>(results.back().cells);
            constexpr double kRoundOff = 1e-12;  // below it an order says nothing
            if (fine > kRoundOff) m.observed_order = std::log(coarse / fine) / std::log(ratio);
        }
        results.push_back(std::move(m));
    }
    return results;
}

std::vector<std::string> missed_gates(const Problem& problem, const std::vector<Measurement>& measurements) {
    std::vector<std::string> missed;
    for (const Gate& gate : problem.gates)
        for (const Measurement& m : measurements) {
            if ((gate.cells != 0 && gate.cells != m.cells) || m.preset != "default" || m.per_side != 2) continue;
            const double value = m.value(gate.quantity);
            if (!(std::abs(value) <= gate.bound))  // also when it is not a number
                missed.push_back(fmt::format("{} at {} cells: {} is {:.3g}, the gate is {:.3g} ({})", problem.name,
                                             m.cells, gate.quantity, value, gate.bound, gate.source));
        }
    return missed;
}

}  // namespace frana::verify
