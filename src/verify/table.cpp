#include "verify/table.h"

#include <fmt/format.h>

#include <cmath>

namespace frana::verify {
namespace {

std::string number(double value) { return std::isnan(value) ? "-" : fmt::format("{:.2e}", value); }

std::string json_number(double value) { return std::isfinite(value) ? fmt::format("{:.17g}", value) : "null"; }

}  // namespace

std::string table_head() {
    return fmt::format("{:16} {:7} {:>5} {:>3} {:>8} {:>6} {:>9} {:>9} {:>9} {:>9} {:>9} {:>10} {:>9} {:>10} {:>6}", "problem",
                       "preset", "cells", "ppc", "points", "steps", "L1 h", "L2 h", "Linf h", "L1 hu", "L2 hu", "front [m]",
                       "mass", "energy", "order");
}

std::string table_row(const Measurement& m, bool with_time) {
    std::string row = fmt::format(
        "{:16} {:7} {:>5} {:>3} {:>8} {:>6} {:>9} {:>9} {:>9} {:>9} {:>9} {:>10} {:>9} {:>10} {:>6}", m.name, m.preset, m.cells,
        m.per_side * m.per_side, m.particles, m.steps, number(m.l1_depth), number(m.l2_depth), number(m.linf_depth),
        number(m.l1_momentum), number(m.l2_momentum), number(m.front_error), number(m.mass_error),
        number(m.energy_error), std::isnan(m.observed_order) ? "-" : fmt::format("{:.2f}", m.observed_order));
    for (const Extra& extra : m.extras)
        row += fmt::format("  {} {}{}", extra.name, number(extra.value), extra.unit == "1" ? "" : " " + extra.unit);
    if (with_time) row += fmt::format("  {:.2f} s", m.wall_seconds);
    return row;
}

std::string json_of(const std::vector<Measurement>& measurements) {
    std::string text = "[";
    for (const Measurement& m : measurements) {
        text += fmt::format("{}\n  {{\"name\": \"{}\", \"preset\": \"{}\", \"cells\": {}, \"particles\": {}, \"steps\": {}",
                            &m == measurements.data() ? "" : ",", m.name, m.preset, m.cells, m.particles, m.steps);
        text += fmt::format(", \"points_per_cell\": {}", m.per_side * m.per_side);
        for (const char* key : {"wall_seconds", "l1_depth", "l2_depth", "linf_depth", "l1_momentum", "l2_momentum",
                                "front_error", "mass_error", "energy_error", "observed_order"})
            text += fmt::format(", \"{}\": {}", key, json_number(m.value(key)));
        for (const Extra& extra : m.extras) text += fmt::format(", \"{}\": {}", extra.name, json_number(extra.value));
        text += "}";
    }
    return text + "\n]\n";
}

}  // namespace frana::verify
