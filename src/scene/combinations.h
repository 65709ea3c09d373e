#pragma once
// What cannot go together in a case. One table: checks, their messages and `frana describe --combinations` read it.
#include <optional>
#include <string>
#include <vector>

#include "scene/case_file.h"

namespace frana {

/// Some of the values that a key can have, or tables of a name that are there at all.
struct Values {
    /// on_later: true, of a release that enters later. given: text, or a number above 0. present: whatever it is.
    enum class Are { words, others, without, above_zero, zero, on, off, on_later, tables, given, present };
    std::string key;  ///< of tables their name; "release.at" is that of any [[release]]
    Are are = Are::words;
    std::vector<std::string> words = {};  ///< those, all others, or (without) what a list of words lacks

    /// The keys that have one of them, by default or given: of repeated tables in each, "release.1.at". With a
    /// neighbour, a key of the same repeated table, that one table alone.
    std::vector<std::string> keys_in(const CaseFile& file, const std::string& neighbour = "") const;
    /// `scheme.shape = "cubic"`, `terrain.model other than "steep"`.
    std::string text() const;
};

/// A row: what is refused when the case gives it, and with what.
struct Combination {
    Values refused;
    std::vector<Values> with;  ///< any of these
    std::string expected, way_out;
    std::string said = {};          ///< `with` in the message where it is not " with KEY = VALUE"
    std::vector<Values> also = {};  ///< and all of these

    /// Whether the case has what that key is refused with.
    bool applies(const CaseFile& file, const std::string& key) const;
    /// The keys that the case gives and the row refuses.
    std::vector<std::string> found(const CaseFile& file) const;
    /// "found "cubic" with scheme.preset = "paper"".
    std::string found_text(const CaseFile& file, const std::string& key) const;
};

const std::vector<Combination>& combinations();

/// Whether a key's default would be refused if it were given: it has no effect then. Of repeated tables "release.0.at".
bool refused_if_given(const CaseFile& file, const std::string& key);

/// The table for people.
std::string describe_combinations();
/// The same as a section of a page of Markdown.
std::string combinations_in_markdown();

}  // namespace frana
