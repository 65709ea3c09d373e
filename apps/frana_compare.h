#pragma once
#include <string>
#include <vector>

#include "frana_commands.h"
#include "frana_figures.h"
#include "run/folder/comparison.h"

namespace frana {

/// A finished run held against a survey; writes nothing. The run has the survey's footprint and the path of the runout.
/// What reading the survey's files said is among the warnings, and among the comparison's remarks.
struct RunAndSurvey {
    FigureSource run;
    Comparison comparison;
    std::vector<std::string> warnings;
};

/// UserError when the folder holds no finished run with rasters, or a file of the survey cannot be used.
RunAndSurvey read_run_and_survey(const CompareOptions& options);

}  // namespace frana
