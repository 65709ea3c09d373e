#pragma once
// All numbers of free water, to compare bit by bit.
#include <vector>

#include "water/water_flow.h"

/// Depth and velocity of each cell, south row first.
inline std::vector<double> bits_of(const frana::WaterFlow& flow) {
    std::vector<double> bits;
    const frana::TileGrid& grid = flow.body().grid;
    for (frana::Index j = 0; j < grid.ny(); ++j)
        for (frana::Index i = 0; i < grid.nx(); ++i) {
            const frana::WaterState s = flow.at(i, j);
            for (const double number : {s.depth, s.u, s.v}) bits.push_back(number);
        }
    return bits;
}
