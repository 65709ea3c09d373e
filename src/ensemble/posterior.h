#pragma once
// What a survey tells of the keys that vary. Samples are weighted by their likelihood, which also says where the next
// ones should lie.
#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/types.h"

namespace frana {

/// Adaptive importance sampling (Cappe et al. 2004) in the unit cube, where the prior is uniform. A point's coordinate
/// is the share of the key's distribution below its value. The first round is the prior's. Each further one is drawn
/// around the weighted points before it, and a part of it from the prior again. The kernels have the points'
/// covariance, since a survey often tells one key only by another. Much friction in one law may stand for little in the
/// next. They lie where the prior is normal (each share through the inverse of its distribution), which has no edges.
/// As long as few points have all of the weight, the likelihood is flattened (tempered). So no round shrinks onto one
/// of them. All rounds together count, each point by the mean density of all rounds (deterministic mixture, Veach and
/// Guibas 1995).
class Posterior {
public:
    Posterior(Index keys, std::uint64_t seed) : keys_(keys), seed_(seed) {}

    /// Points of the next round.
    std::vector<std::vector<double>> next(Index count) const;
    /// Takes their likelihoods, as logarithms; minus infinity: a run without an answer, or as far off as can be.
    void add(const std::vector<std::vector<double>>& points, const std::vector<double>& log_likelihood);

    const std::vector<std::vector<double>>& points() const { return points_; }
    const std::vector<double>& log_likelihood() const { return log_likelihood_; }
    /// Of all points so far, sum 1; all zero where no point has a likelihood.
    std::vector<double> weights() const { return weights(log_likelihood_); }
    /// The same points under other likelihoods, such as those of a part of the surveys.
    std::vector<double> weights(const std::vector<double>& log_likelihood) const;
    /// Some point has a likelihood.
    bool any() const;
    /// The point with the largest likelihood.
    std::size_t best() const;
    /// So many points, drawn evenly by weight (systematic resampling, Kitagawa 1996).
    std::vector<std::size_t> drawn(Index count) const;

private:
    /// A round's density: kernels around points before it.
    struct Round {
        std::size_t begin = 0, end = 0;  ///< its points
        std::vector<double> kernel;      ///< weight of each point before `begin`; empty: the prior
        Eigen::MatrixXd root;            ///< of the kernels' covariance, lower triangle
    };
    Round proposal() const;
    double share_of(const Round& round, const Eigen::VectorXd& normal) const;
    double density(const Round& round, const Eigen::VectorXd& normal) const;

    Index keys_;
    std::uint64_t seed_;
    std::vector<std::vector<double>> points_;
    std::vector<Eigen::VectorXd> normals_;  ///< the same, where the prior is normal
    std::vector<double> log_likelihood_;
    std::vector<double> mixture_;  ///< density of all rounds at each point, times their points
    std::vector<Round> rounds_;
};

/// The weighted mean, standard deviation and quantiles of numbers.
struct Marginal {
    double mean = 0.0, sd = 0.0, q05 = 0.0, q50 = 0.0, q95 = 0.0;
};
Marginal marginal_of(const std::vector<double>& numbers, const std::vector<double>& weights);
/// The weighted correlation of two lists of numbers [1]; nothing where one of them does not vary.
std::optional<double> correlation_of(const std::vector<double>& a, const std::vector<double>& b,
                                     const std::vector<double>& weights);

}  // namespace frana
