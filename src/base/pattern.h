#pragma once
// Regular expressions (ECMAScript). Only pattern.cpp reads <regex>, which takes two seconds to compile wherever it is used.
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace frana {

class Pattern {
public:
    enum class Case { told_apart, ignored };
    explicit Pattern(const std::string& text, Case letters = Case::told_apart);

    /// Whether it is all of a text.
    bool matches(const std::string& text) const;
    /// Whether it is anywhere in a text.
    bool is_in(const std::string& text) const;
    /// If it is all of a text: what its groups found, in their order. Empty for one that found nothing.
    std::optional<std::vector<std::string>> groups(const std::string& text) const;

private:
    struct Compiled;
    std::shared_ptr<const Compiled> compiled_;
};

}  // namespace frana
