#include "io/gdal_resample.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace frana {
namespace {

// Shifts and overlaps below this share of a pixel are the round-off of map coordinates. These are 1e7 m in doubles,
// over pixels down to 1 cm. They move no elevation by more than a millionth of the difference between two pixels.
constexpr double kPlaceRoundOff = 1e-6;
constexpr double least_share = 0.5 - kPlaceRoundOff;
constexpr Index strip_pixels = Index(1) << 23;  // 64 MiB of doubles

/// Collects weights by pixel index, which may lie outside the pixels.
class Tally {
public:
    explicit Tally(Index count) : count_(count) {}
    /// Pixels outside are extrapolated: value(-m) = (1 + m) value(0) - m value(1), and likewise at the other
    /// end.
    void add(Index k, double weight) {
        if (count_ == 1) return put(0, weight);
        if (k < 0) return put(0, weight * double(1 - k)), put(1, weight * double(k));
        if (k < count_) return put(k, weight);
        const double m = double(k - count_ + 1);
        put(count_ - 1, weight * (1.0 + m));
        put(count_ - 2, -weight * m);
    }
    /// Pixels outside take the value of the outermost.
    void add_clamped(Index k, double weight) { put(std::clamp<Index>(k, 0, count_ - 1), weight); }
    Index first() const { return first_; }
    const std::vector<double>& weights() const { return weights_; }

private:
    void put(Index k, double weight) {
        if (weights_.empty()) first_ = k;
        if (k < first_) {
            weights_.insert(weights_.begin(), std::size_t(first_ - k), 0.0);
            first_ = k;
        }
        const auto at = std::size_t(k - first_);
        if (at >= weights_.size()) weights_.resize(at + 1, 0.0);
        weights_[at] += weight;
    }
    Index count_;
    Index first_ = 0;
    std::vector<double> weights_;
};

/// The tallies on one range of pixels, without zeros at its ends; divided by what the plain weights sum to.
NodeWeights merged(const Tally& fine, const Tally& plain, const Tally& moment) {
    const std::array<const Tally*, 3> tallies = {&fine, &plain, &moment};
    Index first = std::numeric_limits<Index>::max(), end = std::numeric_limits<Index>::min();
    double sum = 0.0;
    for (const double w : plain.weights()) sum += w;
    for (const Tally* tally : tallies)
        for (std::size_t k = 0; k < tally->weights().size(); ++k)
            if (std::abs(tally->weights()[k]) > kPlaceRoundOff * sum) {
                const Index at = tally->first() + Index(k);
                first = std::min(first, at);
                end = std::max(end, at + 1);
            }
    NodeWeights node;
    node.first = first;
    const std::array<std::vector<double>*, 3> out = {&node.fine, &node.plain, &node.moment};
    for (std::size_t t = 0; t < 3; ++t) {
        out[t]->assign(std::size_t(end - first), 0.0);
        const std::vector<double>& weights = tallies[t]->weights();
        double kept = 0.0;
        for (std::size_t k = 0; k < weights.size(); ++k) {
            const Index at = tallies[t]->first() + Index(k) - first;
            if (at < 0 || at >= end - first) continue;
            (*out[t])[std::size_t(at)] = weights[k];
            kept += weights[k];
        }
        for (double& w : *out[t]) w /= t < 2 ? kept : sum;  // a single pixel gets the weight 1 exactly
    }
    return node;
}

/// Mean over the part of [a, b] inside, in pixels from the start of pixel 0.
NodeWeights mean_weights(Index count, double a, double b) {
    a = std::max(a, 0.0);
    b = std::min(b, double(count));
    Tally fine(count), plain(count), moment(count);
    const auto first = std::clamp<Index>(Index(std::floor(a + kPlaceRoundOff)), 0, count - 1);
    const auto last = std::clamp<Index>(Index(std::ceil(b - kPlaceRoundOff)) - 1, 0, count - 1);
    for (Index k = first; k <= last; ++k) {
        const double from = k == first ? a : double(k), to = k == last ? b : double(k + 1);
        const double u0 = from - double(k) - 0.5, u1 = to - double(k) - 0.5;
        const double first_moment = 0.5 * (u1 * u1 - u0 * u0);  // integral of u; the slope is half of what follows
        plain.add(k, u1 - u0);
        moment.add(k, first_moment);
        fine.add(k, u1 - u0);
        fine.add(k + 1, 0.5 * first_moment);
        fine.add(k - 1, -0.5 * first_moment);
    }
    return merged(fine, plain, moment);
}

/// Cubic convolution at `u`, in pixels from the centre of pixel 0.
NodeWeights cubic_weights(Index count, double u) {
    const double floor = std::floor(u + kPlaceRoundOff), f = std::max(0.0, u - floor), g = 1.0 - f;
    const auto k = Index(floor);
    Tally fine(count), plain(count), moment(count);
    moment.add_clamped(k, 0.0);
    fine.add(k - 1, -0.5 * f * g * g);
    fine.add(k, 1.0 + f * f * (1.5 * f - 2.5));
    fine.add(k + 1, 1.0 + g * g * (1.5 * g - 2.5));
    fine.add(k + 2, -0.5 * g * f * f);
    plain.add_clamped(k, g);
    plain.add_clamped(k + 1, f);
    return merged(fine, plain, moment);
}

/// Pixel rows in memory, and where slopes have to be limited.
class Strip {
public:
    Strip(Index first, Index rows, Index columns, std::vector<double> values)
        : first_(first), rows_(rows), columns_(columns), values_(std::move(values)) {
        for (Index j = 0; j < rows_; ++j)
            for (Index i = 0; i < columns_; ++i)
                if (share(i, j) < 1.0) {
                    steep_.resize(values_.size(), 0);
                    steep_[std::size_t(j * columns_ + i)] = 1;
                }
    }
    const double* row(Index j) const { return values_.data() + (j - first_) * columns_; }
    double value(const NodeWeights& wx, const NodeWeights& wy, double fast) const {
        if (std::isnan(fast)) return near_nodata(wx, wy);
        if (!steep_.empty() && over_steep(wx, wy)) return limited(wx, wy);
        return fast;
    }

private:
    struct Slopes {
        double x = 0.0, y = 0.0, xy = 0.0;
    };
    double at(Index i, Index j) const { return values_[std::size_t(j * columns_ + i)]; }

    /// Central differences, one-sided in the outermost pixels, per pixel.
    Slopes slopes(Index i, Index j) const {
        const Index w = std::max<Index>(i - 1, 0), e = std::min(i + 1, columns_ - 1);
        const Index s = std::max<Index>(j - 1, 0), n = std::min(j + 1, rows_ - 1);
        const double dx = e > w ? double(e - w) : 1.0, dy = n > s ? double(n - s) : 1.0;
        return {(at(e, j) - at(w, j)) / dx, (at(i, n) - at(i, s)) / dy,
                (at(e, n) - at(w, n) - at(e, s) + at(w, s)) / (dx * dy)};
    }

    /// Share of the slopes with which the pixel stays non-negative; 1 where no limit is needed.
    double share(Index i, Index j) const {
        const double v = at(i, j);
        if (!(v >= 0.0)) return 1.0;
        const Slopes slope = slopes(i, j);
        const double drop = 0.5 * std::abs(slope.x) + 0.5 * std::abs(slope.y) + 0.25 * std::abs(slope.xy);
        if (!(drop > v)) return 1.0;
        for (Index n = std::max<Index>(j - 1, 0); n <= std::min(j + 1, rows_ - 1); ++n)
            for (Index m = std::max<Index>(i - 1, 0); m <= std::min(i + 1, columns_ - 1); ++m)
                if (!(at(m, n) >= 0.0)) return 1.0;
        return v / drop;
    }

    template <class Visit>
    void each_pixel(const NodeWeights& wx, const NodeWeights& wy, Visit&& visit) const {
        for (std::size_t j = 0; j < wy.plain.size(); ++j)
            for (std::size_t i = 0; i < wx.plain.size(); ++i)
                visit(i, j, wx.first + Index(i), wy.first - first_ + Index(j));
    }

    /// Plain weights over what is left.
    double near_nodata(const NodeWeights& wx, const NodeWeights& wy) const {
        double sum = 0.0, left = 0.0;
        each_pixel(wx, wy, [&](std::size_t i, std::size_t j, Index column, Index row) {
            const double weight = wx.plain[i] * wy.plain[j], v = at(column, row);
            if (std::isnan(v) || weight == 0.0) return;
            sum += weight * v;
            left += weight;
        });
        return left >= least_share ? sum / left : std::numeric_limits<double>::quiet_NaN();
    }

    bool over_steep(const NodeWeights& wx, const NodeWeights& wy) const {
        bool found = false;
        each_pixel(wx, wy, [&](std::size_t, std::size_t, Index column, Index row) {
            found = found || steep_[std::size_t(row * columns_ + column)];
        });
        return found;
    }

    /// The fine weights, written as plain weights and slopes, with the slopes limited.
    double limited(const NodeWeights& wx, const NodeWeights& wy) const {
        double sum = 0.0;
        each_pixel(wx, wy, [&](std::size_t i, std::size_t j, Index column, Index row) {
            const double ax = wx.plain[i], ay = wy.plain[j], mx = wx.moment[i], my = wy.moment[j];
            if (ax * ay != 0.0) sum += ax * ay * at(column, row);
            if (mx == 0.0 && my == 0.0) return;
            const Slopes slope = slopes(column, row);
            sum += share(column, row) * (mx * ay * slope.x + ax * my * slope.y + mx * my * slope.xy);
        });
        return sum;
    }

    Index first_, rows_, columns_;
    std::vector<double> values_;
    std::vector<char> steep_;  ///< empty: nowhere
};

/// One row of nodes.
void resample_row(const std::vector<NodeWeights>& in_x, const NodeWeights& wy, const Strip& strip,
                  std::vector<double>& folded, double* out) {
    std::fill(folded.begin(), folded.end(), 0.0);
    for (std::size_t j = 0; j < wy.fine.size(); ++j) {
        const double* row = strip.row(wy.first + Index(j));
        for (std::size_t k = 0; k < folded.size(); ++k) folded[k] += wy.fine[j] * row[k];
    }
    for (std::size_t i = 0; i < in_x.size(); ++i) {
        const NodeWeights& wx = in_x[i];
        if (wx.fine.empty()) continue;
        double value = 0.0;
        for (std::size_t k = 0; k < wx.fine.size(); ++k) value += wx.fine[k] * folded[std::size_t(wx.first) + k];
        out[i] = strip.value(wx, wy, value);
    }
}

/// Node rows from `start` on whose pixels fit into one strip, and those pixel rows.
struct Batch {
    Index stop = 0, low = 0, high = 0;
};

Batch next_batch(const std::vector<NodeWeights>& in_y, Index start, Index most_rows) {
    const NodeWeights& first = in_y[std::size_t(start)];
    Batch batch{start, first.first, first.first};
    for (; batch.stop < Index(in_y.size()) && !in_y[std::size_t(batch.stop)].fine.empty(); ++batch.stop) {
        const NodeWeights& wy = in_y[std::size_t(batch.stop)];
        const Index low = std::min(batch.low, wy.first);
        const Index high = std::max(batch.high, wy.first + Index(wy.fine.size()));
        if (batch.stop > start && high - low > most_rows) break;
        batch.low = low;
        batch.high = high;
    }
    return batch;
}

}  // namespace

std::vector<NodeWeights> axis_weights(const PixelAxis& pixels, double x0, double cell, Index count) {
    std::vector<NodeWeights> nodes(static_cast<std::size_t>(count));
    const double ratio = cell / pixels.size;
    for (Index i = 0; i < count; ++i) {
        const double centre = (x0 + double(i) * cell - pixels.start) / pixels.size;  // in pixels
        const double a = centre - 0.5 * ratio, b = centre + 0.5 * ratio;
        const double inside = std::min(b, double(pixels.count)) - std::max(a, 0.0);
        if (inside < least_share * ratio) continue;
        nodes[std::size_t(i)] =
            ratio > 1.0 - kPlaceRoundOff ? mean_weights(pixels.count, a, b) : cubic_weights(pixels.count, centre - 0.5);
    }
    return nodes;
}

std::vector<double> resample(const std::vector<NodeWeights>& in_x, const std::vector<NodeWeights>& in_y,
                             const PixelRows& pixels) {
    const Index nx = Index(in_x.size()), ny = Index(in_y.size());
    std::vector<double> values(std::size_t(nx * ny), std::numeric_limits<double>::quiet_NaN());
    std::vector<double> folded(static_cast<std::size_t>(pixels.columns));
    const Index most_rows = std::max<Index>(1, strip_pixels / std::max<Index>(1, pixels.columns));
    for (Index j = 0; j < ny;) {
        if (in_y[std::size_t(j)].fine.empty()) {
            ++j;
            continue;
        }
        const Batch batch = next_batch(in_y, j, most_rows);
        // Neighbours of the outermost rows too: slopes must not depend on where a strip ends.
        const Index low = std::max<Index>(batch.low - 1, 0), high = std::min(batch.high + 1, pixels.rows);
        const Strip strip(low, high - low, pixels.columns, pixels.read(low, high - low));
        for (; j < batch.stop; ++j) resample_row(in_x, in_y[std::size_t(j)], strip, folded, values.data() + j * nx);
    }
    return values;
}

}  // namespace frana
