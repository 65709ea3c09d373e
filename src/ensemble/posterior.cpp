#include "ensemble/posterior.h"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "ensemble/design.h"
#include "ensemble/statistics.h"

namespace frana {
namespace {

constexpr double kFromPrior = 0.1;  ///< share of a round that is drawn from the prior again: no region is given up

/// A number beyond 0 or 1, mirrored into between.
double mirrored(double u) {
    u = std::abs(std::fmod(u, 2.0));
    return u > 1.0 ? 2.0 - u : u;
}

/// A Gaussian kernel between mirrors at 0 and 1.
double kernel(double u, double middle, double width) {
    constexpr double root_two_pi = 2.5066282746310002;
    double sum = 0.0;
    for (const double image : {middle, -middle, 2.0 - middle}) {
        const double z = (u - image) / width;
        sum += std::exp(-0.5 * z * z);
    }
    return sum / (root_two_pi * width);
}

}  // namespace

namespace {

/// Weights of likelihoods, flattened by the power `flat`, under the density that the points came from; sum 1, or all 0.
std::vector<double> weighted(const std::vector<double>& log_likelihood, const std::vector<double>& mixture,
                             double flat) {
    std::vector<double> w(log_likelihood.size(), 0.0);
    if (w.empty()) return w;
    const double most = *std::max_element(log_likelihood.begin(), log_likelihood.end());
    if (!std::isfinite(most)) return w;
    for (std::size_t i = 0; i < w.size(); ++i)
        if (std::isfinite(log_likelihood[i])) w[i] = std::exp(flat * (log_likelihood[i] - most)) / mixture[i];
    const double sum = std::accumulate(w.begin(), w.end(), 0.0);
    for (double& one : w) one /= sum;
    return w;
}

/// The largest power up to 1 that leaves a tenth of the points, and eight at least, with a say; where fewer have a likelihood
/// at all, one that leaves most of those.
double flattening(const std::vector<double>& log_likelihood, const std::vector<double>& mixture) {
    constexpr double most_of = 0.9;
    const double possible = effective_number(weighted(log_likelihood, mixture, 0.0));
    const double wanted = std::min(most_of * possible, std::max(8.0, 0.1 * static_cast<double>(mixture.size())));
    const auto enough = [&](double flat) {
        return effective_number(weighted(log_likelihood, mixture, flat)) >= wanted;
    };
    if (enough(1.0)) return 1.0;
    double low = 0.0, high = 1.0;
    for (int step = 0; step < 40; ++step) (enough(0.5 * (low + high)) ? low : high) = 0.5 * (low + high);
    return low;
}

}  // namespace

/// Kernels of the width that suits a normal distribution (Silverman 1986), by key.
Posterior::Round Posterior::proposal() const {
    Round round;
    round.begin = points_.size();
    const std::vector<double> w = weighted(log_likelihood_, mixture_, flattening(log_likelihood_, mixture_));
    const double sum = std::accumulate(w.begin(), w.end(), 0.0);
    if (!(sum > 0.0)) return round;
    round.kernel = w;
    constexpr double narrowest = 1e-3, widest = 0.25;  // mirrors farther away than three widths do not count
    const double d = static_cast<double>(keys_),
                 silverman = std::pow(4.0 / ((d + 2.0) * std::max(1.0, effective_number(w))), 1.0 / (d + 4.0));
    for (std::size_t k = 0; k < static_cast<std::size_t>(keys_); ++k) {
        std::vector<double> of_key;
        for (const auto& point : points_) of_key.push_back(point[k]);
        round.width.push_back(std::clamp(silverman * marginal_of(of_key, w).sd, narrowest, widest));
    }
    return round;
}

std::vector<std::vector<double>> Posterior::next(Index count) const {
    const Round round = proposal();
    if (round.kernel.empty()) {  // goes on with the sequence where the rounds before have left it
        const auto before = static_cast<Index>(points_.size());
        Design design = make_design(Method::sobol, before + count, keys_, seed_);
        design.points.erase(design.points.begin(), design.points.begin() + before);
        return design.points;
    }
    std::vector<double> sums(round.kernel.size());
    std::partial_sum(round.kernel.begin(), round.kernel.end(), sums.begin());
    const boost::math::normal normal;
    std::vector<std::vector<double>> points;
    for (Index i = 0; i < count; ++i) {
        const auto number = static_cast<std::uint64_t>(points_.size()) + static_cast<std::uint64_t>(i);
        const auto unit = [&](Index n) { return unit_at(seed_, number, static_cast<std::uint64_t>(n)); };
        const bool from_prior = unit(keys_) < kFromPrior;
        const double at = unit(keys_ + 1) * sums.back();
        const auto chosen = std::min<std::size_t>(
            sums.size() - 1, static_cast<std::size_t>(std::upper_bound(sums.begin(), sums.end(), at) - sums.begin()));
        std::vector<double> point(static_cast<std::size_t>(keys_));
        for (Index k = 0; k < keys_; ++k) {
            const auto key = static_cast<std::size_t>(k);
            const double u = mirrored(points_[chosen][key] + round.width[key] * boost::math::quantile(normal, unit(k)));
            point[key] = from_prior ? unit(k) : std::clamp(u, 1e-12, 1.0 - 1e-12);
        }
        points.push_back(std::move(point));
    }
    return points;
}

double Posterior::density(const Round& round, const std::vector<double>& point) const {
    if (round.kernel.empty()) return 1.0;
    double sum = 0.0;
    for (std::size_t j = 0; j < round.kernel.size(); ++j) {
        double product = round.kernel[j];
        for (std::size_t k = 0; product > 0.0 && k < point.size(); ++k)
            product *= kernel(point[k], points_[j][k], round.width[k]);
        sum += product;
    }
    return kFromPrior + (1.0 - kFromPrior) * sum;
}

void Posterior::add(const std::vector<std::vector<double>>& points, const std::vector<double>& log_likelihood) {
    expect(points.size() == log_likelihood.size(), "a likelihood for each point");
    Round round = proposal();
    round.end = round.begin + points.size();
    for (std::size_t i = 0; i < points_.size(); ++i) mixture_[i] += share_of(round, points_[i]);
    rounds_.push_back(std::move(round));
    points_.insert(points_.end(), points.begin(), points.end());
    log_likelihood_.insert(log_likelihood_.end(), log_likelihood.begin(), log_likelihood.end());
    for (const auto& point : points) {
        double sum = 0.0;
        for (const Round& before : rounds_) sum += share_of(before, point);
        mixture_.push_back(sum);
    }
}

/// A round's density at a point, times its number of points.
double Posterior::share_of(const Round& round, const std::vector<double>& point) const {
    return static_cast<double>(round.end - round.begin) * density(round, point);
}

std::vector<double> Posterior::weights(const std::vector<double>& log_likelihood) const {
    expect(log_likelihood.size() == points_.size(), "a likelihood for each point");
    return weighted(log_likelihood, mixture_, 1.0);
}

bool Posterior::any() const {
    return std::any_of(log_likelihood_.begin(), log_likelihood_.end(), [](double log) { return std::isfinite(log); });
}

std::size_t Posterior::best() const {
    return static_cast<std::size_t>(std::max_element(log_likelihood_.begin(), log_likelihood_.end()) -
                                    log_likelihood_.begin());
}

std::vector<std::size_t> Posterior::drawn(Index count) const {
    const std::vector<double> w = weights();
    std::vector<std::size_t> all;
    double below = 0.0;
    std::size_t at = 0;
    for (Index n = 0; n < count; ++n) {
        const double wanted = (static_cast<double>(n) + 0.5) / static_cast<double>(count);
        while (at + 1 < w.size() && below + w[at] < wanted) below += w[at++];
        all.push_back(at);
    }
    return all;
}

Marginal marginal_of(const std::vector<double>& numbers, const std::vector<double>& weights) {
    std::vector<std::pair<double, double>> sorted;
    for (std::size_t k = 0; k < numbers.size(); ++k) sorted.emplace_back(numbers[k], weights[k]);
    std::sort(sorted.begin(), sorted.end());
    double sum = 0.0, squares = 0.0;
    Marginal of;
    for (const auto& [x, w] : sorted) sum += w, of.mean += w * x;
    of.mean /= sum;
    for (const auto& [x, w] : sorted) squares += w * (x - of.mean) * (x - of.mean);
    of.sd = std::sqrt(squares / sum);
    const auto quantile = [&](double q) {
        double below = 0.0;
        for (const auto& [x, w] : sorted)
            if ((below += w) >= q * sum) return x;
        return sorted.back().first;
    };
    of.q05 = quantile(0.05), of.q50 = quantile(0.5), of.q95 = quantile(0.95);
    return of;
}

}  // namespace frana
