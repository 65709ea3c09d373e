#include "scene/case_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <sstream>

#include "base/number_text.h"
#include "scene/toml_value.h"

namespace frana {
namespace {

int line_in(const toml::node& node) { return static_cast<int>(node.source().begin.line); }

bool is_table_name(const std::string& name) {
    for (const Parameter& parameter : parameters())
        if (parameter.key.compare(0, name.size() + 1, name + ".") == 0) return true;
    return false;
}

bool is_repeated(const std::string& name) {
    const auto& names = repeated_tables();
    return std::find(names.begin(), names.end(), name) != names.end();
}

/// The table of a key without numbers, known or not; empty: it has none.
std::string table_of(const std::string& key) {
    std::string repeated = repeated_table_of(key);
    if (!repeated.empty()) return repeated;
    const std::size_t dot = key.rfind('.');
    return dot == std::string::npos ? "" : key.substr(0, dot);
}

std::vector<std::string> names_in(const std::string& table) {
    std::vector<std::string> names;
    for (const Parameter& parameter : parameters())
        if (parameter.table() == table) names.push_back(parameter.name());
    return names;
}

std::vector<std::string> table_names() {
    std::vector<std::string> names;
    for (const Parameter& parameter : parameters()) {
        std::string name = parameter.table();
        for (std::size_t dot = name.size(); dot != std::string::npos; dot = name.rfind('.')) {
            name.resize(dot);
            if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
        }
    }
    return names;
}

/// A name in the table for the same as `name` is in other tables; empty: none.
std::string same_thing(const std::string& name, const std::vector<std::string>& names) {
    static const std::vector<std::string> outlines = {"outline", "area", "footprint"};
    if (std::find(outlines.begin(), outlines.end(), name) == outlines.end()) return {};
    for (const std::string& other : outlines)
        if (std::find(names.begin(), names.end(), other) != names.end()) return other;
    return {};
}

/// The key that was meant by an unknown one. It is a neighbour in its table, the same name elsewhere, or the nearest of
/// all keys and tables. Empty when none is near.
std::string meant(const std::string& key) {
    const std::string table = table_of(key);
    const std::string name = table.empty() ? key : key.substr(table.size() + 1);
    const std::vector<std::string> here = names_in(table);
    for (const std::string& neighbour : {closest(name, here), same_thing(name, here)})
        if (!neighbour.empty()) return (table + ".").append(neighbour);
    std::vector<std::string> all = table_names();
    for (const Parameter& parameter : parameters()) {
        if (parameter.name() == name) return parameter.key;
        all.push_back(parameter.key);
    }
    return closest(key, all);
}

std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
    return text;
}

std::string line_of_text(const std::string& text, unsigned number) {
    std::istringstream stream(text);
    std::string line;
    for (unsigned i = 0; i < number && std::getline(stream, line); ++i) {
    }
    const std::size_t begin = line.find_first_not_of(" \t\r");
    return begin == std::string::npos ? "" : line.substr(begin, line.find_last_not_of(" \t\r") + 1 - begin);
}

/// "Error while parsing array: encountered end-of-file" -> "an error in array: encountered end-of-file"
std::string syntax_text(const std::string& description) {
    const std::string preface = "Error while parsing ";
    if (description.compare(0, preface.size(), preface) != 0) return "broken TOML: " + description;
    return "broken TOML in the " + description.substr(preface.size());
}

std::string trimmed(const std::string& text) {
    const std::size_t begin = text.find_first_not_of(" \t");
    return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(" \t") + 1 - begin);
}

bool takes_text(Kind kind) {
    return kind == Kind::text || kind == Kind::name || kind == Kind::choice || kind == Kind::path;
}

/// The value of a --set. It is a TOML value where it is one, or a number that TOML would write otherwise (.5, 2.). Else
/// it is the text itself.
toml::table set_table(const std::string& text, Kind kind) {
    toml::table table;
    try {  // toml++ reports by exception whether a text is TOML; here that is a question, not an error
        table = toml::parse("v = " + text + "\n");
    } catch (const toml::parse_error&) {
        table.clear();
    }
    const bool one_value = table.size() == 1;
    const std::optional<double> number = one_value || takes_text(kind) ? std::nullopt : number_in(text);
    if (number && std::isfinite(*number)) return toml::table{{"v", *number}};
    if (!one_value || (takes_text(kind) && !table.begin()->second.is_string())) return toml::table{{"v", text}};
    return table;
}

}  // namespace

std::string CaseReader::place_of(const std::string& key, int line) const {
    return fmt::format("{}:{}: {}", case_.file_.string(), line, key);
}

bool CaseReader::read_text(const std::string& text) {
    try {
        read_table(toml::parse(std::string_view(text), std::string_view(case_.file_.native())), "");
        return true;
    } catch (const toml::parse_error& error) {  // the parser's way of saying it: turned into one of our problems
        const unsigned line = error.source().begin.line;
        problems_.add(static_cast<int>(line), fmt::format("{}:{}: TOML", case_.file_.string(), line),
                      "found " + syntax_text(std::string(error.description())), "expected key = value",
                      fmt::format("correct this line: {}", line_of_text(text, line)));
        return false;
    }
}

void CaseReader::read_table(const toml::table& table, const std::string& prefix) {
    for (const auto& [name, node] : table) {
        const std::string key = prefix.empty() ? std::string(name.str()) : prefix + "." + std::string(name.str());
        read_entry(node, key);
    }
}

void CaseReader::read_entry(const toml::node& node, const std::string& key) {
    const int line = line_in(node);
    const std::string place = place_of(key, line);
    if (is_repeated(key)) return read_repeated(node, key);
    const Parameter* parameter = find_parameter(key);
    if (parameter) return read_leaf(node, *parameter, key);
    if (!is_table_name(without_numbers(key))) return refuse_unknown(key, line, place);
    if (const toml::table* table = node.as_table()) {
        case_.table_lines_[key] = line;
        return read_table(*table, key);
    }
    problems_.add(line, place, "found " + found_text(node), "expected a table",
                  fmt::format("write [{0}] once and its keys below; `frana describe {0}` lists them", key));
}

void CaseReader::read_repeated(const toml::node& node, const std::string& name) {
    const toml::array* array = node.as_array();
    if (!array || !array->is_homogeneous<toml::table>()) {
        problems_.add(line_in(node), place_of(name, line_in(node)), "found " + found_text(node),
                      "expected tables that may come several times",
                      fmt::format("write [[{}]] with double brackets", name));
        misread_.insert(name);
        return;
    }
    Index number = 0;
    for (const toml::node& element : *array) {
        const std::string key = name + "." + std::to_string(number++);
        case_.table_lines_[key] = line_in(element);
        read_table(*element.as_table(), key);
    }
    case_.counts_[name] = number;
}

void CaseReader::read_leaf(const toml::node& node, const Parameter& parameter, const std::string& key) {
    const int line = line_in(node);
    const std::string place = place_of(key, line);
    lines_[key] = line;
    std::optional<Value> value = convert(node, parameter, line, place, problems_);
    if (value)
        case_.settings_[key] = {std::move(*value), place, false};
    else
        misread_.insert(key);
}

void CaseReader::refuse_unknown(const std::string& key, int line, const std::string& place) {
    const std::string plain = without_numbers(key);
    const std::string table = table_of(plain);
    const std::vector<std::string> names = names_in(table);
    const std::string known = table.empty() || names.empty() ? "one of the tables " + joined(table_names())
                                                             : fmt::format("a key of [{}]: {}", table, joined(names));
    const std::string near = meant(plain);
    const std::string way_out = near.empty() ? "remove it, or see `frana describe`" : "did you mean " + near + "?";
    problems_.add(line, place, "found an unknown key", "expected " + known, way_out);
}

void CaseReader::apply_set(const std::string& argument) {
    const std::size_t equals = argument.find('=');
    if (equals == std::string::npos || equals == 0) {
        problems_.add("--set " + argument, "found no key and value", "expected key=value",
                      "write it like --set grid.cell=2.5");
        return;
    }
    const std::string key = trimmed(argument.substr(0, equals));
    const std::string place = "--set " + key;
    const Parameter* parameter = find_parameter(key);
    if (!parameter) return refuse_unknown(key, Problems::no_line, place);
    if (!count_repeated(key, place)) return;
    const toml::table table = set_table(trimmed(argument.substr(equals + 1)), parameter->kind);
    const std::optional<Value> value = convert(table.begin()->second, *parameter, Problems::no_line, place, problems_);
    if (!value) {
        misread_.insert(key);
        return;
    }
    misread_.erase(key);
    case_.settings_[key] = {*value, place, true};
    displace(*parameter, key);
}

/// Checks that the number of a repeated table in a --set key exists or is the next one. That one it adds. Other keys
/// carry no number.
bool CaseReader::count_repeated(const std::string& key, const std::string& place) {
    const std::string table = repeated_table_of(key);
    const std::string plain = without_numbers(key);
    if (table.empty()) {
        if (key == plain) return true;
        problems_.add(place, "found a number in the key", "expected " + plain, "remove the number");
        return false;
    }
    const std::string number =
        key.size() > plain.size() ? key.substr(table.size() + 1, key.size() - plain.size() - 1) : "";
    const bool usable = !number.empty() && number.size() < 7 &&
                        std::all_of(number.begin(), number.end(), [](unsigned char c) { return std::isdigit(c); });
    const Index have = case_.count(table);
    if (!usable || std::stol(number) > have) {
        problems_.add(place, usable ? fmt::format("found number {}", number) : "found no number of the table",
                      fmt::format("expected {}.0 to {}.{}", table, table, have),
                      fmt::format("number the tables from 0, such as {}.0.{}", table, plain.substr(table.size() + 1)));
        return false;
    }
    case_.counts_[table] = std::max(have, static_cast<Index>(std::stol(number) + 1));
    return true;
}

/// A --set replaces what the file says in another way: mu for friction_angle_deg. It also replaces the parameters of a
/// law that --set exchanges for another. Each displaced key is remarked upon.
void CaseReader::displace(const Parameter& parameter, const std::string& key) {
    const std::string prefix = key.substr(0, key.rfind('.') + 1);
    if (!parameter.instead_of.empty()) {
        const std::string other = prefix + parameter.instead_of.substr(parameter.instead_of.rfind('.') + 1);
        const auto found = case_.settings_.find(other);
        if (found != case_.settings_.end() && !found->second.from_set) {
            case_.log_.push_back(fmt::format("{}: replaced by --set {}", found->second.place, key));
            case_.settings_.erase(found);
        }
    }
    drop_unused_from_file(parameter);
}

void CaseReader::drop_unused_from_file(const Parameter& switched) {
    for (const Parameter& parameter : parameters()) {
        if (parameter.switch_key != switched.key) continue;
        const auto found = case_.settings_.find(parameter.key);
        if (found == case_.settings_.end() || found->second.from_set) continue;
        const std::string& chosen = case_.word(switched.key);
        if (std::find(parameter.used_by.begin(), parameter.used_by.end(), chosen) != parameter.used_by.end()) continue;
        case_.log_.push_back(
            fmt::format("{}: not used, since --set {} is \"{}\"", found->second.place, switched.key, chosen));
        case_.settings_.erase(found);
    }
}

}  // namespace frana
