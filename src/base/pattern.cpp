#include "base/pattern.h"

#include <regex>

namespace frana {

struct Pattern::Compiled {
    std::regex expression;
};

Pattern::Pattern(const std::string& text, Case letters)
    : compiled_(std::make_shared<Compiled>(Compiled{std::regex(
          text, letters == Case::ignored ? std::regex::ECMAScript | std::regex::icase : std::regex::ECMAScript)})) {}

bool Pattern::matches(const std::string& text) const { return std::regex_match(text, compiled_->expression); }

bool Pattern::is_in(const std::string& text) const { return std::regex_search(text, compiled_->expression); }

std::optional<std::vector<std::string>> Pattern::groups(const std::string& text) const {
    std::smatch parts;
    if (!std::regex_match(text, parts, compiled_->expression)) return std::nullopt;
    std::vector<std::string> found;
    for (std::size_t n = 1; n < parts.size(); ++n) found.push_back(parts[n].str());
    return found;
}

}  // namespace frana
