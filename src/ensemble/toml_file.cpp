#include "ensemble/toml_file.h"

#include <fmt/format.h>

#include <optional>

#include "base/error.h"
#include "base/text_file.h"

namespace frana {

std::string text_of_file(const std::filesystem::path& file) {
    std::optional<std::string> text = text_in_file(file);
    if (!text)
        throw UserError(
            fmt::format("{}: found no file that can be read; expected one; correct the name", file.string()));
    return *std::move(text);
}

void read_toml(const std::string& text, const std::filesystem::path& file, Problems& problems,
               const std::function<void(const toml::table&)>& read) {
    try {
        read(toml::parse(text));
    } catch (const toml::parse_error& error) {  // the parser's way of saying it
        problems.add(fmt::format("{}:{}: TOML", file.string(), error.source().begin.line),
                     "found " + std::string(error.description()), "expected key = value", "correct this line");
    }
}

}  // namespace frana
