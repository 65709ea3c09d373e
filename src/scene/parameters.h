#pragma once
// The one table of case keys. Parser, checks, `frana describe`, resolved.toml and --set all read it.
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/range.h"
#include "base/types.h"

namespace frana {

/// What a case key can hold.
using Value = std::variant<bool, double, std::string, std::vector<double>, std::vector<std::string>, std::vector<Vec2>>;

constexpr std::size_t kLongestName = 200;  ///< of a name that files get: theirs have 255 letters at most

enum class Kind {
    number,            ///< double
    integer,           ///< double without fraction
    flag,              ///< bool
    text,              ///< std::string
    name,              ///< std::string fit for a file name
    choice,            ///< std::string, one of Parameter::choices
    path,              ///< std::string
    number_or_path,    ///< double or std::string (a raster)
    number_or_choice,  ///< double or std::string, one of Parameter::choices
    numbers,           ///< Parameter::length doubles; length 0: one or more
    numbers_or_paths,  ///< Parameter::length doubles or as many std::string (rasters)
    points,            ///< Vec2, at least Parameter::length
    points_or_path,    ///< the same or std::string (a vector file)
    words,             ///< std::string, each one of Parameter::choices; none with Parameter::may_be_empty
    words_or_all       ///< the same, or the text "all" (held as an empty list)
};

/// Whether a text of that kind names a file.
bool names_files(Kind kind);

/// Another default that holds when the key `when` has the value `is`.
struct OtherDefault {
    std::string when;
    Value is;  ///< a word or a flag
    Value value;
};

/// One case key.
struct Parameter {
    std::string key;  ///< "release.depth"; repeated tables are named without a number
    Kind kind = Kind::number;
    std::string unit;  ///< "m", "1", ...; empty when it has none
    std::string meaning;
    Range range = {};
    std::vector<std::string> choices = {};
    std::size_t length = 0;                    ///< of lists
    bool may_be_empty = false;                 ///< a list of words without any
    std::optional<Value> fallback = {};        ///< the default
    std::vector<OtherDefault> otherwise = {};  ///< defaults that depend on another choice, such as the preset
    std::string absent = {};                   ///< without default: what happens when the key is not given
    bool required = false;
    std::string switch_key = {};                ///< key of the choice that decides whether this one is used; within
                                                ///< a repeated table that of the same table
    std::vector<std::string> used_by = {};      ///< choices of switch_key that use this key
    std::vector<std::string> required_by = {};  ///< choices of switch_key that need this key
    std::string instead_of = {};  ///< key that says the same in another way: only one of both may be given
    std::string only_with = {};   ///< key of the same table without which this one is refused
    std::map<std::string, std::string> former = {};  ///< words of older cases, and the choice that each means

    /// switch_key for the parameter's own `key`: "insitu.2.kind" for "insitu.2.field".
    std::string switch_of(const std::string& key) const;
    std::string table() const;     ///< "release" of "release.depth"
    std::string name() const;      ///< "depth" of "release.depth"; "rheology.viscosity" in a repeated table
    std::string expected() const;  ///< "a number above 0 [m]"
};

/// All keys, grouped by table, in the order of the documentation.
const std::vector<Parameter>& parameters();
/// The key's parameter ("release.0.depth" and "release.depth" are the same), or nullptr.
const Parameter* find_parameter(const std::string& key);
/// "release.0.depth" -> "release.depth".
std::string without_numbers(const std::string& key);
/// Tables that are written [[name]] and may come several times.
const std::vector<std::string>& repeated_tables();
/// That of them which a key is of, with a number or without: "material.zone" of "material.zone.0.mu"; empty: of none.
std::string repeated_table_of(const std::string& key);
/// The closest of `known` to `word` when it is close enough to be meant, otherwise empty.
std::string closest(const std::string& word, const std::vector<std::string>& known);

/// A value as TOML text; numbers with as many digits as it takes to read the same number back.
std::string toml_text(const Value& value);

/// The table for people: the key, every key of a table or every key that begins with `prefix`; empty: all.
/// Throws UserError with the closest key when nothing matches.
std::string describe(const std::string& prefix);

/// All keys as a page of Markdown, a table for each table of the case file: cases/KEYS.md.
std::string describe_in_markdown();

}  // namespace frana
