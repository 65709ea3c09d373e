// Weighted samples of what a survey tells, where the answer is known.
#include <algorithm>
#include <cmath>

#include "catch.h"
#include "ensemble/design.h"
#include "ensemble/posterior.h"
#include "ensemble/statistics.h"

using namespace frana;

namespace {

/// A normal likelihood around `middle` in each key.
std::vector<double> normal_likelihood(const std::vector<std::vector<double>>& points, const std::vector<double>& middle,
                                      const std::vector<double>& sigma) {
    std::vector<double> all;
    for (const auto& u : points) {
        double log = 0.0;
        for (std::size_t k = 0; k < u.size(); ++k) log -= 0.5 * std::pow((u[k] - middle[k]) / sigma[k], 2);
        all.push_back(log);
    }
    return all;
}

Posterior sampled(const std::vector<double>& middle, const std::vector<double>& sigma, Index count, int rounds,
                  std::uint64_t seed) {
    Posterior posterior(static_cast<Index>(middle.size()), seed);
    for (int round = 0; round < rounds; ++round) {
        const auto points = posterior.next(count);
        posterior.add(points, normal_likelihood(points, middle, sigma));
    }
    return posterior;
}

std::vector<double> key_of(const Posterior& posterior, std::size_t key) {
    std::vector<double> all;
    for (const auto& u : posterior.points()) all.push_back(u[key]);
    return all;
}

}  // namespace

TEST_CASE("Weighted samples have the mean and the spread of a likelihood that is known", "[ensemble]") {
    const std::vector<double> middle = {0.4, 0.7}, sigma = {0.02, 0.05};
    const Posterior posterior = sampled(middle, sigma, 200, 4, 1);
    const std::vector<double> w = posterior.weights();
    const double n = effective_number(w);
    CHECK(n > 200.0);  // the prior alone would have 800 * 4 pi * 0.02 * 0.05 = 10
    for (std::size_t k = 0; k < 2; ++k) {
        const Marginal of = marginal_of(key_of(posterior, k), w);
        // Three standard errors of a mean, and of a standard deviation, of so many independent samples.
        CHECK(of.mean == Approx(middle[k]).margin(3.0 * sigma[k] / std::sqrt(n)));
        CHECK(of.sd == Approx(sigma[k]).margin(3.0 * sigma[k] / std::sqrt(2.0 * n)));
        CHECK(of.q95 - of.q05 == Approx(2.0 * 1.6449 * sigma[k]).epsilon(0.15));
        CHECK(posterior.points()[posterior.best()][k] == Approx(middle[k]).margin(sigma[k]));
    }
}

TEST_CASE("A survey that tells one key only by another is sampled along what it leaves open", "[ensemble]") {
    // A ridge across the square, fifteen times as long as it is wide: of normal distributions along and across.
    constexpr double across = 0.01, along = 0.15, shift = 0.05;
    Posterior posterior(2, 1);
    for (int round = 0; round < 4; ++round) {
        const auto points = posterior.next(200);
        std::vector<double> log_likelihood;
        for (const auto& u : points) {
            const double a = (u[0] + u[1] - 1.0) / std::sqrt(2.0), b = (u[0] - u[1]) / std::sqrt(2.0) - shift;
            log_likelihood.push_back(-0.5 * (a * a / (across * across) + b * b / (along * along)));
        }
        posterior.add(points, log_likelihood);
    }
    const std::vector<double> w = posterior.weights();
    const double n = effective_number(w), sd = std::sqrt(0.5 * (across * across + along * along));
    CHECK(n > 200.0);  // the last round alone; kernels without the keys' correlation leave 50 to 100 of all four
    const Marginal of = marginal_of(key_of(posterior, 0), w);
    CHECK(of.mean == Approx(0.5 + shift / std::sqrt(2.0)).margin(3.0 * sd / std::sqrt(n)));
    CHECK(of.sd == Approx(sd).margin(3.0 * sd / std::sqrt(2.0 * n)));
    // Of the ridge itself; three standard errors of a correlation of so many samples (1 - r^2) / sqrt(n).
    const double together = (across * across - along * along) / (across * across + along * along);
    CHECK(correlation_of(key_of(posterior, 0), key_of(posterior, 1), w).value() ==
          Approx(together).margin(3.0 * (1.0 - together * together) / std::sqrt(n)));
    CHECK_FALSE(correlation_of(key_of(posterior, 0), std::vector<double>(w.size(), 1.0), w).has_value());
}

TEST_CASE("A likelihood at the edge of the prior is not blurred over it", "[ensemble]") {
    // Half of a normal distribution: mean sigma sqrt(2 / pi).
    const Posterior posterior = sampled({0.0}, {0.05}, 200, 3, 2);
    const std::vector<double> w = posterior.weights();
    const double expected = 0.05 * std::sqrt(2.0 / std::acos(-1.0));
    CHECK(
        marginal_of(key_of(posterior, 0), w).mean ==
        Approx(expected).margin(3.0 * 0.05 * std::sqrt(1.0 - 2.0 / std::acos(-1.0)) / std::sqrt(effective_number(w))));
}

TEST_CASE("Draws from the posterior are as a truth of the prior ranks among them: evenly", "[ensemble]") {
    // Simulation-based calibration (Talts et al. 2018): a truth from the prior, a survey of it with an error, the rank of the
    // truth among draws of the posterior. Of 200 trials in 10 bins chi squared exceeds 27.9 once in a thousand times.
    constexpr int trials = 200, bins = 10;
    std::vector<int> counts(bins, 0);
    for (std::uint64_t trial = 0; trial < trials; ++trial) {
        const double truth = unit_at(91, trial, 0), sigma = 0.1;
        const double error = sigma * std::sqrt(-2.0 * std::log(unit_at(91, trial, 1))) *
                             std::cos(2.0 * std::acos(-1.0) * unit_at(91, trial, 2));
        const Posterior posterior = sampled({truth + error}, {sigma}, 64, 3, trial);
        int below = 0;
        for (const std::size_t k : posterior.drawn(99)) below += posterior.points()[k][0] < truth;
        ++counts[static_cast<std::size_t>(below * bins / 100)];
    }
    double chi_squared = 0.0;
    for (const int count : counts) chi_squared += std::pow(count - trials / bins, 2) / (trials / bins);
    CAPTURE(counts);
    CHECK(chi_squared < 27.9);
}

TEST_CASE("Without any likelihood the next round is of the prior, and no weight is not a number", "[ensemble]") {
    Posterior posterior(2, 3);
    const auto first = posterior.next(16);
    posterior.add(first, std::vector<double>(16, -std::numeric_limits<double>::infinity()));
    const auto second = posterior.next(16);
    CHECK(second != first);
    Posterior whole(2, 3);
    const auto both = whole.next(32);
    CHECK(std::equal(second.begin(), second.end(), both.begin() + 16));
    for (const double w : posterior.weights()) CHECK(w == 0.0);
}

TEST_CASE("Where few points have any likelihood the next round gathers around them", "[ensemble]") {
    Posterior posterior(1, 5);
    const auto first = posterior.next(32);
    std::vector<double> log_likelihood;
    for (const auto& u : first) log_likelihood.push_back(u[0] > 0.9 ? 0.0 : -std::numeric_limits<double>::infinity());
    posterior.add(first, log_likelihood);
    Index near = 0;
    for (const auto& u : posterior.next(100)) near += u[0] > 0.8;
    CHECK(near > 60);  // of the prior a fifth would be
}
