#pragma once
// A table of a TOML file, read key by key; whatever is wrong is gathered. Private to the readers of this room.
#include <toml++/toml.h>

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "base/types.h"
#include "scene/problems.h"

namespace frana {

/// "a, b or c".
std::string listed(const std::vector<std::string>& words);

/// Reads one table. Every key that is not read is a problem.
class CheckedTable {
public:
    CheckedTable(const toml::table& table, std::string name, const std::filesystem::path& file, Problems& problems)
        : table_(table), name_(std::move(name)), file_(file), problems_(problems) {}

    const std::string& name() const { return name_; }
    void wrong(const std::string& key, const std::string& found, const std::string& expected,
               const std::string& way_out) const;
    bool given(const std::string& key);
    std::string text(const std::string& key, const std::string& otherwise = "");
    double number(const std::string& key, double otherwise);
    Index whole(const std::string& key, Index otherwise, Index least, Index most);
    std::vector<double> numbers(const std::string& key);
    /// As a case file has them: texts have their quotes.
    std::vector<std::string> values(const std::string& key);
    const toml::node* node(const std::string& key);
    void refuse_others(const std::string& when) const;

private:
    const toml::table& table_;
    std::string name_;
    const std::filesystem::path& file_;
    Problems& problems_;
    std::set<std::string> asked_;
};

}  // namespace frana
