#pragma once
// Rows of runs that outlive the program. However it ends, a file of them is whole, and says what they belong to.
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "base/error.h"
#include "run/end_remarks.h"

namespace frana {

/// The bytes of a file; empty where there is none.
std::string text_in(const std::filesystem::path& file);

/// A sum of bytes, for marks.
std::uint64_t sum_of(const std::string& text);

/// A text as a field that ends neither a field nor a line.
std::string plain_field(std::string text);

/// Remarks as a field, and back: each is "HOW_BAD TEXT", with | between them and %XX for what would end a field.
std::string remarks_field(const std::vector<EndRemark>& remarks);
/// Throws std::logic_error where it is none.
std::vector<EndRemark> remarks_of_field(const std::string& field);

/// A field of a row. Throws std::invalid_argument where it is no number.
double kept_number(const std::string& field);

/// A row that is none of those that `file` should hold.
UserError broken_row(const std::filesystem::path& file, const std::string& line);

/// What rows belong to.
struct RowsOf {
    std::string what;     ///< "ensemble", for people
    std::string mark;     ///< first line: all that decides the runs, in fields with commas
    std::string columns;  ///< second line: their names

    std::string head() const { return mark + "\n" + columns + "\n"; }
};

/// Throws UserError where the rows of a file belong to something else (the first difference is said).
void require_rows_of(const std::filesystem::path& file, const RowsOf& of);

/// Passes on the rows of a file. Throws UserError where they belong to something else (the first difference is said), or are no
/// rows.
void for_each_row(const std::filesystem::path& file, const RowsOf& of,
                  const std::function<void(const std::string& line)>& body);

}  // namespace frana
