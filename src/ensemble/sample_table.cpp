#include "ensemble/sample_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "base/error.h"
#include "base/number_text.h"
#include "ensemble/toml_file.h"
#include "ensemble/vary_reader.h"

namespace frana {
namespace {

constexpr const char* kReturnPeriod = "return_period";
constexpr const char* kSample = "sample";  ///< numbers of frana's own tables; a sample's is that of its line

/// Names the column's key; false for weights, return periods and numbers of samples.
bool note_key(const std::string& name, const std::string& place, EnsemblePlan& plan, Problems& problems) {
    if (name == "weight" || name == kReturnPeriod || name == kSample) return false;
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

std::vector<std::string> quoted_fields(const std::string& line) {
    std::vector<std::string> fields;
    const std::size_t end = line.find_last_not_of(" \t\r") + 1;
    if (end == 0) return fields;
    std::size_t k = 0;
    do {
        k = std::min(line.find_first_not_of(" \t", k), end);
        std::string field;
        if (k < end && line[k] == '"') {
            for (++k; k < end && !(line[k] == '"' && (k + 1 == end || line[k + 1] != '"')); ++k)
                field += line[k], k += line[k] == '"' ? 1 : 0;  // of two quotes one is meant
            k = std::min(line.find(',', k), end);
        } else {
            const std::size_t comma = std::min(line.find(',', k), end);
            field = line.substr(k, comma - k);
            field.erase(field.find_last_not_of(" \t\r") + 1);
            k = comma;
        }
        fields.push_back(std::move(field));
    } while (k++ < end);
    return fields;
}

void read_sample_table(const std::filesystem::path& file, EnsemblePlan& plan, Problems& problems) {
    const std::string text = text_of_file(file);
    plan.table_text = text;
    std::istringstream stream(text);
    std::string line;
    std::getline(stream, line);
    const std::vector<std::string> names = quoted_fields(line);
    std::vector<bool> is_key;
    is_key.reserve(names.size());
    for (const std::string& name : names) is_key.push_back(note_key(name, file.string() + ":1", plan, problems));
    for (const char* once : {"weight", kReturnPeriod})
        if (const auto found = std::count(names.begin(), names.end(), once); found > 1)
            problems.add(file.string() + ":1", fmt::format("found {} columns \"{}\"", found, once), "expected one",
                         "remove the others");
    double sum = 0.0;
    for (int number = 2; std::getline(stream, line); ++number) {
        const std::vector<std::string> fields = quoted_fields(line);
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
            if (names[k] == kSample) continue;
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
