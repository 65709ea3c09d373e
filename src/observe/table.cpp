#include "observe/table.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>

#include "base/atomic_file.h"
#include "base/error.h"

namespace frana {
namespace {

std::string joined(const std::vector<std::string>& words, const char* between) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : between) + word;
    return text;
}

std::vector<std::string> cells_of(const std::string& line) {
    std::vector<std::string> cells(1);
    for (const char letter : line) {
        if (letter == '\r') continue;
        if (letter == ',')
            cells.emplace_back();
        else
            cells.back() += letter;
    }
    return cells;
}

double number(const std::string& cell, const std::string& file, std::size_t line) {
    if (cell.empty()) return TableWriter::empty;
    double value = 0.0;
    const char* const end = cell.data() + cell.size();
    const auto [stop, failure] = std::from_chars(cell.data(), end, value);
    if (failure != std::errc() || stop != end)
        throw UserError(
            fmt::format("{}:{}: found \"{}\" where a number is expected; the file was changed or is "
                        "not frana's, run the case again",
                        file, line, cell));
    return value;
}

}  // namespace

TableWriter::TableWriter(std::filesystem::path file, std::vector<std::string> columns)
    : file_(std::move(file)), columns_(std::move(columns)) {}

void TableWriter::add(const std::vector<double>& row) {
    expect(row.size() == columns_.size(), "a table row has one value per column");
    for (std::size_t i = 0; i < row.size(); ++i) {
        if (i > 0) pending_ += ',';
        expect(!std::isinf(row[i]), "no infinity reaches a table");
        if (std::isnan(row[i])) continue;
        const bool whole = std::abs(row[i]) < 1e15 && row[i] == std::floor(row[i]);
        pending_ += whole ? fmt::format("{}", static_cast<long long>(row[i])) : fmt::format("{}", row[i]);
    }
    pending_ += '\n';
}

void TableWriter::flush() {
    if (!begun_) {
        std::error_code ignored;
        std::filesystem::create_directories(file_.parent_path(), ignored);  // write_text says what is wrong
        write_text(file_, joined(columns_, ",") + "\n" + pending_);
        bytes_ = std::filesystem::file_size(file_);
        begun_ = true;
        pending_.clear();
        return;
    }
    std::ofstream stream(file_, std::ios::binary | std::ios::app);
    stream << pending_;
    stream.flush();
    if (!stream) {
        std::error_code ignored;
        std::filesystem::resize_file(file_, bytes_, ignored);  // all rows or none, so that they can be tried again
        throw UserError(fmt::format("{}: rows cannot be added; check the disk's free space and the file's permissions",
                                    file_.string()));
    }
    bytes_ += pending_.size();
    pending_.clear();
}

void TableWriter::serialize(Archive& archive) {
    if (!archive.loading()) flush();
    auto bytes = static_cast<Index>(bytes_);
    archive.number("bytes", bytes);
    if (!archive.loading()) return;
    bytes_ = static_cast<std::uintmax_t>(bytes);
    cut_back(file_, bytes_);
    begun_ = true;
}

void serialize_all(Archive& archive, std::vector<TableWriter>& tables) {
    for (std::size_t i = 0; i < tables.size(); ++i) {
        const Archive::Part part(archive, std::to_string(i));
        tables[i].serialize(archive);
    }
}

bool Table::has(const std::string& name) const {
    return std::find(columns.begin(), columns.end(), name) != columns.end();
}

const std::vector<double>& Table::column(const std::string& name) const {
    const auto found = std::find(columns.begin(), columns.end(), name);
    if (found == columns.end())
        throw UserError(fmt::format("{}: no column \"{}\"; found {}; run the case again with this version of frana",
                                    source, name, joined(columns, ", ")));
    return values[static_cast<std::size_t>(found - columns.begin())];
}

Table read_table(const std::filesystem::path& file) {
    std::ifstream stream(file);
    std::string line;
    if (!std::getline(stream, line) || line.empty())
        throw UserError(
            fmt::format("{}: cannot be read, or is empty; expected a table with a header line; run the "
                        "case again",
                        file.string()));
    Table table;
    table.source = file.string();
    for (const std::string& heading : cells_of(line)) {
        const std::size_t bracket = heading.find(" [");
        table.columns.push_back(heading.substr(0, bracket));
        const bool has_unit = bracket != std::string::npos && heading.back() == ']';
        table.units.push_back(has_unit ? heading.substr(bracket + 2, heading.size() - bracket - 3) : "");
    }
    table.values.resize(table.columns.size());
    for (std::size_t row = 2; std::getline(stream, line); ++row) {
        const std::vector<std::string> cells = cells_of(line);
        if (cells.size() != table.columns.size())
            throw UserError(
                fmt::format("{}:{}: {} cells, expected {} as in the header; the file was cut short or "
                            "changed, run the case again",
                            table.source, row, cells.size(), table.columns.size()));
        for (std::size_t i = 0; i < cells.size(); ++i) table.values[i].push_back(number(cells[i], table.source, row));
    }
    return table;
}

}  // namespace frana
