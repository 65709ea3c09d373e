#pragma once
// Spatially varying bed laws (THEORY.md, section 19), for kernels that take one node or four at once.
#include <array>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <vector>

#include "law/bed/law_map.h"
#include "mpm/tile_grid.h"

namespace frana {

/// On the storage of a grid: nodes beyond it have the law of the nearest one in it.
struct NodeLaws {
    NodeLaws(const bed::LawMap& all, const TileGrid& grid);

    bed::LawTable laws;
    std::vector<double> at_rest;     ///< friction_at_rest() of each [1]
    LazyArray<std::uint32_t> place;  ///< in the table, of each node
};

/// In a kernel: each node has a law of its own, instead of one for all.
struct LawOfEachNode {};

/// The law of a node, or those of four in a row: what a kernel calls of a law.
template <class Real>
struct LawsHere;

template <>
struct LawsHere<double> {
    LawsHere(const NodeLaws& of, Index k) : all(&of), place(of.place[k]) {}
    double friction_at_rest() const { return all->at_rest[place]; }

    const NodeLaws* all;
    std::uint32_t place;
};

template <>
struct LawsHere<Double4> {
    LawsHere(const NodeLaws& of, Index k)
        : all(&of), place{of.place[k], of.place[k + 1], of.place[k + 2], of.place[k + 3]} {}
    LawsHere(const NodeLaws& of, const std::array<Index, 4>& k)
        : all(&of), place{of.place[k[0]], of.place[k[1]], of.place[k[2]], of.place[k[3]]} {}
    Double4 friction_at_rest() const {
        const std::vector<double>& rest = all->at_rest;
        return Double4{rest[place[0]], rest[place[1]], rest[place[2]], rest[place[3]]};
    }
    /// As node_friction.h has it for one law. Not a part of the kernels, which would all hold all laws.
    void brake(const BedStateOf<Double4>& bed, const Double4& s0, const Double4& driven, double dt,
               Double4& speed) const;

    const NodeLaws* all;
    std::array<std::uint32_t, 4> place;
};

[[gnu::always_inline]] inline Double4 speeds_after(const LawsHere<Double4>& here, const BedStateOf<Double4>& bed,
                                                   Double4 s0, Double4 driven, double dt) {
    Double4 speed;
    here.brake(bed, s0, driven, dt, speed);
    return speed;
}
double speeds_after(const LawsHere<double>& here, const BedState& bed, double s0, double driven, double dt);

/// In a kernel for terrain that few runs have: one law for all nodes, whichever it is. Such a kernel is there once, not for
/// each law; a call for four nodes is what that costs.
struct AnyLaw {
    explicit AnyLaw(const BedLaw& one) : law(one), at_rest(frana::friction_at_rest(one)) {}
    double friction_at_rest() const { return at_rest; }
    void brake(const BedStateOf<Double4>& bed, const Double4& s0, const Double4& driven, double dt,
               Double4& speed) const;

    BedLaw law;
    double at_rest;
};

[[gnu::always_inline]] inline Double4 speeds_after(const AnyLaw& law, const BedStateOf<Double4>& bed, Double4 s0,
                                                   Double4 driven, double dt) {
    Double4 speed;
    law.brake(bed, s0, driven, dt, speed);
    return speed;
}
double speeds_after(const AnyLaw& law, const BedState& bed, double s0, double driven, double dt);

/// What a kernel calls of its law at node k, or at four from there on. `laws` is there for LawOfEachNode.
template <class Real, class Law>
[[gnu::always_inline]] inline decltype(auto) law_at(const Law& law, const std::optional<NodeLaws>& laws, Index k) {
    if constexpr (std::is_same_v<Law, LawOfEachNode>)
        return LawsHere<Real>(*laws, k);
    else
        return (law);
}

}  // namespace frana
