#pragma once
// Where points may stand: lattices in and out of phase with the grid, jittered, or quasi-random.
#include <cstdint>

#include "checks/verify/problem.h"

namespace frana::verify {

enum class Placement {
    aligned,      ///< lattice that fits the grid
    shifted,      ///< the same, moved by 0.13 cells in x and 0.29 in y
    r2,           ///< quasi-random (Roberts 2018), equal patches
    half_jitter,  ///< aligned, each point moved at random by up to a quarter of the spacing each way
    full_jitter   ///< by up to half the spacing: anywhere in its own square
};
constexpr Placement kPlacements[] = {Placement::aligned, Placement::shifted, Placement::r2, Placement::half_jitter,
                                     Placement::full_jitter};
const char* name_of(Placement placement);

/// Numbers in [-1, 1) from a counter by the finaliser of SplitMix64 (Steele, Lea, Flood 2014); always the same ones.
class Noise {
public:
    double next();

private:
    std::uint64_t state_ = 0;
};

/// Fills the grid with about per_side^2 points a cell wherever the depth is positive. Each has the depth at its own
/// place and the volume depth * patch area. Same arguments, same bits.
void place(Scene& scene, const Function& depth, Placement placement, int per_side);

}  // namespace frana::verify
