#pragma once
// The canon: every verification problem of frana.
#include <string>
#include <vector>

#include "checks/verify/problem.h"

namespace frana::verify {

/// All problems, in the order of the table.
const std::vector<Problem>& library();
/// The problem of that name, or nullptr.
const Problem* find_problem(const std::string& name);

/// A name that selects other problems.
struct Alias {
    std::string name;
    std::vector<std::string> problems;
    std::string title;  ///< one line: what these have of it
};
const std::vector<Alias>& aliases();
/// The names, aliases among them as the problems that they select; each problem once.
std::vector<std::string> without_aliases(const std::vector<std::string>& names);

// The rooms of the library, one file each.
std::vector<Problem> dam_break_problems();          // problems_dam_break.cpp
std::vector<Problem> bowl_problems();               // problems_bowl.cpp
std::vector<Problem> lake_problems();               // problems_lake.cpp
std::vector<Problem> paper_problems();              // problems_paper.cpp
std::vector<Problem> pile_problems();               // problems_pile.cpp
std::vector<Problem> radial_dam_problems();         // problems_radial_dam.cpp
std::vector<Problem> slope_flow_problems();         // problems_slope_flow.cpp
std::vector<Problem> similarity_problems();         // problems_similarity.cpp
std::vector<Problem> block_problems();              // problems_blocks.cpp
std::vector<Problem> zone_problems();               // problems_zones.cpp
std::vector<Problem> track_problems();              // problems_tracks.cpp
std::vector<Problem> bed_step_problems();           // problems_bed_step.cpp
std::vector<Problem> sheet_problems();              // problems_sheet.cpp
std::vector<Problem> deposit_problems();            // problems_deposit.cpp
std::vector<Problem> spreading_problems();          // problems_spreading.cpp
std::vector<Problem> conversion_problems();         // problems_conversion.cpp
std::vector<Problem> tank_problems();               // problems_tank.cpp
std::vector<Problem> bore_problems();               // problems_bore.cpp
std::vector<Problem> rest_problems();               // problems_rest.cpp
std::vector<Problem> body_problems();               // problems_body.cpp
std::vector<Problem> column_problems();             // problems_column.cpp
std::vector<Problem> structured_problems();         // problems_structured.cpp
std::vector<Problem> structured_case_problems();    // problems_structured_cases.cpp
std::vector<Problem> strained_particle_problems();  // problems_strained_particle.cpp
std::vector<Problem> dam_obstacle_problems();       // problems_dam_obstacle.cpp
std::vector<Problem> mud_problems();                // problems_mud.cpp
std::vector<Problem> slump_problems();              // problems_slump.cpp
std::vector<Problem> bagnold_problems();            // problems_bagnold.cpp
std::vector<Problem> erosion_problems();            // problems_erosion.cpp
std::vector<Problem> bed_wave_problems();           // problems_bed_waves.cpp
std::vector<Problem> collapse_problems();           // problems_erodible_collapse.cpp
std::vector<Problem> detrainment_problems();        // problems_detrainment.cpp
std::vector<Problem> inflow_problems();             // problems_inflow.cpp
std::vector<Problem> water_problems();              // problems_water.cpp
std::vector<Problem> water_slope_problems();        // problems_water_slopes.cpp
std::vector<Problem> water_viscous_problems();      // problems_water_viscous.cpp

}  // namespace frana::verify
