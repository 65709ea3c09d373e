#include "scene/problems.h"

#include <fmt/core.h>

#include <algorithm>

namespace frana {

void Problems::add(int line, const std::string& place, const std::string& found, const std::string& expected,
                   const std::string& way_out) {
    problems_.push_back({line, place + ": " + found + "; " + expected + "; " + way_out});
}

void Problems::add(const std::string& place, const UserError& error) {
    for (const std::string& problem : error.problems()) {
        const bool placed = problem.compare(0, place.size(), place) == 0;
        problems_.push_back({no_line, placed ? problem : fmt::format("{}: {}", place, problem)});
    }
}

void Problems::throw_if_any() const {
    if (problems_.empty()) return;
    std::vector<Problem> sorted = problems_;
    std::stable_sort(sorted.begin(), sorted.end(), [](const Problem& a, const Problem& b) { return a.line < b.line; });
    std::vector<std::string> texts;
    texts.reserve(sorted.size());
    for (const Problem& problem : sorted) texts.push_back(problem.text);
    throw UserError(texts);
}

}  // namespace frana
