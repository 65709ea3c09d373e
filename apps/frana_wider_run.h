#pragma once
// The rasters of a finished run, brought to a survey that reaches beyond them.
#include <string>
#include <vector>

#include "run/folder/run_figures.h"
#include "scene/survey_files.h"

namespace frana {

/// Rasters of a large terrain end near the flow. Where the survey reaches beyond them, those that a comparison needs go on
/// without flow: over all of a terrain of some million nodes, otherwise to the survey. The elevations are those of the case's
/// model. Where that has gone, or has changed, all stays as it was, and `said` tells.
void widen_to_survey(FigureSource& source, const SurveyFiles& files, std::vector<std::string>& said);

}  // namespace frana
