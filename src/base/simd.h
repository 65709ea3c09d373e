#pragma once
// Four doubles as one value, by the compilers' vector extension: no intrinsics, any instruction set. Kernels use it in
// two ways: four numbers of one node together, or one number of four points ("lanes"). All is always inlined: files
// built for different instruction sets may share it.
#include <cmath>
#include <cstdint>
#include <cstring>

namespace frana {

typedef double Double4 __attribute__((vector_size(32)));
typedef std::int64_t Mask4 __attribute__((vector_size(32)));  ///< of a comparison: all bits set, or none
typedef std::int32_t Int4 __attribute__((vector_size(16)));

[[gnu::always_inline]] inline Double4 load(const void* p) {
    Double4 value;
    std::memcpy(&value, p, sizeof value);
    return value;
}
[[gnu::always_inline]] inline void store(void* p, Double4 value) { std::memcpy(p, &value, sizeof value); }

/// The first `lanes` (1 to 4) of four numbers; the others are zero, or are left alone.
[[gnu::always_inline]] inline Double4 load(const double* p, int lanes) {
    if (lanes == 4) return load(p);
    Double4 value = {};
    std::memcpy(&value, p, sizeof(double) * static_cast<std::size_t>(lanes));
    return value;
}
[[gnu::always_inline]] inline void store(double* p, Double4 value, int lanes) {
    if (lanes == 4)
        store(p, value);
    else
        std::memcpy(p, &value, sizeof(double) * static_cast<std::size_t>(lanes));
}

/// The same for numbers that memory holds in single precision.
typedef float Float4 __attribute__((vector_size(16)));
[[gnu::always_inline]] inline Double4 load(const float* p, int lanes) {
    Float4 value = {};
    if (lanes == 4)
        std::memcpy(&value, p, sizeof value);
    else
        std::memcpy(&value, p, sizeof(float) * static_cast<std::size_t>(lanes));
    return __builtin_convertvector(value, Double4);
}
[[gnu::always_inline]] inline void store(float* p, Double4 value, int lanes) {
    const Float4 narrow = __builtin_convertvector(value, Float4);
    if (lanes == 4)
        std::memcpy(p, &narrow, sizeof narrow);
    else
        std::memcpy(p, &narrow, sizeof(float) * static_cast<std::size_t>(lanes));
}

/// A pair of numbers of one node.
typedef double Double2 __attribute__((vector_size(16)));

[[gnu::always_inline]] inline Double4 all(double value) { return Double4{value, value, value, value}; }
[[gnu::always_inline]] inline Double4 min(Double4 a, Double4 b) { return a < b ? a : b; }
[[gnu::always_inline]] inline Double4 max(Double4 a, Double4 b) { return a > b ? a : b; }
[[gnu::always_inline]] inline Double4 abs(Double4 a) {
    Mask4 bits;
    std::memcpy(&bits, &a, sizeof bits);
    bits &= INT64_MAX;
    std::memcpy(&a, &bits, sizeof a);
    return a;
}
[[gnu::always_inline]] inline Double4 sqrt(Double4 a) {
    Double4 root;
    for (int n = 0; n < 4; ++n) root[n] = std::sqrt(a[n]);
    return root;
}
/// The same names for one number, so that a law is written once for both.
[[gnu::always_inline]] inline double min(double a, double b) { return a < b ? a : b; }
[[gnu::always_inline]] inline double max(double a, double b) { return a > b ? a : b; }
[[gnu::always_inline]] inline double abs(double a) { return std::fabs(a); }
[[gnu::always_inline]] inline double sqrt(double a) { return std::sqrt(a); }
[[gnu::always_inline]] inline double select(bool yes, double a, double b) { return yes ? a : b; }
[[gnu::always_inline]] inline Double4 select(Mask4 yes, Double4 a, Double4 b) { return yes ? a : b; }
[[gnu::always_inline]] inline bool any(bool a) { return a; }
/// One number, or four in a row.
template <class Real>
[[gnu::always_inline]] inline Real read(const double* p) {
    Real value;
    std::memcpy(&value, p, sizeof value);
    return value;
}

[[gnu::always_inline]] inline bool any(Mask4 m) {
    m |= __builtin_shufflevector(m, m, 2, 3, 0, 1);
    return (m[0] | m[1]) != 0;
}
[[gnu::always_inline]] inline double sum(Double4 a) { return (a[0] + a[1]) + (a[2] + a[3]); }
[[gnu::always_inline]] inline double largest(Double4 a) {
    return std::fmax(std::fmax(a[0], a[1]), std::fmax(a[2], a[3]));
}

/// Largest integer not above a.
[[gnu::always_inline]] inline Double4 floor(Double4 a) {
    Double4 whole;
    for (int n = 0; n < 4; ++n) whole[n] = std::floor(a[n]);
    return whole;
}
/// The same for a > 0, as an integer: conversion truncates.
[[gnu::always_inline]] inline Int4 floor_positive(Double4 a) { return __builtin_convertvector(a, Int4); }
[[gnu::always_inline]] inline Double4 to_double(Int4 a) { return __builtin_convertvector(a, Double4); }

/// {a0, a0, a2, a2} and {a1, a1, a3, a3}. Two pairs have two numbers each: the first ones and the second ones.
[[gnu::always_inline]] inline Double4 first_of_pairs(Double4 a) { return __builtin_shufflevector(a, a, 0, 0, 2, 2); }
[[gnu::always_inline]] inline Double4 second_of_pairs(Double4 a) { return __builtin_shufflevector(a, a, 1, 1, 3, 3); }

/// Four pairs side by side: the first and the second numbers.
[[gnu::always_inline]] inline void unzip(const void* pairs, Double4& first, Double4& second) {
    const Double4 a = load(pairs), b = load(static_cast<const double*>(pairs) + 4);
    first = __builtin_shufflevector(a, b, 0, 2, 4, 6);
    second = __builtin_shufflevector(a, b, 1, 3, 5, 7);
}

/// The same of one pair.
[[gnu::always_inline]] inline void unzip(const void* pair, double& first, double& second) {
    std::memcpy(&first, pair, sizeof first);
    std::memcpy(&second, static_cast<const double*>(pair) + 1, sizeof second);
}

/// Back again.
[[gnu::always_inline]] inline void zip(Double4 first, Double4 second, void* pairs) {
    store(pairs, __builtin_shufflevector(first, second, 0, 4, 1, 5));
    store(static_cast<double*>(pairs) + 4, __builtin_shufflevector(first, second, 2, 6, 3, 7));
}

/// Rows to columns: lane n of a, b, c, d becomes the value to[n].
[[gnu::always_inline]] inline void transpose(Double4 a, Double4 b, Double4 c, Double4 d, Double4 to[4]) {
    const Double4 ab0 = __builtin_shufflevector(a, b, 0, 4, 2, 6), ab1 = __builtin_shufflevector(a, b, 1, 5, 3, 7);
    const Double4 cd0 = __builtin_shufflevector(c, d, 0, 4, 2, 6), cd1 = __builtin_shufflevector(c, d, 1, 5, 3, 7);
    to[0] = __builtin_shufflevector(ab0, cd0, 0, 1, 4, 5);
    to[1] = __builtin_shufflevector(ab1, cd1, 0, 1, 4, 5);
    to[2] = __builtin_shufflevector(ab0, cd0, 2, 3, 6, 7);
    to[3] = __builtin_shufflevector(ab1, cd1, 2, 3, 6, 7);
}

/// The sum of each of four values.
[[gnu::always_inline]] inline Double4 sums_of_each(const Double4 (&of)[4]) {
    const Double4 ab =
        __builtin_shufflevector(of[0], of[1], 0, 4, 2, 6) + __builtin_shufflevector(of[0], of[1], 1, 5, 3, 7);
    const Double4 cd =
        __builtin_shufflevector(of[2], of[3], 0, 4, 2, 6) + __builtin_shufflevector(of[2], of[3], 1, 5, 3, 7);
    return __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
}

}  // namespace frana
