#pragma once
// How a logarithmic strain goes on with the deformation, by series where it is small.
#include "law/sym3.h"

namespace frana {

/// exp(a) - I and ln(I + a) by principal values, for any size.
Sym3 exponential_of_large(const Sym3& a);
Sym3 logarithm_of_large(const Sym3& a);

/// Largest entries that the series below take to round-off, with few and with many terms. Principal values may be up to
/// three times that.
constexpr double kSmallStrain = 0.02, kMiddlingStrain = 0.1;

template <class Real>
[[gnu::always_inline]] inline Real largest_entry(const SymOf<Real>& a) {
    return max(max(max(abs(a.xx), abs(a.yy)), abs(a.zz)), max(max(abs(a.xy), abs(a.yz)), abs(a.xz)));
}

/// function(a) point by point: rare.
inline Sym3 each(const Sym3& a, Sym3 (*function)(const Sym3&)) { return function(a); }
SymOf<Double4> each(const SymOf<Double4>& a, Sym3 (*function)(const Sym3&));

/// exp(a) - I without powers beyond `last`.
template <int last, class Real>
[[gnu::always_inline]] inline SymOf<Real> exponential_series(const SymOf<Real>& a) {
    SymOf<Real> sum = a * (Real{} + 1.0 / last);
    for (int n = last - 1; n >= 1; --n) sum = times(a, sum.plus_isotropic(Real{} + 1.0)) * (Real{} + 1.0 / n);
    return sum;
}

/// ln(I + a) = 2 artanh(z), z = a (a + 2 I)^-1, without powers of z beyond `last`, an odd number.
template <int last, class Real>
[[gnu::always_inline]] inline SymOf<Real> logarithm_series(const SymOf<Real>& a) {
    const SymOf<Real> z = times(a, inverse(a.plus_isotropic(Real{} + 2.0))), z2 = times(z, z);
    SymOf<Real> sum = z2 * (Real{} + 1.0 / last);
    for (int n = last - 2; n >= 3; n -= 2) sum = times(z2, sum.plus_isotropic(Real{} + 1.0 / n));
    return times(z, sum.plus_isotropic(Real{} + 1.0)) * (Real{} + 2.0);
}

/// exp(a) - I: the first terms left out are below 0.06^9 / 9! < 1e-16 and 0.3^13 / 13! < 1e-16.
template <class Real>
[[gnu::always_inline]] inline SymOf<Real> exponential(const SymOf<Real>& a) {
    const Real size = largest_entry(a);
    if (__builtin_expect(any(!(size <= kSmallStrain)), 0))
        return any(!(size <= kMiddlingStrain)) ? each(a, exponential_of_large) : exponential_series<12>(a);
    return exponential_series<8>(a);
}

/// ln(I + a): |z| is up to 0.031 and 0.18. The first terms left out are below 0.031^10 / 11 and 0.18^22 / 23 < 1e-16 of
/// the first.
template <class Real>
[[gnu::always_inline]] inline SymOf<Real> logarithm(const SymOf<Real>& a) {
    const Real size = largest_entry(a);
    if (__builtin_expect(any(!(size <= kSmallStrain)), 0))
        return any(!(size <= kMiddlingStrain)) ? each(a, logarithm_of_large) : logarithm_series<21>(a);
    return logarithm_series<9>(a);
}

/// What becomes (src/solid3d/THEORY.md, 20) of the logarithmic strain e by an elastic deformation F = I + g: ln(F exp(2
/// e) F^T) / 2, to round-off. With exp(2 e) = I + b: F (I + b) F^T - I = b + g (I + b) + (g (I + b))^T + g (I + b) g^T,
/// small numbers among themselves.
template <class Real>
[[gnu::always_inline]] inline SymOf<Real> carried(const SymOf<Real>& e, const Square<Real>& g) {
    const SymOf<Real> exponent = exponential(e * (Real{} + 2.0));
    const Square<Real> b = exponent.matrix();
    Square<Real> gb;
    for (int k = 0; k < 3; ++k)
        for (int l = 0; l < 3; ++l) gb(k, l) = g(k, l) + (g(k, 0) * b(0, l) + g(k, 1) * b(1, l) + g(k, 2) * b(2, l));
    const auto grown = [&](int k, int l) {
        return gb(k, l) + gb(l, k) + (gb(k, 0) * g(l, 0) + gb(k, 1) * g(l, 1) + gb(k, 2) * g(l, 2));
    };
    return logarithm(exponent +
                     SymOf<Real>{grown(0, 0), grown(1, 1), grown(2, 2), grown(0, 1), grown(1, 2), grown(0, 2)}) *
           (Real{} + 0.5);
}
inline Sym3 carried_strain(const Sym3& e, const Mat3& grown) { return carried<double>(e, grown); }

/// det(I + g)
template <class Real>
[[gnu::always_inline]] inline Real volume_ratio(const Square<Real>& g) {
    const Real xx = 1.0 + g(0, 0), yy = 1.0 + g(1, 1), zz = 1.0 + g(2, 2);
    return xx * (yy * zz - g(1, 2) * g(2, 1)) - g(0, 1) * (g(1, 0) * zz - g(1, 2) * g(2, 0)) +
           g(0, 2) * (g(1, 0) * g(2, 1) - yy * g(2, 0));
}

}  // namespace frana
