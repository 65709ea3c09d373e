#pragma once
// Rheologies that differ from node to node (THEORY.md, section 19): a point has that of the node nearest to it.
#include <cmath>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <variant>
#include <vector>

#include "base/simd.h"
#include "law/rheology/law_map.h"
#include "mpm/on_storage.h"

namespace frana {

/// On the storage of a grid.
struct NodeRheologies {
    NodeRheologies(const rheology::LawMap& all, const TileGrid& of)
        : laws(all.laws), place(on_storage(all.place, of)), stride(of.stride()) {}

    laws::LawTable<Rheology> laws;
    LazyArray<std::uint32_t> place;  ///< in the table, of each node
    Index stride;                    ///< of the storage
};

/// In a kernel: each node has a rheology of its own, instead of one for all.
struct RheologyOfEachNode {};

/// The rheology that points have: what a kernel calls of it, the same for one law and for many. Positions in cells.
template <class Law>
struct OneForAll {
    const Law& law;
    template <class Real>
    [[gnu::always_inline]] PlaneOf<Real> stress(const Real&, const Real&, const StrainState<Real>& state) const {
        return law.stress(state);
    }
};

template <class Law>
struct ThatOfNode {
    const std::vector<Law>& laws;
    const NodeRheologies& of;

    [[gnu::always_inline]] PlaneOf<double> stress(double x, double y, const StrainState<double>& state) const {
        const Index i = static_cast<Index>(std::floor(x + (kTile + 0.5))),
                    j = static_cast<Index>(std::floor(y + (kTile + 0.5)));
        return laws[of.place[j * of.stride + i]].stress(state);
    }
    [[gnu::always_inline]] PlaneOf<Double4> stress(const Double4& x, const Double4& y,
                                                   const StrainState<Double4>& state) const {
        const Int4 i = floor_positive(x + (kTile + 0.5)), j = floor_positive(y + (kTile + 0.5));
        const auto place = [&](int n) { return of.place[j[n] * of.stride + i[n]]; };
        const std::uint32_t a = place(0), b = place(1), c = place(2), d = place(3);
        if (a == b && a == c && a == d) return laws[a].stress(state);  // nearly always, within a zone
        return frana::laws::side_by_side(laws[a], laws[b], laws[c], laws[d]).stress(state);
    }
};

/// Calls body(what points have) for the law of a kernel. `nodes` is there for RheologyOfEachNode. Kernels that are compiled in
/// different ways share this: it is always inlined.
template <class Law, class Body>
[[gnu::always_inline]] inline void with_rheology_of(const Law& law, const std::optional<NodeRheologies>& nodes,
                                                    Body&& body) {
    if constexpr (std::is_same_v<Law, RheologyOfEachNode>)
        std::visit(
            [&](const auto& laws) {
                using Of = typename std::decay_t<decltype(laws)>::value_type;
                if constexpr (!std::is_same_v<Of, rheology::None>) body(ThatOfNode<Of>{laws, *nodes});
            },
            nodes->laws);
    else
        body(OneForAll<Law>{law});
}

}  // namespace frana
