#include "ensemble/posterior.h"

#include <Eigen/Cholesky>
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

constexpr double kEdge = 1e-12;  ///< the normal distribution has no place for shares of 0 and 1

/// A share of the key's distribution as a number of a normal one.
double normal_of(double share) {
    return boost::math::quantile(boost::math::normal(), std::clamp(share, kEdge, 1.0 - kEdge));
}

double share_below(double normal) {
    return std::clamp(boost::math::cdf(boost::math::normal(), normal), kEdge, 1.0 - kEdge);
}

/// Of points by their weights, whose sum is 1.
Eigen::MatrixXd covariance(const std::vector<Eigen::VectorXd>& points, const std::vector<double>& weights) {
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(points.front().size());
    for (std::size_t i = 0; i < points.size(); ++i) mean += weights[i] * points[i];
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(mean.size(), mean.size());
    for (std::size_t i = 0; i < points.size(); ++i)
        sum += weights[i] * (points[i] - mean) * (points[i] - mean).transpose();
    return sum;
}

/// Weights of likelihoods, flattened by the power `flat`, under the density that the points came from. Their sum is 1,
/// or all are 0.
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

/// The largest power up to 1 that leaves a tenth of the points, and eight at least, with a say. Where fewer have a
/// likelihood at all, one that leaves most of those.
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

/// Kernels of the width that suits a normal distribution (Silverman 1986). The fewer points tell of the covariance, the less
/// the keys go together in it. It is shrunk to its diagonal (Schaefer and Strimmer 2005).
Posterior::Round Posterior::proposal() const {
    Round round;
    round.begin = points_.size();
    const std::vector<double> w = weighted(log_likelihood_, mixture_, flattening(log_likelihood_, mixture_));
    const double sum = std::accumulate(w.begin(), w.end(), 0.0);
    if (!(sum > 0.0)) return round;
    round.kernel = w;
    constexpr double narrowest = 2e-3;  // of the prior's standard deviation
    const double d = static_cast<double>(keys_), n = std::max(1.0, effective_number(w)),
                 silverman = std::pow(4.0 / ((d + 2.0) * n), 1.0 / (d + 4.0)), shrunk = d / (d + n);
    Eigen::MatrixXd spread = covariance(normals_, w);
    const Eigen::VectorXd by_key = spread.diagonal();
    spread *= silverman * silverman * (1.0 - shrunk);
    spread.diagonal() += silverman * silverman * shrunk * by_key;
    spread.diagonal().array() += narrowest * narrowest;
    round.root = spread.llt().matrixL();
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
    std::vector<std::vector<double>> points;
    for (Index i = 0; i < count; ++i) {
        const auto number = static_cast<std::uint64_t>(points_.size()) + static_cast<std::uint64_t>(i);
        const auto unit = [&](Index n) { return unit_at(seed_, number, static_cast<std::uint64_t>(n)); };
        const bool from_prior = unit(keys_) < kFromPrior;
        const double at = unit(keys_ + 1) * sums.back();
        const auto chosen = std::min<std::size_t>(
            sums.size() - 1, static_cast<std::size_t>(std::upper_bound(sums.begin(), sums.end(), at) - sums.begin()));
        Eigen::VectorXd normal(keys_);
        for (Index k = 0; k < keys_; ++k) normal[k] = normal_of(unit(k));
        if (!from_prior) normal = normals_[chosen] + round.root * normal;
        std::vector<double> point;
        for (const double z : normal) point.push_back(share_below(z));
        points.push_back(std::move(point));
    }
    return points;
}

/// Over the prior's, which is 1 in the unit cube.
double Posterior::density(const Round& round, const Eigen::VectorXd& normal) const {
    if (round.kernel.empty()) return 1.0;
    const auto root = round.root.triangularView<Eigen::Lower>();
    const double of_prior = 0.5 * normal.squaredNorm();
    double sum = 0.0;
    for (std::size_t j = 0; j < round.kernel.size(); ++j)
        if (round.kernel[j] > 0.0)
            sum += round.kernel[j] * std::exp(of_prior - 0.5 * root.solve((normal - normals_[j]).eval()).squaredNorm());
    return kFromPrior + (1.0 - kFromPrior) * sum / round.root.diagonal().prod();
}

void Posterior::add(const std::vector<std::vector<double>>& points, const std::vector<double>& log_likelihood) {
    expect(points.size() == log_likelihood.size(), "a likelihood for each point");
    Round round = proposal();
    round.end = round.begin + points.size();
    for (std::size_t i = 0; i < points_.size(); ++i) mixture_[i] += share_of(round, normals_[i]);
    rounds_.push_back(std::move(round));
    points_.insert(points_.end(), points.begin(), points.end());
    log_likelihood_.insert(log_likelihood_.end(), log_likelihood.begin(), log_likelihood.end());
    for (const auto& point : points) {
        Eigen::VectorXd& normal = normals_.emplace_back(keys_);
        std::transform(point.begin(), point.end(), normal.begin(), normal_of);
        double sum = 0.0;
        for (const Round& before : rounds_) sum += share_of(before, normal);
        mixture_.push_back(sum);
    }
}

/// A round's density at a point, times its number of points.
double Posterior::share_of(const Round& round, const Eigen::VectorXd& normal) const {
    return static_cast<double>(round.end - round.begin) * density(round, normal);
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

std::optional<double> correlation_of(const std::vector<double>& a, const std::vector<double>& b,
                                     const std::vector<double>& weights) {
    const Marginal of_a = marginal_of(a, weights), of_b = marginal_of(b, weights);
    const double spread = of_a.sd * of_b.sd;
    if (!(spread > 0.0)) return std::nullopt;
    double together = 0.0, sum = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k)
        together += weights[k] * (a[k] - of_a.mean) * (b[k] - of_b.mean), sum += weights[k];
    return together / (sum * spread);
}

}  // namespace frana
