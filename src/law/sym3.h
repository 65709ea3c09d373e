#pragma once
// Symmetric 3D tensors, of one point or of four side by side (base/simd.h): laws are written once for
// both.
#include <type_traits>

#include "base/simd.h"
#include "base/types.h"

namespace frana {

/// A type that a call does not deduce.
template <class T>
struct AsGiven {
    using type = T;
};
template <class T>
using Given = typename AsGiven<T>::type;

/// A 3 x 3 matrix for four points.
struct Mat3x4 {
    Double4 entry[9];
    [[gnu::always_inline]] Double4& operator()(int row, int column) { return entry[row + 3 * column]; }
    [[gnu::always_inline]] const Double4& operator()(int row, int column) const { return entry[row + 3 * column]; }
};
template <class Real>
using Square = std::conditional_t<std::is_same_v<Real, double>, Mat3, Mat3x4>;

/// Symmetric 3D tensor.
template <class Real>
struct SymOf {
    Real xx{}, yy{}, zz{}, xy{}, yz{}, xz{};

    [[gnu::always_inline]] Real trace() const { return xx + yy + zz; }
    /// sqrt(a : a)
    [[gnu::always_inline]] Real norm() const {
        return frana::sqrt(xx * xx + yy * yy + zz * zz + 2.0 * (xy * xy + yz * yz + xz * xz));
    }
    [[gnu::always_inline]] SymOf deviator() const { return plus_isotropic(trace() * (-1.0 / 3.0)); }
    [[gnu::always_inline]] SymOf operator+(const SymOf& b) const {
        return {xx + b.xx, yy + b.yy, zz + b.zz, xy + b.xy, yz + b.yz, xz + b.xz};
    }
    [[gnu::always_inline]] SymOf operator*(Real s) const { return {s * xx, s * yy, s * zz, s * xy, s * yz, s * xz}; }
    [[gnu::always_inline]] SymOf plus_isotropic(Real p) const { return {xx + p, yy + p, zz + p, xy, yz, xz}; }
    [[gnu::always_inline]] Square<Real> matrix() const {
        Square<Real> m;
        m(0, 0) = xx, m(1, 1) = yy, m(2, 2) = zz;
        m(0, 1) = m(1, 0) = xy, m(1, 2) = m(2, 1) = yz, m(0, 2) = m(2, 0) = xz;
        return m;
    }
    /// The symmetric part.
    [[gnu::always_inline]] static SymOf of(const Square<Real>& m) {
        return {
            m(0, 0), m(1, 1), m(2, 2), 0.5 * (m(0, 1) + m(1, 0)), 0.5 * (m(1, 2) + m(2, 1)), 0.5 * (m(0, 2) + m(2, 0))};
    }
    [[gnu::always_inline]] static SymOf read(const Real* s) { return {s[0], s[1], s[2], s[3], s[4], s[5]}; }
    [[gnu::always_inline]] void write(Real* s) const {
        s[0] = xx, s[1] = yy, s[2] = zz, s[3] = xy, s[4] = yz, s[5] = xz;
    }
};
using Sym3 = SymOf<double>;

/// a : b
template <class Real>
[[gnu::always_inline]] inline Real contracted(const SymOf<Real>& a, const SymOf<Real>& b) {
    return a.xx * b.xx + a.yy * b.yy + a.zz * b.zz + 2.0 * (a.xy * b.xy + a.yz * b.yz + a.xz * b.xz);
}

template <class Real>
[[gnu::always_inline]] inline Real trace(const Square<Real>& m) {
    return m(0, 0) + m(1, 1) + m(2, 2);
}

/// Product of matrices that share their principal axes: symmetric again.
template <class Real>
[[gnu::always_inline]] inline SymOf<Real> times(const SymOf<Real>& a, const SymOf<Real>& b) {
    return {a.xx * b.xx + a.xy * b.xy + a.xz * b.xz, a.xy * b.xy + a.yy * b.yy + a.yz * b.yz,
            a.xz * b.xz + a.yz * b.yz + a.zz * b.zz, a.xx * b.xy + a.xy * b.yy + a.xz * b.yz,
            a.xy * b.xz + a.yy * b.yz + a.yz * b.zz, a.xx * b.xz + a.xy * b.yz + a.xz * b.zz};
}

template <class Real>
[[gnu::always_inline]] inline SymOf<Real> inverse(const SymOf<Real>& a) {
    const Real xx = a.yy * a.zz - a.yz * a.yz, xy = a.xz * a.yz - a.xy * a.zz, xz = a.xy * a.yz - a.xz * a.yy;
    return SymOf<Real>{xx, a.xx * a.zz - a.xz * a.xz, a.xx * a.yy - a.xy * a.xy, xy, a.xy * a.xz - a.xx * a.yz, xz} *
           (1.0 / (a.xx * xx + a.xy * xy + a.xz * xz));
}

}  // namespace frana
