#pragma once
// Where in the unit cube the samples of an ensemble lie. Sample i depends on the seed and on i alone; with "lhs" also on
// how many there are. So any part of an ensemble can be run anywhere.
#include <cstdint>
#include <vector>

#include "base/types.h"

namespace frana {

/// saltelli and morris: ensemble/sensitivity.h; table: ensemble/sample_table.h.
enum class Method { lhs, sobol, random, grid, saltelli, morris, table };

struct Design {
    std::vector<std::vector<double>> points;  ///< by sample, then by key; within (0, 1)
};

/// `count` samples of so many keys. lhs: each of `count` slices of each key is hit once (McKay et al. 1979). sobol: Sobol's
/// sequence (1967), shifted by the seed; more samples leave those that are there. random: independent. Throws UserError when
/// there are more keys than Sobol's sequence is known for.
Design make_design(Method method, Index count, Index keys, std::uint64_t seed);

/// All combinations of `levels` slices of each key, at their middles; the last key changes fastest.
Design make_grid(const std::vector<Index>& levels);

/// 64 random bits of a place (SplitMix64, Steele et al. 2014). They are the same on any machine, and need no earlier
/// samples.
std::uint64_t bits_at(std::uint64_t seed, std::uint64_t sample, std::uint64_t key);
/// From them a number within (0, 1).
double unit_at(std::uint64_t seed, std::uint64_t sample, std::uint64_t key);

}  // namespace frana
