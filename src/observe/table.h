#pragma once
// Tables of numbers as CSV: one header line, then rows that only ever grow. A cell without a value is empty.
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "base/types.h"
#include "observe/archive.h"

namespace frana {

/// Writes a CSV while a run goes on. Rows are held until flush(), which appends whole lines, so the file can be read at
/// any moment. A NaN becomes an empty cell (outside the grid, no data). Other numbers are written with as many digits
/// as it takes to read the same number back.
class TableWriter {
public:
    static constexpr double empty = std::numeric_limits<double>::quiet_NaN();
    TableWriter(std::filesystem::path file, std::vector<std::string> columns);
    const std::vector<std::string>& columns() const { return columns_; }
    /// One value per column; whole numbers are written without a fraction.
    void add(const std::vector<double>& row);
    /// The first time the file (and its folder) is made with its header; an older file is replaced. Throws UserError
    /// when the rows cannot be written.
    void flush();
    /// Saves how long the file is, after a flush, or cuts it back to that. Throws UserError when it is shorter.
    void serialize(Archive& archive);

private:
    std::filesystem::path file_;
    std::vector<std::string> columns_;
    std::string pending_;
    bool begun_ = false;        ///< the file has its header
    std::uintmax_t bytes_ = 0;  ///< of the file
};

/// All tables of an observer, one after the other.
void serialize_all(Archive& archive, std::vector<TableWriter>& tables);

/// A table read back. Column names stand without their unit: "depth [m]" is found as "depth".
struct Table {
    std::vector<std::string> columns;
    std::vector<std::string> units;           ///< "m", or empty where the header names none
    std::vector<std::vector<double>> values;  ///< by column; NaN where the cell is empty

    std::size_t rows() const { return values.empty() ? 0 : values.front().size(); }
    bool has(const std::string& column) const;
    /// Throws UserError when there is no such column.
    const std::vector<double>& column(const std::string& column) const;
    std::string source;
};

/// Reads a CSV written by TableWriter. Throws UserError with file, line and what was found.
Table read_table(const std::filesystem::path& file);

}  // namespace frana
