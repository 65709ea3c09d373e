#pragma once
// What a calibration's weighted points tell of its keys, one by one and in pairs.
#include <optional>
#include <string>
#include <vector>

#include "frana_calibrate.h"

namespace frana {

/// Values of a key at all points.
std::vector<double> values_of(const Calibration& c, std::size_t key);

/// Two keys, and how far they go together in the posterior.
struct KeyPair {
    std::string first, second;
    std::optional<double> correlation;
};

std::vector<KeyPair> pairs_of(const Calibration& c);

/// How much more likely a value is than before the survey [1]. It is given by bins of its place in the prior, each with
/// as much of that.
std::vector<double> density_of(const Calibration& c, std::size_t key);

/// Is compared by blocks, some of which may have no survey.
inline bool is_raster(Evidence evidence) { return evidence == Evidence::deposit || evidence == Evidence::bed_change; }

}  // namespace frana
