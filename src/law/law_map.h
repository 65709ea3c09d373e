#pragma once
// Spatially varying laws: those of one kind in a table, and which of them each node of a grid has.
#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <unordered_map>
#include <utility>
#include <variant>
#include <vector>

#include "law/key.h"
#include "law/side_by_side.h"

namespace frana::laws {

template <class Any>
struct TablesOf;
template <class... Laws>
struct TablesOf<std::variant<Laws...>> {
    using Type = std::variant<std::vector<Laws>...>;
};

/// Laws of one kind, which differ in their parameters. Any: the list of all kinds, a std::variant.
template <class Any>
using LawTable = typename TablesOf<Any>::Type;

template <class Any>
struct LawMap {
    LawTable<Any> laws;
    std::vector<std::uint32_t> place;  ///< in the table, of each node; row after row from the south

    Any at(std::size_t node) const {
        return std::visit([&](const auto& table) { return Any(table[place[node]]); }, laws);
    }
};

/// The table of the laws that nodes have, each law once, in the order in which they come.
template <class Any, class Law>
LawMap<Any> law_map(const std::vector<Law>& of_nodes) {
    static_assert(std::is_trivially_copyable_v<Law>, "laws are told apart by their bytes");
    struct Hash {
        std::size_t operator()(const std::array<char, sizeof(Law)>& bytes) const {
            return std::hash<std::string_view>()(std::string_view(bytes.data(), bytes.size()));
        }
    };
    std::unordered_map<std::array<char, sizeof(Law)>, std::uint32_t, Hash> known;
    std::vector<Law> table;
    LawMap<Any> all;
    all.place.reserve(of_nodes.size());
    std::array<char, sizeof(Law)> bytes{};
    for (const Law& law : of_nodes) {
        std::memcpy(bytes.data(), &law, sizeof(Law));
        const auto [entry, is_new] = known.emplace(bytes, static_cast<std::uint32_t>(table.size()));
        if (is_new) table.push_back(law);
        all.place.push_back(entry->second);
    }
    all.laws = std::move(table);
    return all;
}

/// Of several keys of one parameter the one whose value the parameter is: mu, not friction_angle_deg.
template <class Law>
std::string plain_name(const std::vector<Key<Law>>& keys, double Law::*parameter) {
    constexpr double kAny = 0.5;
    for (const Key<Law>& key : keys)
        if (key.parameter == parameter && key.convert(kAny) == kAny) return key.name;
    return {};
}

/// A parameter on the nodes, by the name of its key; empty where the laws have none of that name.
template <class Any>
std::vector<double> parameter_on_nodes(const LawMap<Any>& all, const std::string& name) {
    return std::visit(
        [&](const auto& table) {
            using Law = typename std::decay_t<decltype(table)>::value_type;
            std::vector<double> values;
            for (const Key<Law>& key : Law::keys()) {
                if (name != key.name) continue;
                for (const std::uint32_t place : all.place) values.push_back(table[place].*key.parameter);
                break;
            }
            return values;
        },
        all.laws);
}

}  // namespace frana::laws
