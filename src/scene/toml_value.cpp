#include "scene/toml_value.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "base/number_text.h"

namespace frana {
namespace {

/// Converts one node; every failure is noted once and ends in nullopt.
class Converter {
public:
    Converter(const Parameter& parameter, int line, const std::string& place, Problems& problems)
        : parameter_(parameter), line_(line), place_(place), problems_(problems) {}

    std::optional<Value> value(const toml::node& node) const {
        switch (parameter_.kind) {
            case Kind::number:
                return wrapped(number(node));
            case Kind::integer:
                return wrapped(integer(node));
            case Kind::flag:
                return wrapped(flag(node));
            case Kind::text:
                return wrapped(text(node));
            case Kind::name:
                return wrapped(name(node));
            case Kind::choice:
                return wrapped(chosen(node));
            case Kind::path:
                return wrapped(path(node));
            case Kind::number_or_path:
                return node.is_string() ? wrapped(path(node)) : wrapped(number(node));
            case Kind::number_or_choice:
                return node.is_string() ? wrapped(chosen(node)) : wrapped(number(node));
            case Kind::numbers:
                return wrapped(list(node, &Converter::number, parameter_.length));
            case Kind::numbers_or_paths:
                return numbers_or_paths(node);
            case Kind::points:
                return points(node);
            case Kind::points_or_path:
                return node.is_string() ? wrapped(path(node)) : points(node);
            case Kind::words:
                if (parameter_.may_be_empty && node.is_array() && node.as_array()->empty())
                    return Value(std::vector<std::string>{});
                return wrapped(list(node, &Converter::chosen, 0));
            case Kind::words_or_all:
                return words_or_all(node);
        }
        throw InternalError("internal error: a kind of parameter without conversion");
    }

private:
    template <class T>
    static std::optional<Value> wrapped(std::optional<T> value) {
        if (!value) return std::nullopt;
        return Value(std::move(*value));
    }

    std::nullopt_t wrong(const toml::node& node, const std::string& way_out) const {
        problems_.add(line_, place_, "found " + found_text(node), "expected " + parameter_.expected(), way_out);
        return std::nullopt;
    }

    std::string explained() const { return "see `frana describe " + parameter_.key + "`"; }

    std::optional<double> number(const toml::node& node) const {
        if (!node.is_number()) return wrong(node, number_way_out(node));
        const double value = *node.value<double>();
        if (!std::isfinite(value)) return wrong(node, "give a finite number");
        if (!parameter_.range.holds(value)) return wrong(node, "choose a value in this range");
        return value;
    }

    std::string number_way_out(const toml::node& node) const {
        const auto text = node.value<std::string>();
        if (!text) return explained();
        const auto found = leading_number(*text);
        if (!found || !std::isfinite(found->value)) return explained();
        return fmt::format("write {} = {}, without quotes and unit", parameter_.name(), toml_text(found->value));
    }

    std::optional<double> integer(const toml::node& node) const {
        const std::optional<double> value = number(node);
        if (value && *value != std::floor(*value)) return wrong(node, "round it");
        return value;
    }

    std::optional<bool> flag(const toml::node& node) const {
        if (!node.is_boolean()) return wrong(node, "write it in lower case, without quotes");
        return *node.value<bool>();
    }

    std::optional<std::string> text(const toml::node& node) const {
        if (!node.is_string()) return wrong(node, "put the text in quotes");
        return *node.value<std::string>();
    }

    std::optional<std::string> name(const toml::node& node) const {
        std::optional<std::string> value = text(node);
        if (!value) return std::nullopt;
        const bool fit = !value->empty() && value->size() <= kLongestName &&
                         std::all_of(value->begin(), value->end(),
                                     [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '_'; });
        if (!fit) return wrong(node, "files are named after it, so choose a plain name");
        return value;
    }

    std::optional<std::string> chosen(const toml::node& node) const {
        std::optional<std::string> value = text(node);
        if (!value) return std::nullopt;
        const auto& choices = parameter_.choices;
        if (std::find(choices.begin(), choices.end(), *value) != choices.end()) return value;
        if (const auto now = parameter_.former.find(*value); now != parameter_.former.end()) return now->second;
        const std::string near = closest(*value, choices);
        return wrong(node, near.empty() ? explained() : "did you mean \"" + near + "\"?");
    }

    std::optional<std::string> path(const toml::node& node) const {
        if (!node.is_string()) return wrong(node, "put the file's name in quotes");
        std::string value = *node.value<std::string>();
        if (value.empty()) return wrong(node, "name the file, relative to the case file");
        return value;
    }

    template <class T>
    std::optional<std::vector<T>> list(const toml::node& node,
                                       std::optional<T> (Converter::*item)(const toml::node&) const,
                                       std::size_t length) const {
        const toml::array* array = node.as_array();
        if (!array || array->empty() || (length > 0 && array->size() != length)) return wrong(node, explained());
        std::vector<T> values;
        for (const toml::node& element : *array) {
            std::optional<T> value = (this->*item)(element);
            if (!value) return std::nullopt;
            values.push_back(std::move(*value));
        }
        return values;
    }

    std::optional<Value> numbers_or_paths(const toml::node& node) const {
        const toml::array* array = node.as_array();
        const bool files = array && !array->empty() && array->front().is_string();
        if (files) return wrapped(list(node, &Converter::path, parameter_.length));
        return wrapped(list(node, &Converter::number, parameter_.length));
    }

    std::optional<Vec2> point(const toml::node& node) const {
        const toml::array* array = node.as_array();
        if (!array || array->size() != 2) return wrong(node, explained());
        const std::optional<double> x = number((*array)[0]);
        if (!x) return std::nullopt;
        const std::optional<double> y = number((*array)[1]);
        if (!y) return std::nullopt;
        return Vec2(*x, *y);
    }

    std::optional<Value> points(const toml::node& node) const {
        std::optional<std::vector<Vec2>> values = list(node, &Converter::point, 0);
        if (!values) return std::nullopt;
        if (values->size() < parameter_.length) return wrong(node, "add points");
        for (std::size_t i = 1; i < values->size(); ++i)
            if ((*values)[i] == (*values)[i - 1]) return wrong(node, "remove the point that comes twice in a row");
        return Value(std::move(*values));
    }

    std::optional<Value> words_or_all(const toml::node& node) const {
        if (node.is_string() && *node.value<std::string>() == "all") return Value(std::vector<std::string>{});
        return wrapped(list(node, &Converter::chosen, 0));
    }

    const Parameter& parameter_;
    int line_;
    const std::string& place_;
    Problems& problems_;
};

}  // namespace

std::string found_text(const toml::node& node) {
    if (const auto text = node.value<std::string>()) {
        const std::size_t longest = 60;
        const std::string shown = text->size() > longest ? text->substr(0, longest) + "..." : *text;
        return "the text " + toml_text(shown);
    }
    if (node.is_integer()) return std::to_string(*node.value<std::int64_t>());
    if (node.is_floating_point()) return fmt::format("{}", *node.value<double>());
    if (node.is_boolean()) return *node.value<bool>() ? "true" : "false";
    if (const toml::array* array = node.as_array()) {
        return fmt::format("a list of {} value{}", array->size(), array->size() == 1 ? "" : "s");
    }
    return node.is_table() ? "a table" : "a date or time";
}

std::optional<Value> convert(const toml::node& node, const Parameter& parameter, int line, const std::string& place,
                             Problems& problems) {
    return Converter(parameter, line, place, problems).value(node);
}

}  // namespace frana
