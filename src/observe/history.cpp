#include "observe/history.h"

#include <fmt/core.h>

#include <cmath>

#include "base/error.h"
#include "observe/budget.h"

namespace frana {
namespace {

const std::vector<std::string>& columns() {
    static const std::vector<std::string> names = {"step",
                                                   "t",
                                                   "dt",
                                                   "particles",
                                                   "mass",
                                                   "mass_left",
                                                   "mass_error",
                                                   "momentum_x",
                                                   "momentum_y",
                                                   "impulse_x",
                                                   "impulse_y",
                                                   "momentum_residual_x",
                                                   "momentum_residual_y",
                                                   "kinetic",
                                                   "potential",
                                                   "dissipated",
                                                   "energy_left",
                                                   "energy_residual",
                                                   "max_depth",
                                                   "max_speed",
                                                   "mean_speed",
                                                   "covered_area",
                                                   "front",
                                                   "p2g_mass_error",
                                                   "p2g_momentum_error",
                                                   "stored",
                                                   "points_friction",
                                                   "points_walls",
                                                   "points_material",
                                                   "points_numerical",
                                                   "points_volume",
                                                   "max_speed_on_map",
                                                   "eroded_mass",
                                                   "deposited_mass",
                                                   "mass_in"};
    return names;
}

}  // namespace

History::History(const std::filesystem::path& run_dir, Lines lines)
    : table_(run_dir / "history.csv", columns()), lines_(lines) {}

void History::step(const Status& now, const Probe&) {
    if (!first_) first_ = now;
    if (lines_ == Lines::per_step) add(now);
}

void History::observe(const Frame& frame) {
    if (!first_) first_ = frame.status;
    if (lines_ == Lines::per_output) add(frame.status);
    table_.flush();
}

void History::serialize(Archive& archive) {
    table_.serialize(archive);
    if (!first_) first_.emplace();  // a state is saved after the first step() only
    frana::serialize(archive, "first", *first_);
}

void History::add(const Status& now) {
    const Budget left_over = budget(*first_, now);
    const std::vector<double> row = {static_cast<double>(now.step),
                                     now.time,
                                     now.dt,
                                     static_cast<double>(now.particles),
                                     now.mass,
                                     now.mass_left,
                                     left_over.mass_error,
                                     now.momentum[0],
                                     now.momentum[1],
                                     now.impulse[0],
                                     now.impulse[1],
                                     left_over.momentum_residual[0],
                                     left_over.momentum_residual[1],
                                     now.kinetic,
                                     now.potential,
                                     now.dissipated,
                                     now.energy_left,
                                     left_over.energy_residual,
                                     now.max_depth,
                                     now.max_speed,
                                     now.mean_speed,
                                     now.covered_area,
                                     now.front,
                                     now.p2g_mass_error,
                                     now.p2g_momentum_error,
                                     now.stored,
                                     now.in_3d.friction,
                                     now.in_3d.walls,
                                     now.in_3d.material,
                                     now.in_3d.numerical,
                                     now.in_3d.volume,
                                     now.max_speed_on_map,
                                     now.bed.eroded,
                                     now.bed.deposited,
                                     now.mass_in};
    for (std::size_t i = 0; i < row.size(); ++i)
        if (!std::isfinite(row[i]))
            throw NumericsError(fmt::format("step {} at t = {} s: {} is not finite", now.step, now.time, columns()[i]));
    table_.add(row);
}

}  // namespace frana
