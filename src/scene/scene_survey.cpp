// [survey] of a case. Its files are tried before the run, since a comparison that fails after it is of no use.
#include "scene/scene_parts.h"
#include "scene/survey_files.h"

namespace frana {
namespace {

/// What the footprint's scores stand besides.
void require_footprint(const CaseFile& file, Problems& problems) {
    if (file.given("survey.footprint")) return;
    for (const char* key : {"survey.deposit", "survey.path", "survey.bed_change"})
        if (file.given(key))
            problems.add(file.place(key), "found without survey.footprint", "expected the surveyed extent as well",
                         "add footprint = ... under [survey]");
}

}  // namespace

void read_survey(const CaseFile& file, const GisReader& reader, Scene& scene, Problems& problems) {
    const SurveyFiles files = survey_files(file);
    const GridGeometry& grid = scene.bed.geometry;
    const GridGeometry& terrain = scene.wider ? scene.wider->grid : grid;
    const std::string& crs = scene.bed.crs_wkt;
    std::vector<std::string> said_again_by_the_comparison;
    const auto attempt = [&](const char* key, const std::filesystem::path& path, const auto& read) {
        if (!path.empty()) problems.attempt(file.place(key), read);
    };
    require_footprint(file, problems);
    scene.footprint = files.footprint;
    attempt("survey.footprint", files.footprint,
            [&] { scene.survey = reader.read_survey(files.footprint, terrain.pixel_extent(), crs, scene.log); });
    attempt("survey.path", files.path,
            [&] { read_survey_path(reader, files.path, terrain.pixel_extent(), crs, said_again_by_the_comparison); });
    attempt("survey.deposit", files.deposit,
            [&] { read_survey_deposit(reader, files.deposit, grid, crs, said_again_by_the_comparison); });
    attempt("survey.bed_change", files.bed_change, [&] {
        // Of a terrain that grows with the flow, where the run will be is not known yet.
        if (scene.wider)
            reader.read_deposit(files.bed_change, grid, crs, said_again_by_the_comparison);
        else
            read_bed_change(reader, files.bed_change, grid, crs, said_again_by_the_comparison);
    });
}

}  // namespace frana
