#pragma once
#include <filesystem>
#include <optional>

#include "observe/observer.h"
#include "observe/table.h"

namespace frana {

/// history.csv: time, budgets and extremes, a line per step or per output; appended at every output. SI
/// units:
///   step, t [s], dt [s], particles, mass [kg], mass_left [kg], mass_error [1],
///   momentum_x/y, impulse_x/y, momentum_residual_x/y [kg m/s],
///   kinetic, potential, dissipated, energy_left, energy_residual [J],
///   max_depth [m], max_speed [m/s], mean_speed [m/s], covered_area [m2], front [m],
///   p2g_mass_error [1], p2g_momentum_error [1], ..., max_speed_on_map [m/s],
///   eroded_mass, deposited_mass, mass_in [kg]
/// max_speed and mean_speed are along the bed; 3D points have their whole speed. max_speed_on_map is the largest
/// horizontal part.
/// The residuals are those of observe/budget.h against the first line.
class History : public Observer {
public:
    enum class Lines { per_step, per_output };
    History(const std::filesystem::path& run_dir, Lines lines);
    std::string name() const override { return "history"; }
    void step(const Status& now, const Probe&) override;
    void observe(const Frame& frame) override;
    bool looks_at_fields() const override { return false; }
    void serialize(Archive& archive) override;

private:
    void add(const Status& now);

    TableWriter table_;
    Lines lines_;
    std::optional<Status> first_;
};

}  // namespace frana
