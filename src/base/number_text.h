#pragma once
// Numbers in texts. They have a point whatever the locale of the program that uses this library. strtod() and stod()
// follow the locale, and Python and QGIS set one.
#include <charconv>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

namespace frana {

/// A number that a text begins with, blanks and a plus before it aside, and how many letters were read.
struct LeadingNumber {
    double value = 0.0;
    std::size_t length = 0;
};

/// Nothing where the text does not begin with a number, or with one that no double can hold.
inline std::optional<LeadingNumber> leading_number(std::string_view text) {
    std::size_t from = text.find_first_not_of(" \t\r\n\v\f");
    if (from == std::string_view::npos) return std::nullopt;
    if (text[from] == '+' && from + 1 < text.size() && text[from + 1] != '-') ++from;
    LeadingNumber number;
    const auto [stop, failure] = std::from_chars(text.data() + from, text.data() + text.size(), number.value);
    if (failure != std::errc()) return std::nullopt;
    number.length = static_cast<std::size_t>(stop - text.data());
    return number;
}

/// The number that is all of a text, blanks before it aside; nothing of any other text.
inline std::optional<double> number_in(std::string_view text) {
    const std::optional<LeadingNumber> number = leading_number(text);
    if (!number || number->length != text.size()) return std::nullopt;
    return number->value;
}

/// A unit as it follows a number: " kPa"; nothing after a pure number, whose unit is "1" or none.
inline std::string after_number(const std::string& unit) { return unit.empty() || unit == "1" ? "" : " " + unit; }

}  // namespace frana
