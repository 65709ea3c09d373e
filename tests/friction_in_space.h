#pragma once
// Friction that differs from node to node, for tests.
#include <functional>
#include <memory>
#include <variant>
#include <vector>

#include "scene/scene.h"

namespace frana::test {

/// Two places of a table that both hold `law`; nodes take them in turn, so that no four have the same.
template <class Any>
laws::LawMap<Any> in_turn(const GridGeometry& grid, const Any& law) {
    laws::LawMap<Any> map;
    for (Index j = 0; j < grid.ny; ++j)
        for (Index i = 0; i < grid.nx; ++i) map.place.push_back(static_cast<std::uint32_t>((i + j) % 2));
    std::visit([&](const auto& one) { map.laws = std::vector<std::decay_t<decltype(one)>>{one, one}; }, law);
    return map;
}

/// The scene's bed law, in turn.
inline std::shared_ptr<const Friction> twice(const Scene& scene) {
    Friction friction;
    friction.laws = in_turn(scene.bed.geometry, scene.bed_law);
    return std::make_shared<const Friction>(std::move(friction));
}

/// The same of the scene's rheology.
inline std::shared_ptr<const Friction> rheologies_twice(const Scene& scene) {
    Friction friction;
    friction.rheologies = in_turn(scene.bed.geometry, scene.rheology);
    return std::make_shared<const Friction>(std::move(friction));
}

template <class Law>
std::vector<Law> laws_by_place(const GridGeometry& grid, const std::function<Law(double, double)>& law) {
    std::vector<Law> laws;
    for (Index j = 0; j < grid.ny; ++j)
        for (Index i = 0; i < grid.nx; ++i) laws.push_back(law(grid.x(i), grid.y(j)));
    return laws;
}

/// A rheology for each node, by its place.
template <class Law>
std::shared_ptr<const Friction> rheologies_by_place(const Scene& scene, const std::function<Law(double, double)>& law) {
    Friction friction;
    friction.rheologies = rheology::law_map(laws_by_place(scene.bed.geometry, law));
    return std::make_shared<const Friction>(std::move(friction));
}

/// A bed law for each node, by its place.
template <class Law>
std::shared_ptr<const Friction> by_place(const Scene& scene, const std::function<Law(double, double)>& law) {
    return std::make_shared<const Friction>(Friction{bed::law_map(laws_by_place(scene.bed.geometry, law)), {"mu"}, {}});
}

}  // namespace frana::test
