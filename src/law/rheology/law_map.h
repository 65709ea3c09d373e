#pragma once
// Rheologies that differ in space: on the nodes of a grid, and of four points at once.
#include <array>
#include <cstring>
#include <vector>

#include "base/simd.h"
#include "law/law_map.h"
#include "law/rheology/laws.h"

namespace frana::rheology {

using LawMap = laws::LawMap<Rheology>;

template <class Law>
LawMap law_map(const std::vector<Law>& of_nodes) {
    return laws::law_map<Rheology>(of_nodes);
}

/// Four laws of a kind as one, whose parameters are theirs side by side.
template <template <class> class LawOf>
[[gnu::always_inline]] inline LawOf<Double4> side_by_side(const LawOf<double>& a, const LawOf<double>& b,
                                                          const LawOf<double>& c, const LawOf<double>& d) {
    constexpr std::size_t kNumbers = sizeof(LawOf<double>) / sizeof(double);
    static_assert(
        sizeof(LawOf<double>) == kNumbers * sizeof(double) && sizeof(LawOf<Double4>) == kNumbers * sizeof(Double4),
        "a law's parameters are numbers alone");
    using Numbers = std::array<double, kNumbers>;
    Numbers of[4];
    const LawOf<double>* const laws[4] = {&a, &b, &c, &d};
    for (int n = 0; n < 4; ++n) std::memcpy(&of[n], laws[n], sizeof(Numbers));
    std::array<Double4, kNumbers> four;
    for (std::size_t k = 0; k < kNumbers; ++k) four[k] = Double4{of[0][k], of[1][k], of[2][k], of[3][k]};
    LawOf<Double4> law;
    std::memcpy(static_cast<void*>(&law), &four, sizeof law);
    return law;
}

}  // namespace frana::rheology
