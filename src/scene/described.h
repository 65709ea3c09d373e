#pragma once
#include <string>
#include <vector>

namespace frana {

struct Parameter;

/// The key, every key of a table or every key that begins with `prefix`; empty: all. Throws UserError with the closest
/// key when nothing matches.
std::vector<const Parameter*> described(const std::string& prefix);

}  // namespace frana
