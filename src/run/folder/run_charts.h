#pragma once
// The line charts of a run: profiles, gauges and budgets, drawn from the tables in its folder.
#include <string>
#include <vector>

#include "run/folder/run_figures.h"

namespace frana {

/// figures/profile_<name>.png: surface, depth and velocity along a line. It shows the start, the end, and between
/// (source.time when given).
void add_profile(const FigureSource& source, const std::string& name, Gallery& gallery);

/// figures/gauges_flow.png: depth and speed of all gauges over time; nothing without gauges.
void add_gauges(const FigureSource& source, Gallery& gallery);

/// figures/sections_discharge.png: discharge through all sections over time, and the volume that passed; nothing
/// without, or where the flow reached none.
void add_sections(const FigureSource& source, Gallery& gallery);

/// figures/barrier_<name>.png: force, run-up and what went over each barrier that was hit and has a table in
/// barriers/.
void add_barriers(const FigureSource& source, Gallery& gallery);

/// figures/compare_bed_change.png, or as source.comparison names it: changes of the ground along the path, from
/// compare_bed_change.csv; nothing without that.
void add_bed_change(const FigureSource& source, Gallery& gallery);

/// figures/budget_energy.png and budget_motion.png, from history.csv.
void add_budgets(const FigureSource& source, Gallery& gallery);

}  // namespace frana
