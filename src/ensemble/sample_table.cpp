#include "ensemble/sample_table.h"

#include <fmt/format.h>

#include <cmath>
#include <sstream>

#include "base/error.h"
#include "base/number_text.h"
#include "ensemble/toml_file.h"
#include "ensemble/vary_reader.h"

namespace frana {
namespace {

constexpr const char* kReturnPeriod = "return_period";

/// Names the column's key; false for weights and return periods.
bool note_key(const std::string& name, const std::string& place, EnsemblePlan& plan, Problems& problems) {
    if (name == "weight" || name == kReturnPeriod) return false;
    const KeyProblem problem = problem_of_key(name, plan.vary);
    if (!problem.found.empty()) problems.add(place, problem.found, problem.expected + ", or weight", problem.way_out);
    plan.vary.emplace_back().key = name;
    return true;
}

/// A number that belongs to a sample, or a problem.
double number_of(const std::string& name, const std::string& field, const std::string& place, Problems& problems) {
    const std::optional<double> found = number_in(field);
    const double number = found.value_or(0.0);
    const bool years = name == kReturnPeriod;
    if (!found || !(number >= 0.0) || !std::isfinite(number) || (years && number == 0.0))
        problems.add(place, fmt::format("found the {} \"{}\"", name, field),
                     years ? "expected years above 0" : "expected a number from 0 on", "correct it");
    return number;
}

}  // namespace

std::vector<std::string> comma_fields(const std::string& line) {
    std::vector<std::string> fields;
    std::istringstream stream(line);
    const auto trimmed = [](const std::string& field) {
        const auto first = field.find_first_not_of(" \t\r"), last = field.find_last_not_of(" \t\r");
        return first == std::string::npos ? std::string() : field.substr(first, last - first + 1);
    };
    for (std::string field; std::getline(stream, field, ',');) fields.push_back(trimmed(field));
    if (!line.empty() && line.back() == ',') fields.emplace_back();
    return fields;
}

void read_sample_table(const std::filesystem::path& file, EnsemblePlan& plan, Problems& problems) {
    const std::string text = text_of_file(file);
    plan.table_text = text;
    std::istringstream stream(text);
    std::string line;
    std::getline(stream, line);
    const std::vector<std::string> names = comma_fields(line);
    std::vector<bool> is_key;
    is_key.reserve(names.size());
    for (const std::string& name : names) is_key.push_back(note_key(name, file.string() + ":1", plan, problems));
    double sum = 0.0;
    for (int number = 2; std::getline(stream, line); ++number) {
        const std::vector<std::string> fields = comma_fields(line);
        if (fields.empty()) continue;
        const std::string place = fmt::format("{}:{}", file.string(), number);
        if (fields.size() != is_key.size()) {
            problems.add(place, fmt::format("found {} values", fields.size()),
                         fmt::format("expected {}, as the first line has", is_key.size()), "correct this line");
            continue;
        }
        SamplePoint& point = plan.points.emplace_back();
        for (std::size_t k = 0; k < fields.size(); ++k) {
            if (is_key[k]) {
                point.values.push_back(fields[k]);
                continue;
            }
            (names[k] == kReturnPeriod ? point.return_period : point.weight) =
                number_of(names[k], fields[k], place, problems);
        }
        sum += point.weight;
    }
    plan.samples = static_cast<Index>(plan.points.size());
    if (plan.vary.empty() || plan.points.empty() || !(sum > 0.0))
        problems.add(file.string(), "found no samples of any weight", "expected a line of keys, then lines of values",
                     "give such a table");
    for (SamplePoint& point : plan.points) point.weight *= static_cast<double>(plan.samples) / sum;
}

}  // namespace frana
