#include "ensemble/sensitivity.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.h"

namespace frana {
namespace {

constexpr Index kLevels = 4;  ///< of Morris' grid; a step is half of them

void fill_saltelli(Design& design, Index count, Index keys, std::uint64_t seed) {
    const Design both = make_design(Method::sobol, count, 2 * keys, seed);
    for (const auto& u : both.points) {
        const std::vector<double> a(u.begin(), u.begin() + keys), b(u.begin() + keys, u.end());
        design.points.push_back(a);
        design.points.push_back(b);
        for (std::size_t k = 0; k < static_cast<std::size_t>(keys); ++k) {
            design.points.push_back(a);
            design.points.back()[k] = b[k];
        }
    }
}

/// One way: a random start, keys in a random order, up or down as the grid allows.
void add_way(Design& design, Index way, Index keys, std::uint64_t seed) {
    const auto bits = [&](Index n) {
        return bits_at(seed, static_cast<std::uint64_t>(way), static_cast<std::uint64_t>(n));
    };
    std::vector<Index> level, order(static_cast<std::size_t>(keys));
    std::iota(order.begin(), order.end(), Index{0});
    for (Index k = 0; k < keys; ++k) level.push_back(static_cast<Index>(bits(k) >> 62));
    for (Index k = keys - 1; k > 0; --k)
        std::swap(order[static_cast<std::size_t>(k)],
                  order[static_cast<std::size_t>(bits(keys + k) % static_cast<std::uint64_t>(k + 1))]);
    const auto add = [&] {
        std::vector<double>& point = design.points.emplace_back();
        for (const Index at : level) point.push_back((static_cast<double>(at) + 0.5) / kLevels);
    };
    add();
    for (const Index k : order) {
        Index& at = level[static_cast<std::size_t>(k)];
        at += at < kLevels / 2 ? kLevels / 2 : -kLevels / 2;
        add();
    }
}

}  // namespace

Index runs_each(Method method, Index keys) {
    return method == Method::saltelli ? keys + 2 : method == Method::morris ? keys + 1 : 1;
}

Design make_sensitivity_design(Method method, Index count, Index keys, std::uint64_t seed) {
    Design design;
    if (method == Method::saltelli)
        fill_saltelli(design, count, keys, seed);
    else
        for (Index way = 0; way < count; ++way) add_way(design, way, keys, seed);
    return design;
}

SensitivityOfRuns::SensitivityOfRuns(Method method, const Design& design, const std::vector<bool>& has)
    : method_(method), design_(design) {
    expect(has.size() == design.points.size(), "an outcome for each sample");
    if (design.points.empty()) return;
    keys_ = design.points.front().size();
    const auto each = static_cast<std::size_t>(runs_each(method, static_cast<Index>(keys_)));
    for (std::size_t start = 0; start + each <= has.size(); start += each) {
        const auto first = has.begin() + static_cast<std::ptrdiff_t>(start);
        if (std::all_of(first, first + static_cast<std::ptrdiff_t>(each), [](bool one) { return one; }))
            starts_.push_back(start);
    }
}

std::vector<Sensitivity> SensitivityOfRuns::of(const std::vector<double>& outcomes, double noise) const {
    if (starts_.size() < 2) return {};
    return method_ == Method::saltelli ? by_sobol(outcomes, noise) : by_morris(outcomes, noise);
}

std::vector<Sensitivity> SensitivityOfRuns::by_sobol(const std::vector<double>& y, double noise) const {
    const double count = static_cast<double>(starts_.size());
    double sum = 0.0, variance = 0.0;
    for (const std::size_t s : starts_) sum += y[s] + y[s + 1];
    const double mean = sum / (2.0 * count);
    for (const std::size_t s : starts_)
        variance += ((y[s] - mean) * (y[s] - mean) + (y[s + 1] - mean) * (y[s + 1] - mean)) / (2.0 * count);
    if (!(variance > noise * noise * mean * mean)) return {};
    std::vector<Sensitivity> all(keys_);
    for (std::size_t k = 0; k < keys_; ++k)
        for (const std::size_t s : starts_) {
            const double a = y[s], b = y[s + 1], mixed = y[s + 2 + k];
            all[k].first += 1.0 / count - (b - mixed) * (b - mixed) / (2.0 * count * variance);
            all[k].total += (a - mixed) * (a - mixed) / (2.0 * count * variance);
        }
    return all;
}

std::vector<Sensitivity> SensitivityOfRuns::by_morris(const std::vector<double>& y, double noise) const {
    std::vector<Sensitivity> all(keys_);
    std::vector<double> sum(keys_, 0.0), squares(keys_, 0.0);
    const double count = static_cast<double>(starts_.size());
    double largest = 0.0;
    for (const std::size_t s : starts_)
        for (std::size_t m = 0; m < keys_; ++m) {
            const auto &from = design_.points[s + m], &to = design_.points[s + m + 1];
            largest = std::max({largest, std::abs(y[s + m]), std::abs(y[s + m + 1])});
            for (std::size_t k = 0; k < keys_; ++k) {
                if (from[k] == to[k]) continue;
                const double effect = (y[s + m + 1] - y[s + m]) / (to[k] - from[k]);
                all[k].first += std::abs(effect) / count;
                sum[k] += effect / count, squares[k] += effect * effect / count;
            }
        }
    for (std::size_t k = 0; k < keys_; ++k) all[k].total = std::sqrt(std::max(0.0, squares[k] - sum[k] * sum[k]));
    const bool none =
        std::all_of(all.begin(), all.end(), [&](const Sensitivity& one) { return !(one.first > noise * largest); });
    return none ? std::vector<Sensitivity>{} : all;
}

std::vector<Sensitivity> sensitivities(Method method, const Design& design,
                                       const std::vector<std::optional<double>>& outcomes) {
    std::vector<bool> has;
    std::vector<double> numbers;
    for (const auto& outcome : outcomes) has.push_back(outcome.has_value()), numbers.push_back(outcome.value_or(0.0));
    constexpr double noise = 1e-12;  // round-off of the mean
    return SensitivityOfRuns(method, design, has).of(numbers, noise);
}

SensitivityMaps sensitivity_maps(Method method, const Design& design, const std::vector<Index>& samples,
                                 const PixelValues& pixels) {
    const std::size_t keys = design.points.empty() ? 0 : design.points.front().size();
    std::vector<bool> has(design.points.size(), false);
    for (const Index sample : samples) has[static_cast<std::size_t>(sample)] = true;
    const SensitivityOfRuns runs(method, design, has);
    SensitivityMaps maps;
    maps.first.assign(keys, Raster::filled(pixels.grid(), Raster::nodata));
    maps.total = maps.first;
    constexpr double noise = 1e-6;  // the runs' fields are stored with seven digits
    std::vector<double> outcomes(design.points.size(), 0.0);
    pixels.for_each_by_run([&](Index pixel, const std::vector<double>& values) {
        for (std::size_t run = 0; run < values.size(); ++run)
            outcomes[static_cast<std::size_t>(samples[run])] = values[run];
        const std::vector<Sensitivity> found = runs.of(outcomes, noise);
        for (std::size_t k = 0; k < found.size(); ++k) {
            maps.first[k].values[static_cast<std::size_t>(pixel)] = found[k].first;
            maps.total[k].values[static_cast<std::size_t>(pixel)] = found[k].total;
        }
    });
    return maps;
}

}  // namespace frana
