#pragma once
// Tools of exact answers: classical Runge-Kutta with fixed steps, short enough for round-off, and bisection.
#include <array>
#include <cmath>
#include <cstddef>

namespace frana::verify {

template <std::size_t N>
using State = std::array<double, N>;

/// One step of the classical fourth-order method of y' = rate(t, y).
template <std::size_t N, class Rate>
State<N> rk4_step(const Rate& rate, double t, const State<N>& y, double dt) {
    const auto moved = [&](const State<N>& slope, double by) {
        State<N> at = y;
        for (std::size_t n = 0; n < N; ++n) at[n] += by * slope[n];
        return at;
    };
    const State<N> a = rate(t, y), b = rate(t + 0.5 * dt, moved(a, 0.5 * dt));
    const State<N> c = rate(t + 0.5 * dt, moved(b, 0.5 * dt)), d = rate(t + dt, moved(c, dt));
    State<N> next = y;
    for (std::size_t n = 0; n < N; ++n) next[n] += dt / 6.0 * (a[n] + 2.0 * b[n] + 2.0 * c[n] + d[n]);
    return next;
}

/// y(end) from y(start) in steps of about `longest`.
template <std::size_t N, class Rate>
State<N> integrate(const Rate& rate, double start, double end, State<N> y, double longest) {
    const double steps = std::ceil((end - start) / longest);
    const double dt = (end - start) / steps;
    for (double k = 0.0; k < steps; ++k) y = rk4_step(rate, start + k * dt, y, dt);
    return y;
}

/// Where `before` turns from true to false between low and high.
template <class Condition>
double bisect(double low, double high, const Condition& before) {
    for (int k = 0; k < 200; ++k) {
        const double middle = 0.5 * (low + high);
        (before(middle) ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

}  // namespace frana::verify
