#include "run/ensemble/kept_rows.h"

#include <fmt/core.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <vector>

#include "base/checksum.h"
#include "base/error.h"
#include "base/number_text.h"
#include "ensemble/sample_table.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

void require_same(const fs::path& file, const std::string& found, const RowsOf& of) {
    const std::string& expected = of.mark;
    if (found == expected) return;
    const std::vector<std::string> a = comma_fields(found), b = comma_fields(expected);
    std::string what = "its first line";
    for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k)
        if (a[k] != b[k]) {
            what = fmt::format("\"{}\" where now it is \"{}\"", a[k], b[k]);
            break;
        }
    throw UserError(fmt::format(
        "{}: found {}; expected runs of the same {}; choose another folder with --out, or give the files back "
        "that these runs were made with",
        file.string(), what, of.what));
}

}  // namespace

std::string text_in(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

std::uint64_t sum_of(const std::string& text) {
    Checksum sum;
    sum.add_all(text);
    return sum.sum();
}

std::string plain_field(std::string text) {
    for (char& letter : text)
        if (letter == ',' || letter == '\n' || letter == '\r') letter = letter == ',' ? ';' : ' ';
    return text;
}

double kept_number(const std::string& field) {
    const std::optional<double> number = number_in(field);
    if (!number) throw std::invalid_argument("no number");
    return *number;
}

UserError broken_row(const fs::path& file, const std::string& line) {
    return UserError(fmt::format(
        "{}: found the row \"{}\"; expected the rows that this command writes; remove the folder of this file "
        "and run it again",
        file.string(), line));
}

void require_rows_of(const fs::path& file, const RowsOf& of) {
    std::ifstream stream(file);
    std::string line;
    std::getline(stream, line);
    require_same(file, line, of);
}

void for_each_row(const fs::path& file, const RowsOf& of, const std::function<void(const std::string& line)>& body) {
    std::ifstream stream(file);
    std::string line;
    std::getline(stream, line);
    require_same(file, line, of);
    std::getline(stream, line);
    if (line != of.columns) throw broken_row(file, line);
    while (std::getline(stream, line)) body(line);
}

}  // namespace frana
