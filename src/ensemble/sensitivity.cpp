#include "ensemble/sensitivity.h"

#include <cmath>
#include <numeric>

#include "base/error.h"

namespace frana {
namespace {

constexpr Index kLevels = 4;  ///< of Morris' grid; a step is half of them

using Group = std::vector<double>;  ///< outcomes of the runs that belong together

/// Groups whose runs all have an answer.
std::vector<Group> whole_groups(std::size_t each, const std::vector<std::optional<double>>& outcomes,
                                std::vector<std::size_t>& starts) {
    std::vector<Group> groups;
    for (std::size_t start = 0; start + each <= outcomes.size(); start += each) {
        Group group;
        for (std::size_t k = 0; k < each; ++k)
            if (outcomes[start + k]) group.push_back(*outcomes[start + k]);
        if (group.size() < each) continue;
        groups.push_back(group);
        starts.push_back(start);
    }
    return groups;
}

double variance_of_a_and_b(const std::vector<Group>& groups) {
    double sum = 0.0, squares = 0.0;
    const double count = 2.0 * static_cast<double>(groups.size());
    for (const Group& g : groups) sum += g[0] + g[1];
    for (const Group& g : groups)
        squares += (g[0] - sum / count) * (g[0] - sum / count) + (g[1] - sum / count) * (g[1] - sum / count);
    return squares / count;
}

std::vector<Sensitivity> by_sobol(const std::vector<Group>& groups, std::size_t keys) {
    const double variance = variance_of_a_and_b(groups), count = static_cast<double>(groups.size());
    if (!(variance > 0.0)) return {};
    std::vector<Sensitivity> all(keys);
    for (std::size_t k = 0; k < keys; ++k) {
        for (const Group& g : groups) {
            const double a = g[0], b = g[1], mixed = g[2 + k];
            all[k].first += 1.0 / count - (b - mixed) * (b - mixed) / (2.0 * count * variance);
            all[k].total += (a - mixed) * (a - mixed) / (2.0 * count * variance);
        }
    }
    return all;
}

std::vector<Sensitivity> by_morris(const std::vector<Group>& groups, const std::vector<std::size_t>& starts,
                                   const Design& design, std::size_t keys) {
    std::vector<Sensitivity> all(keys);
    std::vector<double> sum(keys, 0.0), squares(keys, 0.0);
    const double count = static_cast<double>(groups.size());
    for (std::size_t n = 0; n < groups.size(); ++n)
        for (std::size_t m = 0; m < keys; ++m) {
            const auto &from = design.points[starts[n] + m], &to = design.points[starts[n] + m + 1];
            for (std::size_t k = 0; k < keys; ++k) {
                if (from[k] == to[k]) continue;
                const double effect = (groups[n][m + 1] - groups[n][m]) / (to[k] - from[k]);
                all[k].first += std::abs(effect) / count;
                sum[k] += effect / count, squares[k] += effect * effect / count;
            }
        }
    for (std::size_t k = 0; k < keys; ++k) all[k].total = std::sqrt(std::max(0.0, squares[k] - sum[k] * sum[k]));
    return all;
}

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

std::vector<Sensitivity> sensitivities(Method method, const Design& design,
                                       const std::vector<std::optional<double>>& outcomes) {
    expect(outcomes.size() == design.points.size(), "an outcome for each sample");
    if (design.points.empty()) return {};
    const std::size_t keys = design.points.front().size();
    std::vector<std::size_t> starts;
    const auto groups =
        whole_groups(static_cast<std::size_t>(runs_each(method, static_cast<Index>(keys))), outcomes, starts);
    if (groups.size() < 2) return {};
    return method == Method::saltelli ? by_sobol(groups, keys) : by_morris(groups, starts, design, keys);
}

}  // namespace frana
