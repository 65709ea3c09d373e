#include "ensemble/statistics.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace frana {
namespace {

constexpr double kRoundOff = 1e-9;  ///< of sums of weights

}  // namespace

void PixelValues::gather(const PeakSource& runs, const std::vector<double>& weights, std::size_t field) {
    expect(runs.runs() == weights.size(), "a weight for each run");
    const auto pixels = static_cast<std::size_t>(grid_.size());
    first_.assign(pixels + 1, 0);
    weights_ = weights, weight_ = 0.0;
    for (const double weight : weights) weight_ += weight;
    runs.for_each_run({}, [&](std::size_t, const SparseRasters& run) {
        run.for_each([&](Index pixel, std::size_t) { ++first_[static_cast<std::size_t>(pixel) + 1]; });
    });
    for (std::size_t k = 0; k < pixels; ++k) first_[k + 1] += first_[k];
    values_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    runs.for_each_run({field}, [&](std::size_t r, const SparseRasters& run) {
        const std::vector<float>& of = run.values.at(field);
        run.for_each([&](Index pixel, std::size_t n) {
            values_[next[static_cast<std::size_t>(pixel)]++] = {of[n], static_cast<std::uint32_t>(r)};
        });
    });
}

double PixelValues::largest() const {
    float most = 0.0F;
    for (const Value& v : values_) most = std::max(most, v.value);
    return static_cast<double>(most);
}

/// body(first, past) of the values of each pixel that has some; the others get 0.
template <class Body>
Raster PixelValues::of_each(Body&& body) const {
    Raster raster = Raster::filled(grid_, 0.0);
    for (std::size_t k = 0; k + 1 < first_.size(); ++k)
        if (first_[k] < first_[k + 1]) raster.values[k] = body(&values_[first_[k]], values_.data() + first_[k + 1]);
    return raster;
}

Raster PixelValues::exceeds(double threshold) const {
    const auto limit = static_cast<float>(threshold);
    return of_each([&](const Value* first, const Value* past) {
        double sum = 0.0;
        for (const Value* v = first; v != past; ++v)
            if (v->value > limit) sum += weight_of(*v);
        return sum / weight_;
    });
}

Raster PixelValues::reached() const {
    return of_each([&](const Value* first, const Value* past) {
        double sum = 0.0;
        for (const Value* v = first; v != past; ++v) sum += weight_of(*v);
        return sum / weight_;
    });
}

Raster PixelValues::mean() const {
    return of_each([&](const Value* first, const Value* past) {
        double sum = 0.0;
        for (const Value* v = first; v != past; ++v) sum += weight_of(*v) * static_cast<double>(v->value);
        return sum / weight_;
    });
}

std::vector<Raster> PixelValues::quantiles(const std::vector<double>& shares) const {
    std::vector<Raster> all(shares.size(), Raster::filled(grid_, 0.0));
    std::vector<Value> sorted;
    for (std::size_t k = 0; k + 1 < first_.size(); ++k) {
        sorted.assign(values_.begin() + static_cast<std::ptrdiff_t>(first_[k]),
                      values_.begin() + static_cast<std::ptrdiff_t>(first_[k + 1]));
        std::stable_sort(sorted.begin(), sorted.end(),
                         [](const Value& a, const Value& b) { return a.value > b.value; });
        for (std::size_t n = 0; n < shares.size(); ++n) all[n].values[k] = quantile_of(sorted, shares[n]);
    }
    return all;
}

void PixelValues::for_each_quantile(const std::vector<double>& shares,
                                    const std::function<void(std::size_t n, Raster raster)>& body) const {
    constexpr std::size_t together = 3;  // values are sorted once for so many, each of which is as large as the terrain
    for (std::size_t first = 0; first < shares.size(); first += together) {
        const auto begin = shares.begin() + static_cast<std::ptrdiff_t>(first);
        const auto count = static_cast<std::ptrdiff_t>(std::min(together, shares.size() - first));
        std::vector<Raster> rasters = quantiles({begin, begin + count});
        for (std::size_t n = 0; n < rasters.size(); ++n) body(first + n, std::move(rasters[n]));
    }
}

/// Of values that descend: what exceeds a value may be at most 1 - share. Runs that did not come have 0, which lies between
/// a rise of the bed and its fall.
double PixelValues::quantile_of(const std::vector<Value>& sorted, double share) const {
    const double most = (1.0 - share) * weight_ * (1.0 + kRoundOff);
    double above = 0.0;
    bool past_zero = false;
    for (const Value& v : sorted) {
        if (v.value < 0.0F && !past_zero) {
            past_zero = true, above += weight_of_others(sorted);
            if (above > most) return 0.0;
        }
        above += weight_of(v);
        if (above > most) return static_cast<double>(v.value);
    }
    return past_zero ? static_cast<double>(sorted.back().value) : 0.0;
}

double PixelValues::weight_of_others(const std::vector<Value>& some) const {
    double sum = 0.0;
    for (const Value& v : some) sum += weight_of(v);
    return sum < weight_ * (1.0 - kRoundOff) ? weight_ - sum : 0.0;
}

Raster PixelValues::arrival_quantile(double q) const {
    std::vector<Value> sorted;
    Raster raster = of_each([&](const Value* first, const Value* past) {
        sorted.assign(first, past);
        std::stable_sort(sorted.begin(), sorted.end(),
                         [](const Value& a, const Value& b) { return a.value < b.value; });
        double come = 0.0;
        for (const Value& v : sorted) {
            if (v.value < 0.0F) continue;
            come += weight_of(v);
            if (come >= q * weight_ * (1.0 - kRoundOff)) return static_cast<double>(v.value);
        }
        return Raster::nodata;
    });
    for (std::size_t k = 0; k + 1 < first_.size(); ++k)
        if (first_[k] == first_[k + 1]) raster.values[k] = Raster::nodata;
    return raster;
}

double effective_number(const std::vector<double>& weights) {
    double sum = 0.0, squares = 0.0;
    for (const double w : weights) sum += w, squares += w * w;
    return squares > 0.0 ? sum * sum / squares : 0.0;
}

double standard_error(double p, double number) {
    return number > 0.0 ? std::sqrt(std::max(0.0, p * (1.0 - p)) / number) : 0.0;
}

std::pair<double, double> wilson_bounds(double p, double number) {
    if (!(number > 0.0)) return {0.0, 1.0};
    constexpr double z = 1.959963984540054;  // 0.975 of a normal distribution lies below
    const double z2 = z * z / number, middle = (p + 0.5 * z2) / (1.0 + z2);
    const double half = z / (1.0 + z2) * std::sqrt((p * (1.0 - p) + 0.25 * z2) / number);
    return {std::clamp(middle - half, 0.0, p), std::clamp(middle + half, p, 1.0)};  // round-off aside
}

}  // namespace frana
