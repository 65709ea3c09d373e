#pragma once
// Pictures of 3D points, from the frames of a run.
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "observe/table.h"
#include "run/folder/run_figures.h"
#include "vtk_io/figures/moment_3d.h"

namespace frana {

/// The horizontal forces on barriers that pictures tell: the means of barriers/NAME.csv.
class ToldForces {
public:
    /// `names`: in the case's order.
    ToldForces(std::filesystem::path run_dir, std::vector<std::string> names)
        : run_dir_(std::move(run_dir)), names_(std::move(names)) {}
    /// At an output [N]. Nothing where no table has it, as of more barriers than have one.
    std::optional<double> at(std::size_t barrier, double time) const;
    /// How hard a moment is [N]: that force of its most loaded barrier. Without any, the mean since the output before
    /// that its patches have.
    double load_of(const Moment3d& moment, double time) const;

private:
    const Table* table_of(std::size_t barrier) const;
    std::filesystem::path run_dir_;
    std::vector<std::string> names_;
    mutable std::map<std::size_t, std::optional<Table>> tables_;  ///< those looked for so far
};

/// For a run with 3D points: figures/view_points.png and section_points.png at the last output. Where a barrier has a
/// load, also figures/view_impact.png and section_impact.png at the output with the largest that they tell. With `source.time`
/// view_points_tTs.png and section_points_tTs.png at the output nearest to it as well. Nothing for a run without.
void add_3d(const FigureSource& source, Gallery& gallery);

/// figures/film_points.mp4 or .gif: that view at every output time that has points. Nothing for a run
/// without.
void add_film_3d(const FigureSource& source, const std::string& kind, Gallery& gallery);

}  // namespace frana
