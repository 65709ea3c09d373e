#pragma once
// Maps of an ensemble: in how many of its runs a pixel saw more than a threshold. Also what a share of them stayed
// below.
#include <algorithm>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "ensemble/peak_source.h"
#include "terrain/sparse_rasters.h"

namespace frana {

/// One field of all runs that have an answer, by pixel. Numbers are added in the order of the samples, so the same runs give
/// the same bits, on any process.
class PixelValues {
public:
    explicit PixelValues(const GridGeometry& grid) : grid_(grid) {}

    /// Takes the `field`-th field of all runs; `weights` are theirs, of the same number.
    void gather(const PeakSource& runs, const std::vector<double>& weights, std::size_t field);

    const GridGeometry& grid() const { return grid_; }

    /// Of all runs and pixels; 0 where none came anywhere.
    double largest() const;

    /// Share of the weights with more than `threshold` [1].
    Raster exceeds(double threshold) const;
    /// For each share the least value that at least so much of the weights does not exceed. 0 where a run did not come.
    std::vector<Raster> quantiles(const std::vector<double>& shares) const;
    Raster quantile(double share) const { return quantiles({share}).front(); }
    /// The same by calls of body(n, raster) in the order of the shares; only a few are held together.
    void for_each_quantile(const std::vector<double>& shares,
                           const std::function<void(std::size_t n, Raster raster)>& body) const;
    /// The least time by which at least a share `q` of the weights has come. A run that never came, or has a time below zero,
    /// comes later than any. NaN where fewer come.
    Raster arrival_quantile(double q) const;
    Raster mean() const;
    /// Weight of the runs that came there, over all [1].
    Raster reached() const;

    /// Calls body(pixel, values) for each pixel that a run came to. `values` has that of each run, 0 where it did not
    /// come.
    template <class Body>
    void for_each_by_run(Body&& body) const {
        std::vector<double> values(weights_.size(), 0.0);
        for (std::size_t k = 0; k + 1 < first_.size(); ++k) {
            if (first_[k] == first_[k + 1]) continue;
            for (std::size_t n = first_[k]; n < first_[k + 1]; ++n)
                values[values_[n].run] = static_cast<double>(values_[n].value);
            body(static_cast<Index>(k), values);
            for (std::size_t n = first_[k]; n < first_[k + 1]; ++n) values[values_[n].run] = 0.0;
        }
    }

    /// Calls body(pixel, shares) for each pixel that a run came to. `shares` are those of the weights with more than
    /// each of `thresholds`, which ascend.
    template <class Body>
    void for_each_curve(const std::vector<double>& thresholds, Body&& body) const {
        const std::vector<float> limits(thresholds.begin(), thresholds.end());
        std::vector<double> shares(limits.size());
        for (std::size_t k = 0; k + 1 < first_.size(); ++k) {
            if (first_[k] == first_[k + 1]) continue;
            std::fill(shares.begin(), shares.end(), 0.0);
            for (std::size_t n = first_[k]; n < first_[k + 1]; ++n) {
                const auto above = std::lower_bound(limits.begin(), limits.end(), values_[n].value);
                if (above != limits.begin())
                    shares[static_cast<std::size_t>(above - limits.begin()) - 1] += weight_of(values_[n]);
            }
            for (std::size_t t = shares.size(); t-- > 1;) shares[t - 1] += shares[t];
            for (double& share : shares) share /= weight_;
            body(static_cast<Index>(k), shares);
        }
    }

private:
    struct Value {
        float value;
        std::uint32_t run;
    };
    template <class Body>
    Raster of_each(Body&& body) const;
    double quantile_of(const std::vector<Value>& sorted, double share) const;
    double weight_of_others(const std::vector<Value>& some) const;
    double weight_of(const Value& value) const { return weights_[value.run]; }

    GridGeometry grid_;
    double weight_ = 0.0;             ///< of all runs
    std::vector<double> weights_;     ///< by run
    std::vector<std::size_t> first_;  ///< by pixel, and one past the last
    std::vector<Value> values_;
};

/// The number of equal weights that tells as much: (sum w)^2 / sum w^2 (Kish 1965).
double effective_number(const std::vector<double>& weights);

/// What is not known of a probability `p` of so many independent runs: sqrt(p (1 - p) / n).
double standard_error(double p, double number);

/// Bounds of a probability that was found as `p` in so many independent runs. 95 of 100 such intervals hold it (Wilson,
/// J. Am. Stat. Assoc. 22 (1927) 209-212). [0, 1] without a run.
std::pair<double, double> wilson_bounds(double p, double number);

}  // namespace frana
