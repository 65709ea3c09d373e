#include "law/solid/laws.h"

#include <algorithm>

#include "base/error.h"
#include "law/catalogue.h"

namespace frana::solid {
namespace {

bool same(const Key& a, const Key& b) {
    const std::string unit = a.unit, meaning = a.meaning, absent = a.absent;
    return unit == b.unit && a.range == b.range && meaning == b.meaning && a.missing == b.missing &&
           a.usual == b.usual && absent == b.absent && a.choices == b.choices;
}

template <class Law>
void add_keys(std::vector<SharedKey>& all) {
    for (const Key& key : Law::keys()) {
        const std::string name = key.name;
        auto row = std::find_if(all.begin(), all.end(), [&](const SharedKey& other) { return name == other.key.name; });
        if (row == all.end()) row = all.insert(row, {key, {}, {}});
        expect(same(row->key, key), "a key that two laws have must be the same in both");
        row->used_by.emplace_back(Law::name);
        if (key.missing == Missing::refused) row->needed_by.emplace_back(Law::name);
    }
}

template <class... Laws>
std::vector<SharedKey> keys_of(const std::variant<Laws...>*) {
    std::vector<SharedKey> all;
    (add_keys<Laws>(all), ...);
    return all;
}

template <class... Laws>
SolidLaw made(const std::variant<Laws...>*, const std::string& word, const Values& value) {
    std::optional<SolidLaw> law;
    ((word == Laws::name ? void(law = Laws::of(value)) : void()), ...);
    expect(law.has_value(), "a law that the list does not have");
    return *law;
}

constexpr const SolidLaw* kList = nullptr;

}  // namespace

bool is_granular(const SolidLaw& law) {
    return std::holds_alternative<DruckerPrager>(law) || std::holds_alternative<MuI>(law);
}

std::vector<std::string> words() { return laws::Catalogue<SolidLaw>::words(); }

std::vector<SharedKey> shared_keys() { return keys_of(kList); }

bool has_key(const std::string& word, const std::string& key) {
    for (const SharedKey& one : shared_keys())
        if (key == one.key.name) return std::find(one.used_by.begin(), one.used_by.end(), word) != one.used_by.end();
    return false;
}

SolidLaw make(const std::string& word, const Values& value) { return made(kList, word, value); }

}  // namespace frana::solid
