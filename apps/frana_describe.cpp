#include <algorithm>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/version.h"
#include "frana_commands.h"
#include "scene/combinations.h"
#include "scene/described.h"
#include "scene/parameter_ranges.h"
#include "scene/parameters.h"

namespace frana {
namespace {

using Json = nlohmann::ordered_json;

const char* word(Kind kind) {
    switch (kind) {
        case Kind::number:
            return "number";
        case Kind::integer:
            return "integer";
        case Kind::flag:
            return "flag";
        case Kind::text:
            return "text";
        case Kind::name:
            return "name";
        case Kind::choice:
            return "choice";
        case Kind::path:
            return "path";
        case Kind::number_or_path:
            return "number_or_path";
        case Kind::number_or_choice:
            return "number_or_choice";
        case Kind::numbers:
            return "numbers";
        case Kind::numbers_or_paths:
            return "numbers_or_paths";
        case Kind::points:
            return "points";
        case Kind::points_or_path:
            return "points_or_path";
        case Kind::words:
            return "words";
        case Kind::words_or_all:
            return "words_or_all";
    }
    throw InternalError("internal error: a kind of parameter without word");
}

struct ValueJson {
    Kind kind;
    Json operator()(const std::vector<std::string>& words) const {
        return kind == Kind::words_or_all ? Json("all") : Json(words);
    }
    Json operator()(const std::vector<Vec2>& points) const {
        Json list = Json::array();
        for (const Vec2& point : points) list.push_back({point.x(), point.y()});
        return list;
    }
    Json operator()(double value) const {
        return kind == Kind::integer ? Json(static_cast<long long>(value)) : Json(value);
    }
    template <class Plain>
    Json operator()(const Plain& value) const {
        return value;
    }
};

Json json_of(Kind kind, const Value& value) { return std::visit(ValueJson{kind}, value); }

/// Ends that are open or not there: {"low": 0.0, "low_open": true}.
Json json_of(const Range& range) {
    Json ends = Json::object();
    if (std::isfinite(range.low)) ends.update({{"low", range.low}, {"low_open", range.low_open}});
    if (std::isfinite(range.high)) ends.update({{"high", range.high}, {"high_open", range.high_open}});
    return ends;
}

Json json_of(const Parameter& parameter) {
    const auto& repeated = repeated_tables();
    Json entry = {{"key", parameter.key},
                  {"table", parameter.table()},
                  {"repeated", std::find(repeated.begin(), repeated.end(), parameter.table()) != repeated.end()},
                  {"kind", word(parameter.kind)},
                  {"unit", parameter.unit},
                  {"help", parameter.meaning},
                  {"value", parameter.expected()},
                  {"required", parameter.required}};
    if (!parameter.range.is_all()) entry["range"] = json_of(parameter.range);
    if (!parameter.choices.empty()) entry["choices"] = parameter.choices;
    if (parameter.length > 0) entry["length"] = parameter.length;
    if (parameter.fallback) entry["default"] = json_of(parameter.kind, *parameter.fallback);
    if (!parameter.absent.empty()) entry["absent"] = parameter.absent;
    for (const OtherDefault& other : parameter.otherwise)
        entry["otherwise"].push_back({{"when", other.when},
                                      {"is", json_of(Kind::choice, other.is)},
                                      {"default", json_of(parameter.kind, other.value)}});
    if (!parameter.switch_key.empty()) entry["switch"] = parameter.switch_key;
    if (!parameter.used_by.empty()) entry["used_by"] = parameter.used_by;
    if (!parameter.required_by.empty()) entry["required_by"] = parameter.required_by;
    if (!parameter.instead_of.empty()) entry["instead_of"] = parameter.instead_of;
    return entry;
}

std::string describe_in_json(const std::string& prefix) {
    Json keys = Json::array();
    for (const Parameter* parameter : described(prefix)) keys.push_back(json_of(*parameter));
    return Json{{"program", "frana"}, {"version", FRANA_VERSION}, {"keys", keys}}.dump(1) + '\n';
}

}  // namespace

int describe_command(const DescribeOptions& options) {
    std::cout << (options.combinations ? describe_combinations()
                  : options.parameters ? ranges_in_markdown()
                  : options.markdown   ? describe_in_markdown()
                  : options.json       ? describe_in_json(options.key)
                                       : describe(options.key));
    return 0;
}

}  // namespace frana
