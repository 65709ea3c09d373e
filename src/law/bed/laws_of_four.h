#pragma once
// Bed laws of four nodes that differ in their numbers, side by side: one formula instead of four. Only of laws whose formula
// takes four nodes at once; what they leave is what each law by itself does, to the last bit.
#include <array>
#include <type_traits>

#include "law/bed/laws.h"

namespace frana::bed {

/// Without a member of its own a law has no such form.
template <class Law>
struct LawsOfFour;

template <>
struct LawsOfFour<Coulomb> {
    explicit LawsOfFour(const std::array<const Coulomb*, 4>& of) : mu{of[0]->mu, of[1]->mu, of[2]->mu, of[3]->mu} {}
    Double4 friction_at_rest() const { return mu; }

    /// src/shallow/THEORY.md (37) [m/s]
    [[gnu::always_inline]] Double4 speed_after(const BedStateOf<Double4>& bed, Double4, Double4 driven,
                                               double dt) const {
        const Double4 none = {};
        return max(driven - dt * mu * bed.normal_gravity, none);
    }

    Double4 mu;  ///< [1]
};

template <>
struct LawsOfFour<Voellmy> {
    explicit LawsOfFour(const std::array<const Voellmy*, 4>& of)
        : mu{of[0]->mu, of[1]->mu, of[2]->mu, of[3]->mu}, xi{of[0]->xi, of[1]->xi, of[2]->xi, of[3]->xi} {}
    Double4 friction_at_rest() const { return mu; }

    /// src/shallow/THEORY.md (39) [m/s]
    [[gnu::always_inline]] Double4 speed_after(const BedStateOf<Double4>& bed, Double4 s0, Double4 driven,
                                               double dt) const {
        const Double4 quadratic = bed.gravity * bed.kappa / (xi * bed.thickness);
        return riccati_speed<Double4>(s0, driven, mu * bed.normal_gravity, quadratic, dt);
    }

    Double4 mu;  ///< [1]
    Double4 xi;  ///< [m/s^2]
};

template <class Law>
inline constexpr bool kSideBySide = std::is_same_v<Law, Coulomb> || std::is_same_v<Law, Voellmy>;

}  // namespace frana::bed
