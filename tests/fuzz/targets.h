#pragma once
// What fuzzers feed: each function reads bytes as the program would read a file with them. A UserError of one-line
// sentences is a fair answer; any other exception leaves the function, and a fuzzer takes it for a crash.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>

namespace frana::fuzz {

using Input = std::string;  ///< bytes

/// A case file: from text to a whole scene on a small terrain that exists in memory only, and back to resolved text.
void case_file(const Input& bytes);
/// A raster, GeoTIFF or a grid as text: as terrain, depth, mask, survey and deposit.
void raster(const Input& bytes);
/// A vector file: as outline, path and survey, with and without a coordinate system of the terrain.
void vector(const Input& bytes);
/// A kept state, as it is; and with the length and checksum of its head put right, which keep damage out otherwise.
void checkpoint(const Input& bytes);
/// Writes a small state, the seed of `checkpoint`.
void make_checkpoint(const std::string& file);
/// A table that a run left.
void table(const Input& bytes);

inline const std::map<std::string, std::function<void(const Input&)>>& targets() {
    static const std::map<std::string, std::function<void(const Input&)>> all{
        {"case_file", case_file}, {"raster", raster}, {"vector", vector}, {"checkpoint", checkpoint}, {"table", table}};
    return all;
}

}  // namespace frana::fuzz
