#pragma once
// How a CaseFile comes about: TOML text, then --set, then the rules that tie keys together. Private to
// case_file.cpp and its tests.
#include <toml++/toml.h>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "scene/case_file.h"
#include "scene/problems.h"

namespace frana {

/// Fills one CaseFile; problems are gathered, never thrown.
class CaseReader {
public:
    CaseReader(CaseFile& target, Problems& problems) : case_(target), problems_(problems) {}

    /// Reads the file's text. False when it is not TOML at all: nothing more can be said then.
    bool read_text(const std::string& text);
    /// Applies one "key=value".
    void apply_set(const std::string& argument);
    /// Missing keys, keys that exclude each other, keys that the chosen law does not use (case_rules.cpp).
    void check_rules();
    /// That the files which the case names exist.
    void check_files();

private:
    void read_table(const toml::table& table, const std::string& prefix);
    void read_entry(const toml::node& node, const std::string& key);
    void read_repeated(const toml::node& node, const std::string& name);
    void read_leaf(const toml::node& node, const Parameter& parameter, const std::string& key);
    void refuse_unknown(const std::string& key, int line, const std::string& place);
    bool count_repeated(const std::string& key, const std::string& place);
    void displace(const Parameter& parameter, const std::string& key);
    void drop_unused_from_file(const Parameter& switched);

    void check_tables();
    void check_sources();
    void check_missing(const std::string& prefix, const std::string& table);
    void check_alternatives(const std::string& prefix, const std::string& table);
    void check_unused(const std::string& prefix, const std::string& table);
    void check_release(const std::string& prefix);
    void check_release_time(const std::string& prefix);
    void check_something_flows();
    void check_layer(const std::string& prefix);
    void check_barrier(const std::string& prefix);
    void check_height_field(const std::string& prefix);
    bool friction_table() const;
    void check_surveyed_bed();
    void check_forest();
    void check_forest_speeds();
    void check_friction_table();
    void check_table_numbers();
    void check_inflow(const std::string& prefix);
    void check_zone(const std::string& prefix);
    void check_line_names(const std::string& table);
    void check_meaning();
    void check_combinations();
    bool unused(const std::string& key) const;
    void missing(const std::string& key, const Parameter& parameter, const std::string& why);
    void wrong(const std::string& key, const std::string& found, const std::string& expected,
               const std::string& way_out);

    int line_of(const std::string& key) const;
    std::string place_of(const std::string& key, int line) const;

    CaseFile& case_;
    Problems& problems_;
    std::map<std::string, int> lines_;  ///< concrete key -> line in the file
    std::set<std::string> misread_;     ///< keys that were there, but wrong: not missing
};

}  // namespace frana
