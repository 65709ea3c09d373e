#include "observe/history.h"

#include <fmt/core.h>

#include <cmath>
#include <iterator>

#include "base/error.h"
#include "observe/budget.h"

namespace frana {
namespace {

/// A column: of the status, or of the balances since the first one.
struct Column {
    const char* name;
    double (*of_status)(const Status&);
    double (*of_budget)(const Budget&) = nullptr;
};

/// In the order of the file.
constexpr Column kColumns[] = {{"step", [](const Status& s) { return static_cast<double>(s.step); }},
                               {"t", [](const Status& s) { return s.time; }},
                               {"dt", [](const Status& s) { return s.dt; }},
                               {"particles", [](const Status& s) { return static_cast<double>(s.particles); }},
                               {"mass", [](const Status& s) { return s.mass; }},
                               {"mass_left", [](const Status& s) { return s.mass_left; }},
                               {"mass_error", nullptr, [](const Budget& b) { return b.mass_error; }},
                               {"momentum_x", [](const Status& s) { return s.momentum[0]; }},
                               {"momentum_y", [](const Status& s) { return s.momentum[1]; }},
                               {"impulse_x", [](const Status& s) { return s.impulse[0]; }},
                               {"impulse_y", [](const Status& s) { return s.impulse[1]; }},
                               {"momentum_residual_x", nullptr, [](const Budget& b) { return b.momentum_residual[0]; }},
                               {"momentum_residual_y", nullptr, [](const Budget& b) { return b.momentum_residual[1]; }},
                               {"kinetic", [](const Status& s) { return s.kinetic; }},
                               {"potential", [](const Status& s) { return s.potential; }},
                               {"dissipated", [](const Status& s) { return s.dissipated; }},
                               {"energy_left", [](const Status& s) { return s.energy_left; }},
                               {"energy_residual", nullptr, [](const Budget& b) { return b.energy_residual; }},
                               {"max_depth", [](const Status& s) { return s.max_depth; }},
                               {"max_speed", [](const Status& s) { return s.max_speed; }},
                               {"mean_speed", [](const Status& s) { return s.mean_speed; }},
                               {"covered_area", [](const Status& s) { return s.covered_area; }},
                               {"front", [](const Status& s) { return s.front; }},
                               {"p2g_mass_error", [](const Status& s) { return s.p2g_mass_error; }},
                               {"p2g_momentum_error", [](const Status& s) { return s.p2g_momentum_error; }},
                               {"stored", [](const Status& s) { return s.stored; }},
                               {"points_friction", [](const Status& s) { return s.in_3d.friction; }},
                               {"points_walls", [](const Status& s) { return s.in_3d.walls; }},
                               {"points_material", [](const Status& s) { return s.in_3d.material; }},
                               {"points_numerical", [](const Status& s) { return s.in_3d.numerical; }},
                               {"points_volume", [](const Status& s) { return s.in_3d.volume; }},
                               {"max_speed_on_map", [](const Status& s) { return s.max_speed_on_map; }},
                               {"eroded_mass", [](const Status& s) { return s.bed.eroded; }},
                               {"deposited_mass", [](const Status& s) { return s.bed.deposited; }},
                               {"mass_in", [](const Status& s) { return s.mass_in; }}};

std::vector<std::string> names() {
    std::vector<std::string> all;
    for (const Column& column : kColumns) all.emplace_back(column.name);
    return all;
}

}  // namespace

History::History(const std::filesystem::path& run_dir, Lines lines)
    : table_(run_dir / "history.csv", names()), lines_(lines) {}

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
    std::vector<double> row;
    row.reserve(std::size(kColumns));
    for (const Column& column : kColumns) {
        row.push_back(column.of_budget ? column.of_budget(left_over) : column.of_status(now));
        if (!std::isfinite(row.back()))
            throw NumericsError(fmt::format("step {} at t = {} s: {} is not finite", now.step, now.time, column.name));
    }
    table_.add(row);
}

}  // namespace frana
