#include "scene/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "base/error.h"

namespace frana {
namespace {

std::string joined(const std::vector<std::string>& words, const std::string& separator) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : separator) + word;
    return text;
}

/// Optimal string alignment distance: insert, delete, replace, swap of neighbours.
std::size_t edit_distance(const std::string& a, const std::string& b) {
    std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
    for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t replace = d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, replace});
            const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
            if (swapped) d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
        }
    }
    return d[a.size()][b.size()];
}

std::string number_text(double value) {
    std::string text = fmt::format("{}", value);
    if (text.find_first_of(".e") == std::string::npos) text += ".0";
    return text;
}

std::string quoted(const std::string& text) {
    std::string result = "\"";
    for (const char c : text) {
        const unsigned char byte = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\')
            result += std::string("\\") + c;
        else if (byte < 0x20 || byte == 0x7f)
            result += fmt::format("\\u{:04X}", byte);
        else
            result += c;
    }
    return result + "\"";
}

template <class Item, class Text>
std::string list_text(const std::vector<Item>& items, Text&& text) {
    std::vector<std::string> parts;
    parts.reserve(items.size());
    for (const Item& item : items) parts.push_back(text(item));
    return "[" + joined(parts, ", ") + "]";
}

struct ValueText {
    std::string operator()(bool value) const { return value ? "true" : "false"; }
    std::string operator()(double value) const { return number_text(value); }
    std::string operator()(const std::string& value) const { return quoted(value); }
    std::string operator()(const std::vector<double>& values) const { return list_text(values, number_text); }
    std::string operator()(const std::vector<std::string>& values) const { return list_text(values, quoted); }
    std::string operator()(const std::vector<Vec2>& values) const {
        return list_text(values, [](const Vec2& point) {
            return "[" + number_text(point.x()) + ", " + number_text(point.y()) + "]";
        });
    }
};

}  // namespace

std::string Parameter::switch_of(const std::string& own_key) const {
    const std::size_t dot = switch_key.rfind('.');
    return switch_key.compare(0, dot, table()) == 0 && dot == table().size()
               ? own_key.substr(0, own_key.rfind('.')) + switch_key.substr(dot)
               : switch_key;
}

std::string Parameter::table() const { return key.substr(0, key.size() - name().size() - 1); }

std::string Parameter::name() const {
    for (const std::string& repeated : repeated_tables())
        if (key.compare(0, repeated.size() + 1, repeated + ".") == 0) return key.substr(repeated.size() + 1);
    return key.substr(key.rfind('.') + 1);
}

std::string Parameter::expected() const {
    const std::string in_unit = unit.empty() || unit == "1" ? "" : " [" + unit + "]";
    const std::string in_range = range.is_all() ? "" : " " + range.text();
    switch (kind) {
        case Kind::number:
            return "a number" + in_range + in_unit;
        case Kind::integer:
            return "a whole number" + in_range;
        case Kind::flag:
            return "true or false";
        case Kind::text:
            return "a text in quotes";
        case Kind::name:
            return fmt::format("a text in quotes of up to {} letters, digits, - and _", kLongestName);
        case Kind::choice:
            return "one of \"" + joined(choices, "\", \"") + "\"";
        case Kind::path:
            return "the name of a file in quotes";
        case Kind::number_or_path:
            return "a number" + in_range + in_unit + " or the name of a raster";
        case Kind::number_or_choice:
            return "a number" + in_range + in_unit + " or one of \"" + joined(choices, "\", \"") + "\"";
        case Kind::numbers:
            return (length > 0 ? fmt::format("a list of {} numbers", length) : "a list of numbers") + in_unit;
        case Kind::numbers_or_paths:
            return fmt::format("a list of {} numbers", length) + in_unit + fmt::format(" or of {} rasters", length);
        case Kind::points:
            return fmt::format("a list of {} or more points [x, y]", length) + in_unit;
        case Kind::points_or_path:
            return fmt::format("a list of {} or more points [x, y]", length) + in_unit +
                   " or the name of a vector file";
        case Kind::words:
            return std::string(may_be_empty ? "an empty list, or a list of \"" : "a list of \"") +
                   joined(choices, "\", \"") + "\"";
        case Kind::words_or_all:
            return "\"all\" or a list of \"" + joined(choices, "\", \"") + "\"";
    }
    throw InternalError("internal error: a kind of parameter without text");
}

bool names_files(Kind kind) {
    return kind == Kind::path || kind == Kind::number_or_path || kind == Kind::numbers_or_paths ||
           kind == Kind::points_or_path;
}

std::string without_numbers(const std::string& key) {
    std::string result;
    std::size_t begin = 0;
    while (begin <= key.size()) {
        const std::size_t end = std::min(key.find('.', begin), key.size());
        const std::string part = key.substr(begin, end - begin);
        const bool digits = !part.empty() &&
                            std::all_of(part.begin(), part.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
        if (!digits) result += (result.empty() ? "" : ".") + part;
        begin = end + 1;
    }
    return result;
}

const Parameter* find_parameter(const std::string& key) {
    const std::string plain = without_numbers(key);
    for (const Parameter& parameter : parameters())
        if (parameter.key == plain) return &parameter;
    return nullptr;
}

std::string closest(const std::string& word, const std::vector<std::string>& known) {
    std::string best;
    std::size_t best_distance = std::max<std::size_t>(2, word.size() / 4) + 1;
    for (const std::string& candidate : known) {
        const std::size_t distance = edit_distance(word, candidate);
        // A candidate that shares nothing with a short word is no better than any other.
        if (distance >= std::max(word.size(), candidate.size())) continue;
        if (distance < best_distance) {
            best = candidate;
            best_distance = distance;
        }
    }
    return best;
}

std::string toml_text(const Value& value) { return std::visit(ValueText(), value); }

}  // namespace frana
