#pragma once
// What a list of laws tells readers and descriptions of cases: words, keys, laws from the values of keys.
#include <algorithm>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/error.h"
#include "law/key.h"

namespace frana::laws {

/// A key as all laws of a list have it.
struct SharedKey {
    std::string name, unit, meaning;
    Range range;
    std::string instead_of, more_than, way_out;   ///< as in Key; empty: none
    std::optional<double> usual;                  ///< the default
    std::vector<std::string> used_by, needed_by;  ///< words of the laws
};

template <class Any>
struct Catalogue;

template <class... Laws>
struct Catalogue<std::variant<Laws...>> {
    using Any = std::variant<Laws...>;

    static std::vector<std::string> words() { return {Laws::name...}; }

    /// "; pouliquen is mu(I)" for the laws that are also known as something else.
    static std::string other_names() {
        std::string text;
        ((text += *Laws::is ? std::string("; ") + Laws::name + " is " + Laws::is : ""), ...);
        return text;
    }

    /// In the order in which the laws name them.
    static std::vector<SharedKey> keys() {
        std::vector<SharedKey> all;
        (add_keys<Laws>(all), ...);
        return all;
    }

    /// The law of this word; `value(name)`: std::optional<double> of a key, its default included.
    template <class Value>
    static Any make(const std::string& word, const Value& value) {
        std::optional<Any> law;
        ((word == Laws::name ? void(law = filled<Laws>(value)) : void()), ...);
        expect(law.has_value(), "a law that the list does not have");
        return *law;
    }

private:
    template <class Law>
    static void add_keys(std::vector<SharedKey>& all) {
        for (const Key<Law>& key : Law::keys()) {
            SharedKey mine{key.name,      key.unit,    key.meaning, key.range, key.instead_of,
                           key.more_than, key.way_out, {},          {},        {}};
            if (key.missing == Missing::usual) mine.usual = Law{}.*key.parameter;
            auto row =
                std::find_if(all.begin(), all.end(), [&](const SharedKey& other) { return other.name == mine.name; });
            if (row == all.end()) row = all.insert(row, mine);
            expect(row->unit == mine.unit && row->meaning == mine.meaning && row->range == mine.range &&
                       row->instead_of == mine.instead_of && row->more_than == mine.more_than &&
                       row->usual == mine.usual,
                   "a key that two laws have must be the same in both");
            row->used_by.push_back(Law::name);
            if (key.missing == Missing::refused) row->needed_by.push_back(Law::name);
        }
    }

    template <class Law, class Value>
    static Law filled(const Value& value) {
        Law law;
        for (const Key<Law>& key : Law::keys())
            if (const std::optional<double> given = value(key.name)) law.*key.parameter = key.convert(*given);
        return law;
    }
};

}  // namespace frana::laws
