#pragma once
// The weights of a point along one axis of the 3D grid.
namespace frana {

/// tpic: the velocity's gradient and the stress's divergence by the shape function's slopes; the quieter
/// pressure. apic: both by its first moments (Jiang et al. 2015; Hu et al. 2018); angular momentum is conserved
/// exactly.
enum class Affine { tpic, apic };

/// Quadratic B-splines along one axis, of a place f in [1/2, 3/2) cells behind the first of three nodes. They have
/// weights, slopes [1/m] and distances [m]. Affine::apic takes 4 w d / h^2 for the slope, the first moment of the
/// weights.
template <Affine affine, class Real>
struct Spline {
    Real w[3], slope[3], d[3];

    [[gnu::always_inline]] Spline(Real f, double h) {
        const double per_h = 1.0 / h;
        w[0] = 0.5 * (1.5 - f) * (1.5 - f);
        w[1] = 0.75 - (f - 1.0) * (f - 1.0);
        w[2] = 0.5 * (f - 0.5) * (f - 0.5);
        for (int n = 0; n < 3; ++n) d[n] = (static_cast<double>(n) - f) * h;
        if constexpr (affine == Affine::tpic) {
            slope[0] = (f - 1.5) * per_h;
            slope[1] = (2.0 - 2.0 * f) * per_h;
            slope[2] = (f - 0.5) * per_h;
        } else {
            for (int n = 0; n < 3; ++n) slope[n] = 4.0 * per_h * per_h * w[n] * d[n];
        }
    }
};

}  // namespace frana
