// The keys of [survey]: what a run is compared with.
#include "scene/parameter_makers.h"

namespace frana {

void add_survey(Table& table) {
    using namespace rows;
    table.push_back(absent(make("survey.footprint", Kind::path, "",
                                "surveyed extent that the run is compared with: any OGR vector file of polygons, or a "
                                "raster that is above 0 there"),
                           "no survey"));
    table.push_back(absent(
        make("survey.deposit", Kind::path, "", "raster of the surveyed deposit's thickness, m; besides the footprint"),
        "deposits are not compared"));
    table.push_back(absent(make("survey.path", Kind::path, "",
                                "line along which runouts and changes of the bed are measured; besides the footprint"),
                           "the steepest path from the release or inflow"));
    table.push_back(absent(make("survey.bed_change", Kind::path, "",
                                "raster of the difference of two surveys, after minus before, m; besides "
                                "the footprint"),
                           "changes of the bed are not compared"));
    table.push_back(number("survey.bed_change_noise", "m", not_negative, 0.1,
                           "change that is within the noise of both surveys and counts as none"));
}

}  // namespace frana
