#pragma once
// What each part of the scheme is worth: chosen problems with one component changed at a time.
#include <string>
#include <vector>

#include "checks/verify/problem.h"

namespace frana::verify {

/// A change of the default scheme.
struct Component {
    std::string name;
    std::function<void(Scene&)> edit;
    int per_side = 2;
};
const std::vector<Component>& components();

/// A number of a problem that the study reads.
struct StudyColumn {
    std::string problem;
    Index cells;
    std::string quantity;
    std::string head;
};
const std::vector<StudyColumn>& study_columns();

/// One line of the study's table: every column's number under this component; "failed" where the run breaks down.
std::string study_row(const Component& component);
std::string study_head();

}  // namespace frana::verify
