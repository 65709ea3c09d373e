#include "checks/verify/library.h"

#include <algorithm>

namespace frana::verify {

const std::vector<Problem>& library() {
    static const std::vector<Problem> all = [] {
        std::vector<Problem> problems;
        for (const auto& room : {dam_break_problems,
                                 bowl_problems,
                                 lake_problems,
                                 paper_problems,
                                 pile_problems,
                                 radial_dam_problems,
                                 slope_flow_problems,
                                 similarity_problems,
                                 block_problems,
                                 zone_problems,
                                 track_problems,
                                 bed_step_problems,
                                 sheet_problems,
                                 deposit_problems,
                                 spreading_problems,
                                 conversion_problems,
                                 tank_problems,
                                 bore_problems,
                                 dam_obstacle_problems,
                                 rest_problems,
                                 body_problems,
                                 column_problems,
                                 slump_problems,
                                 mud_problems,
                                 bagnold_problems,
                                 erosion_problems,
                                 bed_wave_problems,
                                 collapse_problems,
                                 detrainment_problems,
                                 structured_problems,
                                 structured_case_problems,
                                 strained_particle_problems,
                                 inflow_problems,
                                 water_problems,
                                 water_slope_problems,
                                 water_viscous_problems})
            for (Problem& problem : room()) problems.push_back(std::move(problem));
        return problems;
    }();
    return all;
}

const std::vector<Alias>& aliases() {
    static const std::vector<Alias> all = {
        {"energy_line", {"energy_parabola", "energy_hockey", "energy_avaframe"}, "energy lines on three tracks"}};
    return all;
}

std::vector<std::string> without_aliases(const std::vector<std::string>& names) {
    std::vector<std::string> plain;
    const auto add = [&](const std::string& name) {
        if (std::find(plain.begin(), plain.end(), name) == plain.end()) plain.push_back(name);
    };
    for (const std::string& name : names) {
        const auto alias =
            std::find_if(aliases().begin(), aliases().end(), [&](const Alias& one) { return one.name == name; });
        if (alias == aliases().end())
            add(name);
        else
            for (const std::string& problem : alias->problems) add(problem);
    }
    return plain;
}

const Problem* find_problem(const std::string& name) {
    for (const Problem& problem : library())
        if (problem.name == name) return &problem;
    return nullptr;
}

}  // namespace frana::verify
