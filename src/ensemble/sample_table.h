#pragma once
// Samples that a table lists: a column for each key, and a weight where there is one.
#include "ensemble/plan.h"
#include "scene/problems.h"

namespace frana {

/// What stands between the commas of a line, without blanks around it; quotes have no meaning.
std::vector<std::string> comma_fields(const std::string& line);

/// The same where a field that begins with a quote ends with one: commas within are its own, and two quotes are one.
std::vector<std::string> quoted_fields(const std::string& line);

/// Reads a table with commas into the plan's keys and points. Its first line names keys of a case and perhaps "weight". A
/// column "sample", as frana's own tables have it, counts for nothing.
/// Weights are scaled so that their sum is the number of samples.
void read_sample_table(const std::filesystem::path& file, EnsemblePlan& plan, Problems& problems);

}  // namespace frana
