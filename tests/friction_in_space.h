#pragma once
// Friction that differs from node to node, for tests.
#include <functional>
#include <memory>
#include <variant>
#include <vector>

#include "scene/scene.h"

namespace frana::test {

/// The scene's law in two places of the table; nodes take them in turn, so that no four have the same.
inline std::shared_ptr<const Friction> twice(const Scene& scene) {
    Friction friction;
    const GridGeometry& g = scene.bed.geometry;
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) friction.laws.place.push_back(static_cast<std::uint32_t>((i + j) % 2));
    std::visit(
        [&](const auto& law) {
            friction.laws.laws = std::vector<std::decay_t<decltype(law)>>{law, law};
        },
        scene.bed_law);
    return std::make_shared<const Friction>(friction);
}

/// The same of the scene's rheology.
inline std::shared_ptr<const Friction> rheologies_twice(const Scene& scene) {
    Friction friction;
    const GridGeometry& g = scene.bed.geometry;
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) friction.rheologies.place.push_back(static_cast<std::uint32_t>((i + j) % 2));
    std::visit(
        [&](const auto& law) {
            friction.rheologies.laws = std::vector<std::decay_t<decltype(law)>>{law, law};
        },
        scene.rheology);
    return std::make_shared<const Friction>(friction);
}

/// A rheology for each node, by its place.
template <class Law>
std::shared_ptr<const Friction> rheologies_by_place(const Scene& scene, const std::function<Law(double, double)>& law) {
    std::vector<Law> laws;
    const GridGeometry& g = scene.bed.geometry;
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) laws.push_back(law(g.x(i), g.y(j)));
    Friction friction;
    friction.rheologies = rheology::law_map(laws);
    return std::make_shared<const Friction>(std::move(friction));
}

/// A law for each node, by its place.
template <class Law>
std::shared_ptr<const Friction> by_place(const Scene& scene, const std::function<Law(double, double)>& law) {
    std::vector<Law> laws;
    const GridGeometry& g = scene.bed.geometry;
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) laws.push_back(law(g.x(i), g.y(j)));
    return std::make_shared<const Friction>(Friction{bed::law_map(laws), {"mu"}, {}});
}

}  // namespace frana::test
