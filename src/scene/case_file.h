#pragma once
// A case file, read and checked key by key against the parameter table (scene/parameters.h). The results are plain
// values in SI, each with the place it came from. scene/build_scene.h makes a Scene of them.
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "scene/parameters.h"

namespace frana {

/// One key that the case file or `--set` gives.
struct Setting {
    Value value;
    std::string place;      ///< "case.toml:12: grid.cell" or "--set grid.cell", for messages
    bool from_set = false;  ///< came from --set
};

/// The checked content of a case file. Keys are dotted; repeated tables carry their number:
/// "release.0.depth". A key that is not given has the default of the table, or of the preset that the case
/// chooses.
class CaseFile {
public:
    /// Reads and checks `file`, with `--set` overrides ("key=value", the value in TOML or plain text). Throws
    /// one UserError that lists every problem: syntax, unknown keys, types, ranges, missing keys, missing
    /// files.
    static CaseFile read(const std::filesystem::path& file, const std::vector<std::string>& sets = {});
    /// The same from a text; `file` gives messages their name and relative paths their folder. Files that the
    /// case names need not exist.
    static CaseFile parse(const std::string& text, const std::filesystem::path& file,
                          const std::vector<std::string>& sets = {});

    const std::filesystem::path& file() const { return file_; }
    /// The file's text as read, before overrides.
    const std::string& text() const { return text_; }
    /// Folder of the file when it is called case.toml or resolved.toml, otherwise its stem.
    std::string name() const;
    /// Remarks made while reading (what --set displaced).
    const std::vector<std::string>& log() const { return log_; }

    /// How many [[table]] there are, `table` being "release", "profile" or "gauge".
    Index count(const std::string& table) const;
    /// Given in the file or by --set.
    bool given(const std::string& key) const { return settings_.count(key) > 0; }
    /// Given, or with a default.
    bool has(const std::string& key) const { return find(key) != nullptr; }

    double number(const std::string& key) const;
    Index integer(const std::string& key) const;
    bool flag(const std::string& key) const;
    const std::string& word(const std::string& key) const;
    const std::vector<double>& numbers(const std::string& key) const;
    const std::vector<std::string>& words(const std::string& key) const;
    const std::vector<Vec2>& points(const std::string& key) const;
    /// The value is text: a path where a number could stand as well.
    bool is_text(const std::string& key) const;
    /// A path key, relative ones taken from the case file's folder.
    std::filesystem::path path(const std::string& key) const;
    /// A path as it is to be opened: relative ones from the case file's folder, GDAL's virtual names
    /// untouched.
    std::filesystem::path resolve(const std::string& path) const;
    /// Every file that the given keys name, as it is to be opened, with its key. A key may name several.
    std::vector<std::pair<std::string, std::filesystem::path>> named_files() const;
    /// The files that `set`, as of --set, would name, as they are to be opened. None where it names none, or is wrong.
    std::vector<std::filesystem::path> files_of_set(const std::string& set) const;
    /// The case file, then those: what the case reads.
    std::vector<std::filesystem::path> inputs() const;
    /// "case.toml:12: grid.cell", the place of a key for messages; for an absent key, that of its table.
    std::string place(const std::string& key) const;
    /// "case.toml:4: release.0", the place of a table's header.
    std::string table_place(const std::string& table) const;

    /// The value of a key (given or default), nullptr when it has none.
    const Value* find(const std::string& key) const;

private:
    friend class CaseReader;
    const Value& value(const std::string& key) const;

    std::filesystem::path file_;
    std::string text_;
    std::map<std::string, Setting> settings_;
    std::map<std::string, int> table_lines_;  ///< "terrain" or "release.0" -> line of its header
    std::map<std::string, Index> counts_;     ///< "release" -> number of tables
    std::vector<std::string> log_;
};

/// The case in full: every key in SI, defaults marked "# default", paths absolute. Reading it back gives the
/// same Scene.
std::string resolved_toml(const CaseFile& file);

}  // namespace frana
