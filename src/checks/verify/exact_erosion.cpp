#include "checks/verify/exact_erosion.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "checks/verify/ode.h"

namespace frana::verify {
namespace {

using constants::kDegree;

double clip(double x, double most) { return std::clamp(x, 0.0, most); }

/// Between a printed figure and ours, over the figure; as many digits as it has.
Residual printed(const std::string& what, double ours, double figure, double digits) {
    return {"published: " + what, ours - figure, digits};
}

}  // namespace

double ErodingSlab::drive() const {
    return gravity * (std::sin(slope_deg * kDegree) - mu * std::cos(slope_deg * kDegree));
}

double ErodingSlab::friction() const { return mu * gravity * std::cos(slope_deg * kDegree); }

ErodingSlab ErodingSlab::with(double drive, double friction) {
    ErodingSlab slab;
    const double slope = std::asin((drive + friction) / slab.gravity);
    slab.slope_deg = slope / kDegree, slab.mu = friction / (slab.gravity * std::cos(slope));
    return slab;
}

SlabState ErodingSlab::at_rate(double rate, double t) const {
    const double a = drive(), p = 2.0 - kappa;
    const auto speed_at = [&](double h) {
        return (speed * std::pow(thickness, p - 1.0) + a * (std::pow(h, p) - std::pow(thickness, p)) / (rate * p)) /
               std::pow(h, p - 1.0);
    };
    const auto rates = [&](double time, const State<1>&) { return State<1>{speed_at(thickness + rate * time)}; };
    const double h = thickness + rate * t;
    return {speed_at(h), integrate<1>(rates, 0.0, t, {0.0}, 1e-2)[0], h};
}

SlabState ErodingSlab::grown(double growth, double t) const {
    const double a = drive(), loss = (1.0 - kappa) * growth;
    if (loss == 0.0) return {a * t, 0.5 * a * t * t, thickness * std::exp(growth * 0.5 * a * t * t)};
    const double w = std::sqrt(a * loss), way = std::log(std::cosh(w * t)) / loss;
    return {std::sqrt(a / loss) * std::tanh(w * t), way, thickness * std::exp(growth * way)};
}

SlabState ErodingSlab::grown_voellmy(double growth, double xi, double t) const {
    const double a = drive(), loss = (1.0 - kappa) * growth;
    const auto rates = [&](double, const State<2>& y) {  // speed, way
        const double drag = gravity / (xi * thickness * std::exp(growth * y[1])) + loss;
        return State<2>{a - drag * y[0] * y[0], y[0]};
    };
    const State<2> end = integrate<2>(rates, 0.0, t, {0.0, 0.0}, 1e-2);
    return {end[0], end[1], thickness * std::exp(growth * end[1])};
}

SlabState ErodingSlab::jumped(double t) const {
    const double b = drive() - (1.0 - kappa) * friction(), u = speed + b * t;
    return {u, (speed + 0.5 * b * t) * t, thickness * std::pow(u / speed, friction() / b)};
}

double ErodingSlab::time_to(double growth, double way) const {
    const double loss = (1.0 - kappa) * growth;
    return std::acosh(std::exp(loss * way)) / std::sqrt(drive() * loss);
}

double Trench::depth(double x) const {
    return thickness * (std::exp(growth * clip(x + length, way)) - std::exp(growth * clip(x, way)));
}

double Trench::volume() const { return thickness * length * std::expm1(growth * way); }

GrowingCap::State GrowingCap::at(double t) const {
    const double cosine = std::cos(slope_deg * kDegree);
    const double a = gravity * (std::sin(slope_deg * kDegree) - cosine * std::tan(friction_deg * kDegree));
    const double loss = (1.0 - kappa) * eps;
    const auto peak = [&](double time, double length) { return height * half_length * std::exp(eps * time) / length; };
    const auto rates = [&](double time, const verify::State<4>& y) {  // L, L', x_c, u_c
        return verify::State<4>{y[1], 2.0 * gravity * cosine * peak(time, y[0]) / y[0] - loss * y[1], y[3],
                                a - loss * y[3]};
    };
    const auto y = integrate<4>(rates, 0.0, t, {half_length, 0.0, 0.0, 0.0}, 1e-3);
    return {y[0], y[1], y[2], y[3], peak(t, y[0])};
}

std::vector<Residual> eroding_slab_residuals() {
    ErodingSlab slab;
    slab.speed = 2.0;
    std::vector<Residual> list;
    const double rate = 0.02, t = 20.0, d = 1e-3;
    for (const auto& [kappa, speed] : {std::pair<double, double>{0.0, 41.822067}, {0.5, 45.269507}, {1.0, 49.125745}}) {
        slab.kappa = kappa;
        const SlabState now = slab.at_rate(rate, t), before = slab.at_rate(rate, t - d),
                        after = slab.at_rate(rate, t + d);
        list.push_back(printed("speed of the slab", now.speed, speed, 5e-7));
        const double force = slab.drive() * now.thickness - (1.0 - kappa) * rate * now.speed;
        list.push_back({"h du/dt - (a h - (1 - kappa) E u)",
                        now.thickness * (after.speed - before.speed) / (2.0 * d) - force, 1e-6});
    }
    return list;
}

std::vector<Residual> growing_slab_residuals() {
    ErodingSlab slab;
    std::vector<Residual> list;
    const SlabState mixing = slab.grown(2e-3, 40.0);
    slab.kappa = 0.5;
    const SlabState half = slab.grown(2e-3, 40.0);
    list = {printed("thickness, kappa 0", mixing.thickness, 7.821625, 5e-7),
            printed("speed, kappa 0", mixing.speed, 34.042414, 5e-7),
            printed("way, kappa 0", mixing.way, 1028.446144, 5e-7),
            printed("thickness, kappa 1/2", half.thickness, 12.651558, 5e-7),
            printed("speed, kappa 1/2", half.speed, 46.583714, 5e-7),
            printed("way, kappa 1/2", half.way, 1268.890202, 5e-7)};
    const double t = 15.0, d = 1e-3, growth = 2e-3;
    const SlabState now = slab.grown(growth, t), after = slab.grown(growth, t + d), before = slab.grown(growth, t - d);
    const double force = slab.drive() - 0.5 * growth * now.speed * now.speed;
    list.push_back({"du/dt - (a - (1 - kappa) E u / h)", (after.speed - before.speed) / (2.0 * d) - force, 1e-6});
    list.push_back({"time of a way", slab.time_to(growth, now.way) - t, 1e-11});
    return list;
}

std::vector<Residual> voellmy_slab_residuals() {
    ErodingSlab slab;
    slab.thickness = 1.5;
    const double growth = 1e-3, xi = 500.0;
    double early = 0.0, late = 400.0;
    for (int k = 0; k < 60; ++k) {
        const double t = 0.5 * (early + late);
        (slab.grown_voellmy(growth, xi, t).way < 2000.0 ? early : late) = t;
    }
    ErodingSlab coulomb;
    return {printed("speed after 2000 m", slab.grown_voellmy(growth, xi, early).speed, 27.684181, 5e-7),
            {"without drag as Coulomb's",
             coulomb.grown_voellmy(2e-3, 1e300, 15.0).speed / coulomb.grown(2e-3, 15.0).speed - 1.0, 1e-9}};
}

ErodingSlab jumping_slab(double kappa) {
    constexpr double kShare = 0.04;
    const ErodingSlab usual;
    ErodingSlab slab = ErodingSlab::with(usual.drive(), kShare * usual.friction());
    slab.thickness = 0.5, slab.speed = 3.0, slab.kappa = kappa;
    return slab;
}

std::vector<Residual> jumping_slab_residuals() {
    const double t = 20.0, d = 1e-3;
    std::vector<Residual> list = {printed("speed, kappa 0", jumping_slab(0.0).jumped(t).speed, 48.086775, 5e-7),
                                  printed("thickness, kappa 0", jumping_slab(0.0).jumped(t).thickness, 0.566839, 5e-7),
                                  printed("thickness, kappa 1", jumping_slab(1.0).jumped(t).thickness, 0.564784, 5e-7)};
    for (const double kappa : {0.0, 0.5, 1.0}) {
        const ErodingSlab slab = jumping_slab(kappa);
        const SlabState now = slab.jumped(t), before = slab.jumped(t - d), after = slab.jumped(t + d);
        const double rate = slab.friction() * now.thickness / now.speed;
        list.push_back({"dh/dt - E", (after.thickness - before.thickness) / (2.0 * d) - rate, 1e-9});
        const double force = slab.drive() * now.thickness - (1.0 - kappa) * rate * now.speed;
        list.push_back({"h du/dt - (a h - (1 - kappa) E u)",
                        now.thickness * (after.speed - before.speed) / (2.0 * d) - force, 1e-8});
    }
    return list;
}

std::vector<Residual> trench_residuals() {
    const Trench trench;
    double deepest = 0.0, volume = 0.0;
    constexpr int kParts = 400000;
    const double from = -trench.length, width = (trench.way + trench.length) / kParts;
    for (int k = 0; k < kParts; ++k) {
        const double e = trench.depth(from + (k + 0.5) * width);
        deepest = std::max(deepest, e), volume += width * e;
    }
    return {printed("largest depth of the trench", deepest, 0.173398, 1e-6),
            printed("its volume", trench.volume(), 41.105940, 5e-7),
            {"volume by parts", volume / trench.volume() - 1.0, 1e-8}};
}

std::vector<Residual> growing_cap_residuals() {
    GrowingCap cap;
    const GrowingCap::State mixing = cap.at(8.0);
    cap.kappa = 1.0;
    const GrowingCap::State jump = cap.at(8.0);
    return {printed("half length, kappa 0", mixing.half_length, 103.425528, 5e-7),
            printed("height, kappa 0", mixing.height, 4.615726, 5e-7),
            printed("centre, kappa 0", mixing.centre, 52.869191, 5e-7),
            printed("speed, kappa 0", mixing.speed, 12.393274, 5e-7),
            printed("spreading, kappa 0", mixing.spreading, 5.352439, 5e-7),
            printed("half length, kappa 1", jump.half_length, 106.484299, 5e-7),
            printed("height, kappa 1", jump.height, 4.483139, 5e-7),
            printed("centre, kappa 1", jump.centre, 60.146935, 5e-7),
            printed("speed, kappa 1", jump.speed, 15.036734, 5e-7),
            printed("spreading, kappa 1", jump.spreading, 6.423257, 5e-7)};
}

}  // namespace frana::verify
