#include "scene/survey_files.h"

#include <fmt/format.h>

#include <cmath>

#include "scene/scene_parts.h"
#include "terrain/places.h"

namespace frana {
namespace {

/// Whether any node of `grid` has a value in a raster on the same pixels. The raster may have more or fewer of them.
bool known_on(const Raster& raster, const GridGeometry& grid) {
    const GridGeometry& g = raster.geometry;
    const NodeAt first = first_node(grid, g);
    for (Index j = 0; j < grid.ny; ++j)
        for (Index i = 0; i < grid.nx; ++i) {
            const NodeAt node{i + first.i, j + first.j};
            if (has_node(g, node) && std::isfinite(raster.at(node.i, node.j))) return true;
        }
    return false;
}

/// What a raster should hold, for people.
struct Wanted {
    const char *name, *meaning, *way_out;
};

/// Elevations that were taken for changes or depths are nearly everywhere large, those hardly anywhere.
void refuse_elevations(const Raster& change, const Wanted& wanted, std::vector<std::string>& log) {
    constexpr double kLarge = 100.0;  // [m]; few rock avalanches left or took more
    Index known = 0, large = 0;
    double most = 0.0;
    for (const double value : change.values) {
        if (!std::isfinite(value)) continue;
        ++known;
        large += std::abs(value) > kLarge;
        most = std::fmax(most, std::abs(value));
    }
    if (large == 0) return;
    const std::string found =
        fmt::format("{}: found {} of up to {:.4g} m, on {:.3g} % of the pixels more than {:g} m", change.source,
                    wanted.name, most, 100.0 * double(large) / double(known), kLarge);
    const std::string expected = fmt::format("expected {}, not elevations", wanted.meaning);
    if (2 * large > known) throw UserError(fmt::format("{}; {}; {}", found, expected, wanted.way_out));
    log.push_back(fmt::format("{}; {}; check the raster", found, expected));
}

}  // namespace

SurveyFiles survey_files(const CaseFile& file) {
    SurveyFiles files;
    const auto path = [&](const char* key) { return file.given(key) ? file.path(key) : std::filesystem::path(); };
    files.footprint = path("survey.footprint");
    files.deposit = path("survey.deposit");
    files.path = path("survey.path");
    files.bed_change = path("survey.bed_change");
    files.bed_change_noise = file.number("survey.bed_change_noise");
    return files;
}

Polyline read_survey_path(const GisReader& reader, const std::filesystem::path& file,
                          const std::array<double, 4>& extent, const std::string& crs_wkt,
                          std::vector<std::string>& log) {
    const std::vector<Polyline> lines = reader.read_lines(file, crs_wkt, log);
    if (lines.size() != 1)
        throw UserError(
            fmt::format("{}: holds {} lines; expected one, the path from the release to the toe; export "
                        "that one alone",
                        file.string(), lines.size()));
    double length = 0.0;
    for (std::size_t k = 0; k + 1 < lines[0].size(); ++k) length += (lines[0][k + 1] - lines[0][k]).norm();
    if (!(length > 0.0))
        throw UserError(
            fmt::format("{}: its line has no length; expected the path from the release to the toe; draw "
                        "it again",
                        file.string()));
    if (!comes_onto(lines.front(), extent))
        throw UserError(
            fmt::format("{}: found no point of its line on the terrain; expected the path within x {:.10g} to {:.10g}, "
                        "y {:.10g} to {:.10g}; check its coordinates and its CRS",
                        file.string(), extent[0], extent[2], extent[1], extent[3]));
    return lines.front();
}

Raster read_survey_deposit(const GisReader& reader, const std::filesystem::path& file, const GridGeometry& grid,
                           const std::string& crs_wkt, std::vector<std::string>& log) {
    Raster deposit = reader.read_deposit(file, grid, crs_wkt, log);
    deposit.source = file.string();
    refuse_elevations(
        deposit, {"thicknesses", "the thickness of the deposit", "subtract the ground below it (gdal_calc.py)"}, log);
    return deposit;
}

Raster read_bed_change(const GisReader& reader, const std::filesystem::path& file, const GridGeometry& grid,
                       const std::string& crs_wkt, std::vector<std::string>& log) {
    Raster change = reader.read_deposit(file, grid, crs_wkt, log);
    change.source = file.string();
    refuse_elevations(
        change,
        {"changes", "the elevations after the event less those before it", "subtract them first (gdal_calc.py)"}, log);
    if (known_on(change, grid)) return change;
    const auto e = grid.pixel_extent();
    throw UserError(fmt::format(
        "{}: has no value within x {:.10g} to {:.10g}, y {:.10g} to {:.10g}, where the run is; expected the "
        "difference of two surveys of this place; check its coordinates and its CRS",
        file.string(), e[0], e[2], e[1], e[3]));
}

}  // namespace frana
