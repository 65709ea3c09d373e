// `frana describe`: the parameter table for people.
#include <fmt/format.h>

#include <vector>

#include "base/error.h"
#include "scene/parameters.h"

namespace frana {
namespace {

std::string listed(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
    return text;
}

std::string shown(const Parameter& parameter, const Value& value) {
    return parameter.kind == Kind::words_or_all ? "\"all\"" : toml_text(value);
}

std::string default_text(const Parameter& parameter) {
    std::string text = "none";
    if (parameter.required) return "required";
    if (parameter.fallback)
        text = shown(parameter, *parameter.fallback);
    else if (!parameter.absent.empty())
        text = parameter.absent;
    for (const OtherDefault& other : parameter.otherwise)
        text += fmt::format("; {} with {} = \"{}\"", shown(parameter, other.value), other.when, other.is);
    return text;
}

std::string entry(const Parameter& parameter) {
    const std::string unit =
        parameter.unit.empty() || parameter.unit == "1" ? "" : " [" + parameter.unit + "]";
    std::string text = fmt::format("{}{}\n    {}\n", parameter.key, unit, parameter.meaning);
    text += fmt::format("    value:   {}\n", parameter.expected());
    text += fmt::format("    default: {}\n", default_text(parameter));
    if (!parameter.used_by.empty())
        text += fmt::format("    only with {} = {}\n", parameter.switch_key, listed(parameter.used_by));
    if (!parameter.required_by.empty()) {
        const std::string either =
            parameter.instead_of.empty() ? "" : " (this or " + parameter.instead_of + ")";
        text += fmt::format("    needed by {}{}\n", listed(parameter.required_by), either);
    } else if (!parameter.instead_of.empty()) {
        text += fmt::format("    not together with {}\n", parameter.instead_of);
    }
    return text;
}

std::string heading(const std::string& table) {
    for (const std::string& repeated : repeated_tables())
        if (table == repeated) return "[[" + table + "]]";
    return "[" + table + "]";
}

/// "material" selects material.density and material.bed.law, not materials.x; "material.b" selects both beds.
bool selected(const Parameter& parameter, const std::string& prefix) {
    return parameter.key.compare(0, prefix.size(), prefix) == 0;
}

}  // namespace

std::string describe(const std::string& prefix) {
    const std::string wanted = without_numbers(prefix);
    std::string text;
    std::string table;
    std::vector<std::string> known;
    for (const Parameter& parameter : parameters()) {
        known.push_back(parameter.key);
        if (!selected(parameter, wanted)) continue;
        if (parameter.table() != table) {
            table = parameter.table();
            text += (text.empty() ? "" : "\n") + heading(table) + "\n";
        }
        text += entry(parameter);
    }
    if (!text.empty()) return text;
    for (const Parameter& parameter : parameters())  // "xi" alone is as good as material.bed.xi
        if (parameter.name() == wanted) text += entry(parameter);
    if (!text.empty()) return text;
    const std::string near = closest(wanted, known);
    const std::string way_out =
        near.empty() ? "`frana describe` lists all keys" : "did you mean " + near + "?";
    throw UserError(fmt::format("frana describe: {}: unknown key; a key of the case file is expected; {}",
                                prefix, way_out));
}

}  // namespace frana
