#include "ensemble/design.h"

#include <fmt/format.h>

#include <boost/random/sobol.hpp>
#include <numeric>

#include "base/error.h"

namespace frana {
namespace {

constexpr Index kSobolKeys = 3667;  ///< of Joe and Kuo's table, as Boost has it

std::uint64_t mixed(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/// The middle of one of 2^52 slices of (0, 1).
double unit(std::uint64_t bits) { return (static_cast<double>(bits >> 12) + 0.5) * 0x1p-52; }

void fill_lhs(Design& design, Index count, Index keys, std::uint64_t seed) {
    std::vector<Index> slice(static_cast<std::size_t>(count));
    for (Index key = 0; key < keys; ++key) {
        std::iota(slice.begin(), slice.end(), Index{0});
        const std::uint64_t deal = bits_at(seed, ~std::uint64_t{0}, static_cast<std::uint64_t>(key));
        for (Index k = count - 1; k > 0; --k) {  // Fisher and Yates
            const std::uint64_t pick = bits_at(deal, static_cast<std::uint64_t>(k), 0);
            std::swap(slice[static_cast<std::size_t>(k)],
                      slice[static_cast<std::size_t>(pick % static_cast<std::uint64_t>(k + 1))]);
        }
        for (Index i = 0; i < count; ++i)
            design.points[static_cast<std::size_t>(i)].push_back(
                (static_cast<double>(slice[static_cast<std::size_t>(i)]) +
                 unit_at(seed, static_cast<std::uint64_t>(i), static_cast<std::uint64_t>(key))) /
                static_cast<double>(count));
    }
}

void fill_sobol(Design& design, Index keys, std::uint64_t seed) {
    boost::random::sobol sequence(static_cast<std::size_t>(keys));
    std::vector<std::uint64_t> shift;
    for (Index key = 0; key < keys; ++key)
        shift.push_back(bits_at(seed, ~std::uint64_t{1}, static_cast<std::uint64_t>(key)));
    bool first = true;
    for (auto& point : design.points) {  // Boost leaves out the sequence's first point, which is 0
        for (const std::uint64_t by : shift) point.push_back(unit((first ? 0 : sequence()) ^ by));
        first = false;
    }
}

}  // namespace

std::uint64_t bits_at(std::uint64_t seed, std::uint64_t sample, std::uint64_t key) {
    constexpr std::uint64_t golden = 0x9e3779b97f4a7c15u;
    return mixed(mixed(mixed(seed + golden) + sample * golden + golden) + key * golden + golden);
}

double unit_at(std::uint64_t seed, std::uint64_t sample, std::uint64_t key) { return unit(bits_at(seed, sample, key)); }

Design make_design(Method method, Index count, Index keys, std::uint64_t seed) {
    expect(method == Method::lhs || method == Method::sobol || method == Method::random, "a plain design");
    Design design;
    design.points.resize(static_cast<std::size_t>(count));
    if (method == Method::sobol && keys > kSobolKeys)
        throw UserError(fmt::format("ensemble.method: found \"sobol\" with {} keys; expected at most {}; use \"lhs\"",
                                    keys, kSobolKeys));
    if (method == Method::lhs) fill_lhs(design, count, keys, seed);
    if (method == Method::sobol) fill_sobol(design, keys, seed);
    if (method == Method::random)
        for (Index i = 0; i < count; ++i)
            for (Index key = 0; key < keys; ++key)
                design.points[static_cast<std::size_t>(i)].push_back(
                    unit_at(seed, static_cast<std::uint64_t>(i), static_cast<std::uint64_t>(key)));
    return design;
}

Design make_grid(const std::vector<Index>& levels) {
    Design design;
    design.points.emplace_back();
    for (const Index count : levels) {
        std::vector<std::vector<double>> longer;
        for (const auto& point : design.points)
            for (Index k = 0; k < count; ++k) {
                longer.push_back(point);
                longer.back().push_back((static_cast<double>(k) + 0.5) / static_cast<double>(count));
            }
        design.points = std::move(longer);
    }
    return design;
}

}  // namespace frana
