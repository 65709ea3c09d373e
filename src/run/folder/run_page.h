#pragma once
// figures/view.html, the page of a run (run/web/web_page.h), from the run's data and files.
#include <string>
#include <vector>

#include "run/folder/run_figures.h"
#include "run/web/flow_frames.h"

namespace frana {

/// Whether a case has the page: format "web".
bool asks_for_page(const CaseFile& file);

/// Refuses a case with that format in a build that cannot make it. UserError.
void check_page(const CaseFile& file);

/// Depth and speed of the frames that the run wrote for ParaView; none without them.
FlowFrames frames_of_run(const FigureSource& source);

/// The page. `record` is the text of run.json. The frames have to stay until it is drawn, as the source does.
void add_page(const FigureSource& source, const FlowFrames& frames, const std::string& record, Gallery& gallery);

}  // namespace frana
