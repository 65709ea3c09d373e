#include "law/solid/laws.h"

#include <algorithm>
#include <iterator>

namespace frana::solid {
namespace {

struct Word {
    std::string word;
    std::vector<std::string> keys;
};

template <class... Laws>
std::vector<Word> words_of(const std::variant<Laws...>*) {
    return {{Laws::name, {std::begin(Laws::keys), std::end(Laws::keys)}}...};
}

std::vector<Word> list() { return words_of(static_cast<const SolidLaw*>(nullptr)); }

bool holds(const std::vector<std::string>& all, const std::string& one) {
    return std::find(all.begin(), all.end(), one) != all.end();
}

}  // namespace

std::vector<std::string> words() {
    std::vector<std::string> all;
    for (const Word& law : list()) all.push_back(law.word);
    return all;
}

std::vector<std::string> words_with(const std::string& key) {
    std::vector<std::string> some;
    for (const Word& law : list())
        if (holds(law.keys, key)) some.push_back(law.word);
    return some;
}

std::vector<std::string> all_keys() {
    std::vector<std::string> all;
    for (const Word& law : list())
        for (const std::string& key : law.keys)
            if (!holds(all, key)) all.push_back(key);
    return all;
}

}  // namespace frana::solid
