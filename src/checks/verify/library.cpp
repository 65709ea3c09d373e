#include "checks/verify/library.h"

namespace frana::verify {

const std::vector<Problem>& library() {
    static const std::vector<Problem> all = [] {
        std::vector<Problem> problems;
        for (const auto& room :
             {dam_break_problems, bowl_problems,        lake_problems,        paper_problems,
              pile_problems,      radial_dam_problems,  slope_flow_problems,  similarity_problems,
              block_problems,     zone_problems,        track_problems,       bed_step_problems,
              sheet_problems,     deposit_problems,     spreading_problems,   conversion_problems,
              tank_problems,      bore_problems,        rest_problems,        body_problems,
              column_problems,    mud_problems,         erosion_problems,     bed_wave_problems,
              collapse_problems,  detrainment_problems, structured_problems,  structured_case_problems,
              inflow_problems,    water_problems,       water_slope_problems, water_viscous_problems})
            for (Problem& problem : room()) problems.push_back(std::move(problem));
        return problems;
    }();
    return all;
}

const Problem* find_problem(const std::string& name) {
    for (const Problem& problem : library())
        if (problem.name == name) return &problem;
    return nullptr;
}

}  // namespace frana::verify
