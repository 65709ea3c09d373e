#include "checks/verify/exact_track.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "checks/verify/ode.h"

namespace frana::verify {
namespace {

using constants::kGravity;

struct Parabola final : Track {
    double steepest, length;
    Parabola(double t, double l) : steepest(t), length(l) {}
    double left(double s) const { return std::max(0.0, length - std::max(0.0, s)); }
    double z(double s) const override {
        return 0.5 * steepest * left(s) * left(s) / length - steepest * std::min(0.0, s);
    }
    double slope(double s) const override { return -steepest * left(s) / length; }
    double curvature(double s) const override { return s > 0.0 && s < length ? steepest / length : 0.0; }
    std::vector<double> joints() const override { return {0.0, length}; }
};

/// An arc of a circle tangent to the flat at s = 0, between straight pieces. They have the given tangents before and
/// after.
struct Arc final : Track {
    double radius, before, after;  ///< [m]; largest -s and s of the arc [m]
    Arc(double r, double b, double a) : radius(r), before(b), after(a) {}
    double on_arc(double s) const { return std::clamp(s, -before, after); }
    double z(double s) const override {
        const double a = on_arc(s);
        return a * a / (radius + std::sqrt(radius * radius - a * a)) + slope(s) * (s - a);
    }
    double slope(double s) const override {
        const double a = on_arc(s);
        return a / std::sqrt(radius * radius - a * a);
    }
    double curvature(double s) const override {
        const double a = on_arc(s);
        return a == s ? radius * radius / std::pow(radius * radius - a * a, 1.5) : 0.0;
    }
    std::vector<double> joints() const override { return {-before, after}; }
};

/// d(v^2)/ds on the piece of track between two joints; at the joints the curvature is the piece's own.
auto braking(const Track& track, double mu, Normal normal, double from, double to) {
    return [&track, mu, normal, from, to](double s, const State<1>& y) {
        const double inside = std::clamp(s, from + 1e-9, to - 1e-9);
        const double slope = track.slope(s), pressed = std::max(0.0, kGravity + track.curvature(inside) * y[0]);
        const double friction = mu * (normal == Normal::full ? pressed : kGravity);
        return State<1>{-2.0 * (slope * pressed + friction) / (1.0 + slope * slope)};
    };
}

/// The path in time without friction.
State<2> swing(const Track& track, double start, double t) {
    const auto rate = [&track](double, const State<2>& y) {
        const double slope = track.slope(y[0]);
        return State<2>{y[1], -slope * (kGravity + track.curvature(y[0]) * y[1] * y[1]) / (1.0 + slope * slope)};
    };
    return integrate(rate, 0.0, t, State<2>{start, 0.0}, 1e-3);
}

}  // namespace

std::shared_ptr<const Track> parabola(double steepest, double length) {
    return std::make_shared<Parabola>(steepest, length);
}

std::shared_ptr<const Track> hockey_stick(double slope_deg, double radius) {
    return std::make_shared<Arc>(radius, radius * std::sin(slope_deg * constants::kPi / 180.0), 0.0);
}

std::shared_ptr<const Track> circle(double radius) {
    const double reach = radius * std::sin(60 * constants::kPi / 180.0);
    return std::make_shared<Arc>(radius, reach, reach);
}

double stop_of(const Track& track, double mu, double start, Normal normal) {
    constexpr double longest = 0.05;  // [m]
    std::vector<double> ends = track.joints();
    ends.push_back(1e6);
    double s = start;
    State<1> y{0.0};
    for (const double end : ends) {
        if (end <= s) continue;
        const auto rate = braking(track, mu, normal, s, end);
        const double from = s, step = (end - s) / std::ceil((end - s) / longest);
        for (double n = 1.0; s < end; n += 1.0) {
            const State<1> next = rk4_step(rate, s, y, step);
            if (next[0] <= 0.0)
                return s + bisect(0.0, step, [&](double part) { return rk4_step(rate, s, y, part)[0] > 0.0; });
            y = next;
            s = from + n * step < end - 0.5 * step ? from + n * step : end;
        }
    }
    return s;
}

double place_of(const Track& track, double start, double t) { return swing(track, start, t)[0]; }

double energy_line(const Track& track, double mu, double start) {
    return bisect(start, start + (track.z(start) - track.z(1e6)) / mu,
                  [&](double s) { return track.slope(s) < -mu || track.z(start) - mu * (s - start) > track.z(s); });
}

std::vector<Residual> track_residuals(const Track& track, double mu, double start) {
    const double rest = stop_of(track, mu, start, Normal::gravity);
    double slope = 0.0, curvature = 0.0;
    constexpr double d = 1e-3;
    for (int k = 1; k < 40; ++k) {
        const double s = start + (rest - start) * k / 40.0;
        if (track.curvature(s - d) == 0.0 || track.curvature(s + d) == 0.0) continue;  // not across a jump
        const double rise = (track.z(s + d) - track.z(s - d)) / (2 * d);
        const double bend = (track.slope(s + d) - track.slope(s - d)) / (2 * d);
        slope = std::max(slope, std::abs(rise - track.slope(s)));
        curvature = std::max(curvature, std::abs(bend - track.curvature(s)));
    }
    return {{"slope of the track by differences", slope, 1e-8},  // round-off of z over d
            {"curvature of the track by differences", curvature, 1e-8},
            {"stop of the integrated point less the energy line [m]", rest - energy_line(track, mu, start), 1e-8}};
}

std::vector<Residual> pendulum_residuals(double radius, double release_deg) {
    const double angle = release_deg * constants::kPi / 180.0, start = -radius * std::sin(angle);
    const auto track = circle(radius);
    double a = 1.0, b = std::cos(0.5 * angle);
    for (int k = 0; k < 20; ++k) std::tie(a, b) = std::pair{0.5 * (a + b), std::sqrt(a * b)};
    const double period = 2 * constants::kPi * std::sqrt(radius / kGravity) / a;
    const State<2> y = swing(*track, start, 3.7);
    const double slope = track->slope(y[0]), fall = track->z(start) - track->z(y[0]);
    const double kinetic = 0.5 * y[1] * y[1] * (1 + slope * slope);
    return {{"place after a quarter of a period / radius", place_of(*track, start, 0.25 * period) / radius, 1e-10},
            {"kinetic energy / fall - 1 at 3.7 s", kinetic / (kGravity * fall) - 1, 1e-10}};
}

}  // namespace frana::verify
