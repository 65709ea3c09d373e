#pragma once
// Results of verification as text: the table for people and for diffs, and JSON.
#include <string>
#include <vector>

#include "checks/verify/problem.h"

namespace frana::verify {

/// Column titles of table_row().
std::string table_head();
/// One line; with_time: also the wall time, which no two runs share.
std::string table_row(const Measurement& m, bool with_time);
/// Lines by which two tables differ. Numbers differ by more than `tolerance` of the larger one, both above 1e-10; or
/// anything else differs. Lines that begin with # do not count.
std::vector<std::string> differences(const std::string& table, const std::string& reference, double tolerance);
/// A list of objects with the keys of the interface: name, preset, cells, particles, steps, wall_seconds, l1_depth, ...
/// A quantity that a problem does not have is null.
std::string json_of(const std::vector<Measurement>& measurements);

}  // namespace frana::verify
