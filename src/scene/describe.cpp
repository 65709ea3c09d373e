// `frana describe`: the parameter table for people.
#include <fmt/format.h>

#include <vector>

#include "base/error.h"
#include "scene/combinations.h"
#include "scene/described.h"
#include "scene/parameter_ranges.h"
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
        text += fmt::format("; {} with {} = {}", shown(parameter, other.value), other.when, toml_text(other.is));
    return text;
}

/// When the key counts: the choices that use or need it, and the key that may stand in its place. Empty: always.
std::vector<std::string> conditions(const Parameter& parameter) {
    std::vector<std::string> lines;
    if (!parameter.used_by.empty())
        lines.push_back(fmt::format("only with {} = {}", parameter.switch_key, listed(parameter.used_by)));
    if (!parameter.only_with.empty()) lines.push_back(fmt::format("only with {}", parameter.only_with));
    if (!parameter.required_by.empty()) {
        const std::string either = parameter.instead_of.empty() ? "" : " (this or " + parameter.instead_of + ")";
        lines.push_back(fmt::format("needed by {}{}", listed(parameter.required_by), either));
    } else if (!parameter.instead_of.empty()) {
        lines.push_back(fmt::format("not together with {}", parameter.instead_of));
    }
    return lines;
}

std::string entry(const Parameter& parameter) {
    const std::string unit = parameter.unit.empty() || parameter.unit == "1" ? "" : " [" + parameter.unit + "]";
    std::string text = fmt::format("{}{}\n    {}\n", parameter.key, unit, parameter.meaning);
    text += fmt::format("    value:   {}\n", parameter.expected());
    text += fmt::format("    default: {}\n", default_text(parameter));
    for (const std::string& condition : conditions(parameter)) text += "    " + condition + "\n";
    return text + ranges_in_words(parameter.key);
}

std::string heading(const std::string& table) {
    for (const std::string& repeated : repeated_tables())
        if (table == repeated) return "[[" + table + "]]";
    return "[" + table + "]";
}

/// A cell of a table in Markdown: a bar would end it, and `<` begins a tag.
std::string cell(const std::string& text) {
    std::string safe;
    for (const char c : text) safe += c == '|' ? "\\|" : c == '<' ? "&lt;" : std::string(1, c);
    return safe;
}

std::string row(const Parameter& parameter) {
    std::string meaning = parameter.meaning;
    for (const std::string& condition : conditions(parameter)) meaning += "; " + condition;
    return fmt::format("| `{}` | {} | {} | {} |\n", parameter.name(), cell(meaning), cell(parameter.expected()),
                       cell(default_text(parameter)));
}

/// "material" selects material.density and material.bed.law, not materials.x; "material.b" selects both beds.
bool selected(const Parameter& parameter, const std::string& prefix) {
    return parameter.key.compare(0, prefix.size(), prefix) == 0;
}

}  // namespace

std::vector<const Parameter*> described(const std::string& prefix) {
    const std::string wanted = without_numbers(prefix);
    std::vector<const Parameter*> chosen;
    for (const Parameter& parameter : parameters())
        if (selected(parameter, wanted)) chosen.push_back(&parameter);
    if (!chosen.empty()) return chosen;
    for (const Parameter& parameter : parameters())  // "xi" alone is as good as material.bed.xi
        if (parameter.name() == wanted) chosen.push_back(&parameter);
    if (!chosen.empty()) return chosen;
    std::vector<std::string> known;
    for (const Parameter& parameter : parameters()) known.push_back(parameter.key);
    const std::string near = closest(wanted, known);
    const std::string way_out = near.empty() ? "`frana describe` lists all keys" : "did you mean " + near + "?";
    throw UserError(
        fmt::format("frana describe: {}: unknown key; a key of the case file is expected; {}", prefix, way_out));
}

std::string describe(const std::string& prefix) {
    const std::vector<const Parameter*> chosen = described(prefix);
    const bool by_table = selected(*chosen.front(), without_numbers(prefix));
    std::string text;
    std::string table;
    for (const Parameter* parameter : chosen) {
        if (by_table && parameter->table() != table) {
            table = parameter->table();
            text += (text.empty() ? "" : "\n") + heading(table) + "\n";
        }
        text += entry(*parameter);
    }
    return text;
}

std::string describe_in_markdown() {
    std::string text =
        "# Keys of a case file\n\nWritten by `frana describe --markdown`; the program reads the same table. Numbers "
        "are in SI "
        "units, angles\nin degrees where the key ends in `_deg`. Tables in double brackets may stand several times.\n";
    std::string table;
    for (const Parameter& parameter : parameters()) {
        if (parameter.table() != table) {
            table = parameter.table();
            text +=
                fmt::format("\n## `{}`\n\n| Key | Meaning | Value | Default |\n|---|---|---|---|\n", heading(table));
        }
        text += row(parameter);
    }
    return text + combinations_in_markdown();
}

}  // namespace frana
