#include "run/ensemble/kept_rows.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
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

UserError other_columns(const fs::path& file, const RowsOf& of) {
    return UserError(fmt::format(
        "{}: found rows of another build of frana, which kept other numbers of its runs; expected the columns of this "
        "one; choose another folder with --out and run the {} anew, or take that build",
        file.string(), of.what));
}

/// Letters that end a field, a row or a remark, and the one that codes begin with.
constexpr const char* kEscaped = "%,|\n\r";

std::string escaped(const std::string& text) {
    std::string field;
    for (const char letter : text)
        if (std::strchr(kEscaped, letter) != nullptr)
            field += fmt::format("%{:02X}", static_cast<unsigned char>(letter));
        else
            field += letter;
    return field;
}

std::string unescaped(const std::string& field) {
    std::string text;
    for (std::size_t k = 0; k < field.size(); ++k) {
        if (field[k] != '%') {
            text += field[k];
            continue;
        }
        const std::string code = field.substr(k + 1, 2);
        if (code.size() < 2) throw std::invalid_argument("half a letter");
        text += static_cast<char>(std::stoi(code, nullptr, 16));
        k += 2;
    }
    return text;
}

}  // namespace

std::string remarks_field(const std::vector<EndRemark>& remarks) {
    std::string field;
    for (const EndRemark& remark : remarks)
        field += fmt::format("{}{} {}", field.empty() ? "" : "|", remark.worse, escaped(remark.text));
    return field;
}

std::vector<EndRemark> remarks_of_field(const std::string& field) {
    std::vector<EndRemark> remarks;
    std::istringstream stream(field);
    for (std::string one; std::getline(stream, one, '|');) {
        const std::size_t blank = one.find(' ');
        if (blank == std::string::npos) throw std::invalid_argument("no remark");
        remarks.push_back({unescaped(one.substr(blank + 1)), kept_number(one.substr(0, blank))});
    }
    return remarks;
}

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
    if (line != of.columns) throw other_columns(file, of);
    while (std::getline(stream, line)) body(line);
}

}  // namespace frana
