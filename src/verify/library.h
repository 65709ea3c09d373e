#pragma once
// The canon: every verification problem that frana knows.
#include "verify/problem.h"

namespace frana::verify {

/// All problems, in the order of the table.
const std::vector<Problem>& library();
/// The problem of that name, or nullptr.
const Problem* find_problem(const std::string& name);

// The rooms of the library, one file each.
std::vector<Problem> dam_break_problems();  // problems_dam_break.cpp

}  // namespace frana::verify
