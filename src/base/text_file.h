#pragma once
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

#include "base/atomic_file.h"

namespace frana {

/// Text written piece by piece through a buffer, to appear as a whole.
class TextFile {
public:
    explicit TextFile(const std::filesystem::path& target);

    template <class... Values>
    void put(fmt::format_string<Values...> format, Values&&... values) {
        fmt::format_to(std::back_inserter(buffer_), format, std::forward<Values>(values)...);
        if (buffer_.size() > std::size_t{1} << 20) flush();
    }
    /// Throws UserError with the path when the file cannot be written.
    void commit();

private:
    void flush();
    std::filesystem::path target_;
    AtomicFile file_;
    std::ofstream stream_;
    fmt::memory_buffer buffer_;
};

/// The text of a file, without the byte-order mark that Excel puts before it. Nothing where no file can be read.
std::optional<std::string> text_in_file(const std::filesystem::path& file);

/// A text between quotes as JSON has it.
std::string json_text(const std::string& text);

}  // namespace frana
