#include "checks/verify/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "base/number_text.h"

namespace frana::verify {
namespace {

std::string number(double value) { return std::isnan(value) ? "-" : fmt::format("{:.2e}", value); }

std::string json_number(double value) { return std::isfinite(value) ? fmt::format("{:.17g}", value) : "null"; }

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);)
        if (!line.empty() && line[0] != '#') lines.push_back(line);
    return lines;
}

bool alike(const std::string& a, const std::string& b, double tolerance) {
    if (a == b) return true;
    char *end_a = nullptr, *end_b = nullptr;
    const double x = std::strtod(a.c_str(), &end_a), y = std::strtod(b.c_str(), &end_b);
    if (*end_a != '\0' || *end_b != '\0') return false;
    const double larger = std::max(std::abs(x), std::abs(y));
    return larger <= 1e-10 || std::abs(x - y) <= tolerance * larger;
}

bool alike_lines(const std::string& a, const std::string& b, double tolerance) {
    std::istringstream in_a(a), in_b(b);
    std::string word_a, word_b;
    while (in_a >> word_a)
        if (!(in_b >> word_b) || !alike(word_a, word_b, tolerance)) return false;
    return !(in_b >> word_b);
}

}  // namespace

std::vector<std::string> differences(const std::string& table, const std::string& reference, double tolerance) {
    const std::vector<std::string> now = lines_of(table), then = lines_of(reference);
    std::vector<std::string> found;
    for (std::size_t k = 0; k < std::max(now.size(), then.size()); ++k) {
        if (k < now.size() && k < then.size() && alike_lines(now[k], then[k], tolerance)) continue;
        found.push_back("was " + (k < then.size() ? then[k] : "nothing") + "\nnow " +
                        (k < now.size() ? now[k] : "nothing"));
    }
    return found;
}

std::string table_head() {
    return fmt::format("{:16} {:7} {:>5} {:>3} {:>8} {:>6} {:>9} {:>9} {:>9} {:>9} {:>9} {:>10} {:>9} {:>10} {:>6}",
                       "problem", "preset", "cells", "ppc", "points", "steps", "L1 h", "L2 h", "Linf h", "L1 hu",
                       "L2 hu", "front [m]", "mass", "energy", "order");
}

std::string table_row(const Measurement& m, bool with_time) {
    std::string row = fmt::format(
        "{:16} {:7} {:>5} {:>3} {:>8} {:>6} {:>9} {:>9} {:>9} {:>9} {:>9} {:>10} {:>9} {:>10} {:>6}", m.name, m.preset,
        m.cells, m.per_cell(), m.particles, m.steps, number(m.l1_depth), number(m.l2_depth), number(m.linf_depth),
        number(m.l1_momentum), number(m.l2_momentum), number(m.front_error), number(m.mass_error),
        number(m.energy_error), std::isnan(m.observed_order) ? "-" : fmt::format("{:.2f}", m.observed_order));
    for (const Extra& extra : m.extras)
        row += fmt::format("  {} {}{}", extra.name, number(extra.value), after_number(extra.unit));
    if (with_time) row += fmt::format("  {:.2f} s", m.wall_seconds);
    return row;
}

std::string json_of(const std::vector<Measurement>& measurements) {
    std::string text = "[";
    for (const Measurement& m : measurements) {
        text +=
            fmt::format("{}\n  {{\"name\": \"{}\", \"preset\": \"{}\", \"cells\": {}, \"particles\": {}, \"steps\": {}",
                        &m == measurements.data() ? "" : ",", m.name, m.preset, m.cells, m.particles, m.steps);
        text += fmt::format(", \"points_per_cell\": {}", m.per_cell());
        for (const char* key : {"wall_seconds", "l1_depth", "l2_depth", "linf_depth", "l1_momentum", "l2_momentum",
                                "front_error", "mass_error", "energy_error", "observed_order"})
            text += fmt::format(", \"{}\": {}", key, json_number(m.value(key)));
        for (const Extra& extra : m.extras) text += fmt::format(", \"{}\": {}", extra.name, json_number(extra.value));
        text += "}";
    }
    return text + "\n]\n";
}

}  // namespace frana::verify
