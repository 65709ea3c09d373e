// resolved.toml: the case with nothing left to assume.
#include <fmt/format.h>

#include <algorithm>

#include "scene/case_file.h"
#include "scene/combinations.h"

namespace frana {
namespace {

bool contains(const std::vector<std::string>& words, const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

class Resolver {
public:
    explicit Resolver(const CaseFile& file) : case_(file) {}

    std::string text() {
        out_ = fmt::format("# {} with every key, SI units; \"# default\" marks what the case leaves open.\n",
                           case_.file().filename().string());
        std::vector<std::string> done;
        for (const Parameter& parameter : parameters()) {
            const std::string table = parameter.table();
            if (contains(done, table)) continue;
            done.push_back(table);
            if (!contains(repeated_tables(), table)) {
                add_table(table, "[" + table + "]", table + ".");
                continue;
            }
            for (Index i = 0; i < case_.count(table); ++i)
                add_table(table, "[[" + table + "]]", fmt::format("{}.{}.", table, i));
        }
        return out_;
    }

private:
    void add_table(const std::string& table, const std::string& header, const std::string& prefix) {
        out_ += "\n" + header + "\n";
        for (const Parameter& parameter : parameters())
            if (parameter.table() == table) add_key(parameter, prefix);
    }

    void add_key(const Parameter& parameter, const std::string& prefix) {
        const std::string key = prefix + parameter.name();
        if (case_.given(key)) {
            out_ += fmt::format("{} = {}\n", parameter.name(), value_text(parameter, *case_.find(key)));
            return;
        }
        const std::string choice = parameter.switch_key.empty() ? "" : parameter.switch_of(key);
        const bool unused = !choice.empty() && (!case_.has(choice) || !contains(parameter.used_by, case_.word(choice)));
        const bool said_otherwise =
            !parameter.instead_of.empty() && case_.given(prefix + find_parameter(parameter.instead_of)->name());
        const bool alone =
            !parameter.only_with.empty() && !case_.given(prefix + find_parameter(parameter.only_with)->name());
        if (unused || said_otherwise || alone || refused_if_given(case_, key)) return;
        if (const Value* value = case_.find(key))
            out_ += fmt::format("{} = {}  # default\n", parameter.name(), value_text(parameter, *value));
        else if (!parameter.absent.empty())
            out_ += fmt::format("# {}: not given; {}\n", parameter.name(), parameter.absent);
    }

    std::string value_text(const Parameter& parameter, const Value& value) const {
        if (parameter.kind == Kind::words_or_all && std::get<std::vector<std::string>>(value).empty()) return "\"all\"";
        if (!names_files(parameter.kind)) return toml_text(value);
        if (const auto* one = std::get_if<std::string>(&value)) return toml_text(absolute(*one));
        if (const auto* several = std::get_if<std::vector<std::string>>(&value)) {
            std::vector<std::string> paths;
            for (const std::string& path : *several) paths.push_back(absolute(path));
            return toml_text(paths);
        }
        return toml_text(value);
    }

    /// resolved.toml lies elsewhere than the case, so that relative paths would not be found.
    std::string absolute(const std::string& path) const {
        const std::filesystem::path resolved = case_.resolve(path);
        if (resolved.string() == path && path.find(':') != std::string::npos) return path;  // a name of GDAL's
        return std::filesystem::absolute(resolved).lexically_normal().string();
    }

    const CaseFile& case_;
    std::string out_;
};

}  // namespace

std::string resolved_toml(const CaseFile& file) { return Resolver(file).text(); }

}  // namespace frana
