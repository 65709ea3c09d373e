#include "ensemble/checked_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "ensemble/toml_file.h"
#include "scene/parameters.h"

namespace frana {
std::string listed(const std::vector<std::string>& words) {
    std::string text;
    for (std::size_t k = 0; k < words.size(); ++k)
        text += (k == 0 ? "" : k + 1 < words.size() ? ", " : " or ") + words[k];
    return text;
}

void CheckedTable::wrong(const std::string& key, const std::string& found, const std::string& expected,
                         const std::string& way_out) const {
    const toml::node* node = table_.get(key);
    const int line = node ? line_in(*node) : line_in(table_);
    problems_.add(line, fmt::format("{}:{}: {}.{}", file_.string(), line, name_, key), found, expected, way_out);
}

bool CheckedTable::given(const std::string& key) {
    asked_.insert(key);
    return table_.contains(key);
}

std::string CheckedTable::text(const std::string& key, const std::string& otherwise) {
    if (!given(key)) return otherwise;
    if (const auto value = table_[key].value<std::string>()) return *value;
    wrong(key, "found no text", "expected a text", "write it between quotes");
    return otherwise;
}

double CheckedTable::number(const std::string& key, double otherwise) {
    if (!given(key)) return otherwise;
    const auto value = table_[key].value<double>();
    if (value && std::isfinite(*value)) return *value;
    wrong(key, "found no number", "expected a finite number", "give one");
    return otherwise;
}

Index CheckedTable::whole(const std::string& key, Index otherwise, Index least, Index most) {
    const double value = number(key, static_cast<double>(otherwise));
    if (value == std::floor(value) && value >= static_cast<double>(least) && value <= static_cast<double>(most))
        return static_cast<Index>(value);
    wrong(key, fmt::format("found {:g}", value), fmt::format("expected a whole number from {} to {}", least, most),
          "give one");
    return otherwise;
}

std::vector<double> CheckedTable::numbers(const std::string& key) {
    std::vector<double> list;
    if (!given(key)) return list;
    if (const auto* array = table_[key].as_array())
        for (const toml::node& node : *array)
            if (const auto value = node.value<double>()) list.push_back(*value);
    const auto* array = table_[key].as_array();
    const bool good = array && list.size() == array->size() &&
                      std::all_of(list.begin(), list.end(), [](double x) { return std::isfinite(x); });
    if (!good) wrong(key, "found no list of numbers", "expected one like [0.1, 0.3]", "write it so");
    return good ? list : std::vector<double>{};
}

std::vector<std::string> CheckedTable::values(const std::string& key) {
    std::vector<std::string> list;
    if (!given(key)) return list;
    if (const auto* array = table_[key].as_array())
        for (const toml::node& node : *array) {
            std::ostringstream text;
            if (const auto number = node.value_exact<double>())
                text << fmt::format("{}", *number);
            else
                node.visit([&](const auto& value) { text << value; });
            list.push_back(text.str());
        }
    if (list.empty()) wrong(key, "found no list", "expected one like [\"a.geojson\", \"b.geojson\"]", "write it so");
    return list;
}

const toml::node* CheckedTable::node(const std::string& key) { return given(key) ? table_.get(key) : nullptr; }

void CheckedTable::refuse_others(const std::string& when) const {
    const std::vector<std::string> known(asked_.begin(), asked_.end());
    for (const auto& [key, value] : table_) {
        const std::string name(key.str());
        if (asked_.count(name)) continue;
        const std::string near = closest(name, known);
        wrong(name, "found a key that is not used " + when, "expected one of " + listed(known),
              near.empty() ? "remove it" : fmt::format("is {} meant?", near));
    }
}

}  // namespace frana
