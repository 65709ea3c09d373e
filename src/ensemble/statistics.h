#pragma once
// Maps of an ensemble: in how many of its runs a pixel saw more than a threshold, and what a share of them stayed below.
#include <vector>

#include "terrain/sparse_rasters.h"

namespace frana {

/// One field of all runs that have an answer, by pixel. Numbers are added in the order of the samples, so the same runs give
/// the same bits, whoever ran them.
class PixelValues {
public:
    explicit PixelValues(const GridGeometry& grid) : grid_(grid) {}

    /// Takes the `field`-th field of all runs; `weights` are theirs, of the same number.
    void gather(const std::vector<const SparseRasters*>& runs, const std::vector<double>& weights, std::size_t field);

    /// Share of the weights with more than `threshold` [1].
    Raster exceeds(double threshold) const;
    /// The least value that at least a share `q` of the weights does not exceed; 0 where a run did not come.
    Raster quantile(double q) const;
    Raster mean() const;
    /// Weight of the runs that came there, over all [1].
    Raster reached() const;

private:
    struct Value {
        float value;
        double weight;
    };
    template <class Body>
    Raster of_each(Body&& body) const;

    GridGeometry grid_;
    double weight_ = 0.0;             ///< of all runs
    std::vector<std::size_t> first_;  ///< by pixel, and one past the last
    std::vector<Value> values_;
};

/// The number of equal weights that tells as much: (sum w)^2 / sum w^2 (Kish 1965).
double effective_number(const std::vector<double>& weights);

/// What is not known of a probability `p` of so many independent runs: sqrt(p (1 - p) / n).
double standard_error(double p, double number);

}  // namespace frana
