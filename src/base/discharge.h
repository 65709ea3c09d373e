#pragma once
// Integrals over the table of an inflow. Its discharge and its speed are linear between its times, and nothing comes
// before and after them. A table is any type with `time` [s], `discharge` [m^3/s] and `speed` [m/s], lists of one
// length.
#include <algorithm>
#include <cstddef>

namespace frana {

/// What has come through up to a time, exactly.
struct Through {
    double time = 0.0;
    double way = 0.0;       ///< of the speed [m]
    double volume = 0.0;    ///< of the discharge [m3]
    double moment = 0.0;    ///< of the discharge times the time [m3 s]
    double momentum = 0.0;  ///< of the discharge times the speed [m4/s]

    /// Goes on by `s` within the n-th interval of the table, from `since` after its beginning.
    template <class Table>
    void go(const Table& of, std::size_t n, double since, double s) {
        const double length = of.time[n + 1] - of.time[n];
        const double dq = (of.discharge[n + 1] - of.discharge[n]) / length,
                     dv = (of.speed[n + 1] - of.speed[n]) / length;
        const double q = of.discharge[n] + dq * since, v = of.speed[n] + dv * since, at = of.time[n] + since;
        const double more = s * (q + 0.5 * dq * s);
        way += s * (v + 0.5 * dv * s);
        volume += more;
        moment += at * more + s * s * (0.5 * q + dq * s / 3.0);
        momentum += s * (q * v + s * (0.5 * (q * dv + v * dq) + dq * dv * s / 3.0));
        time = at + s;
    }
};

/// Of the table, from one time to another [s].
template <class Table>
Through between(const Table& of, double from, double to) {
    Through sum;
    const auto first = std::upper_bound(of.time.begin(), of.time.end(), from) - of.time.begin();
    for (auto n = static_cast<std::size_t>(std::max<std::ptrdiff_t>(first, 1) - 1);
         n + 1 < of.time.size() && of.time[n] < to; ++n) {
        const double begin = std::max(from, of.time[n]), end = std::min(to, of.time[n + 1]);
        if (end > begin) sum.go(of, n, begin - of.time[n], end - begin);
    }
    return sum;
}

/// Of the table, up to a time [m3].
template <class Table>
double volume_until(const Table& of, double time) {
    double sum = 0.0;
    for (std::size_t n = 0; n + 1 < of.time.size() && of.time[n] < time; ++n) {
        const double length = of.time[n + 1] - of.time[n], share = std::min(1.0, (time - of.time[n]) / length);
        const double end = of.discharge[n] + share * (of.discharge[n + 1] - of.discharge[n]);
        sum += 0.5 * share * length * (of.discharge[n] + end);
    }
    return sum;
}

}  // namespace frana
