#pragma once
// Four laws of a kind that differ in their numbers, as one: one formula instead of four. A law that can be used so is a
// template of the type of its numbers. It is `LawOf<double>` by itself and `LawOf<Double4>` of four.
#include <array>
#include <cstddef>
#include <cstring>

#include "base/simd.h"

namespace frana::laws {

template <class Law>
inline constexpr bool kSideBySide = false;
template <template <class> class LawOf>
inline constexpr bool kSideBySide<LawOf<double>> = true;

/// Four laws of a kind as one. What it gives is what each law gives by itself, to the last bit.
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

}  // namespace frana::laws
