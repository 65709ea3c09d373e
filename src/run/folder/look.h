#pragma once
// What ParaView's states need of a run: colour ranges for all its times, cameras, sizes of marks.
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace frana {

/// Reads the frames of a run folder (at most seven, spread over the run) and history.csv, and returns as JSON what
/// states/look.json holds:
///   title, last_time and busy_time (when most is in motion) [s], thin [m] below which flow is not drawn,
///   lift, lift_areas, lift_outlines [m] of what lies on the terrain, particle_radius [m],
///   potential_from_start (a formula for history.csv's rows) [J],
///   range: {depth, speed, stress, effective_stress: [low, high]}, of two phases water_depth and
///   bound_depth, round numbers that hold 99.5 % of the wet nodes,
///   bar: titles of the same, which say so where values lie beyond the range,
///   cross: {stride, scale [m/Pa], extent} of the principal stresses, legend: corner of the profile's chart, profile:
///   {surface, initial_surface: formulas of what the chart shows, title}, cohesion_text: what is said of a structure,
///   camera: {view: seen up the slope, map: from above, survey: from above, with what was surveyed}: {position, focal,
///   up, angle [degree], scale, scale_wide, scale_tall, scale_row [m]}, all over everything ever covered; scale is half
///   the height of a square view, the others those of a 3:2, of a 3:5 and of a 1:2 one,
///   impact_time (the output with the largest load on a barrier that pictures tell), point_radius [m], range.point_speed, range.pressure
///   [Pa], camera.impact (from the side of the flow): of a run with 3D points and barriers,
///   states: {name: ""} for each state the run has the files for, or the sentence that says what it lacks.
/// Throws UserError when a file that is there cannot be read.
nlohmann::ordered_json look_at_run(const std::filesystem::path& run_dir, const std::string& title);

/// The same of the maps of an ensemble, maps.vti: title, lift [m], range.probability, cameras, states.
nlohmann::ordered_json look_at_maps(const std::filesystem::path& dir, const std::string& title);

/// The names of all states, in the order of their use.
const std::vector<std::string>& state_names();

}  // namespace frana
