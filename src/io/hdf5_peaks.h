#pragma once
// What an ensemble stores of its runs, many runs in a file.
#include <filesystem>
#include <string>
#include <vector>

#include "terrain/sparse_rasters.h"

namespace frana {

/// Peaks of some samples. All have the fields, in this order.
struct PeakBlock {
    GridGeometry grid;
    std::vector<std::string> fields;
    std::vector<Index> samples;        ///< their numbers
    std::vector<SparseRasters> peaks;  ///< as many
};

/// HDF5, compressed. Each sample has sample, rows and pixels. Each row has first and count. Each pixel has one of each
/// field. Appears whole or not at all. Throws UserError.
void write_peaks(const std::filesystem::path& file, const PeakBlock& block);

/// Only the fields that are `wanted` have values, those of the others stay empty. Throws UserError for a file that is none of
/// those.
PeakBlock read_peaks(const std::filesystem::path& file, const std::vector<std::string>& wanted);

}  // namespace frana
