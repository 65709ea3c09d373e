// Elevation models: window, spacing, units.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "base/error.h"
#include "base/pattern.h"
#include "io/band_words.h"
#include "io/gdal_crs.h"
#include "io/gdal_onto.h"
#include "io/gdal_reader.h"
#include "scene/remarks.h"

namespace frana {
namespace {

using gdal::extent_text;
using gdal::RasterFile;

constexpr double round_off = 1e-6;  // of a pixel or cell
constexpr double same_cell = 1e-9;  // relative; closer spacings are the same spacing
constexpr double most_nodes = 5e8;  // 4 GB for the elevations alone

/// The requested window, or the whole raster; UserError when it is not inside.
std::array<double, 4> checked_window(const RasterFile& raster, const DemRequest& request) {
    const std::array<double, 4> all = raster.extent();
    if (!request.window) return all;
    const std::array<double, 4>& w = *request.window;
    const double slack_x = round_off * raster.x_axis().size, slack_y = round_off * raster.y_axis().size;
    const bool inside =
        w[0] >= all[0] - slack_x && w[1] >= all[1] - slack_y && w[2] <= all[2] + slack_x && w[3] <= all[3] + slack_y;
    if (!(w[0] < w[2] && w[1] < w[3]) || !inside)
        throw UserError(
            fmt::format("{}: the window {} is not inside the raster, which covers {}; expected [xmin, "
                        "ymin, xmax, ymax] in the raster's map coordinates and inside it; move or shrink "
                        "the window",
                        raster.file().string(), extent_text(w), extent_text(all)));
    return w;
}

void check_size(const RasterFile& raster, double nx, double ny) {
    if (nx * ny <= most_nodes) return;
    throw UserError(
        fmt::format("{}: {:.0f} x {:.0f} nodes are more than the {:g} that a run can hold; choose a "
                    "smaller window or a larger cell",
                    raster.file().string(), nx, ny, most_nodes));
}

/// The nodes of a grid for the request.
NodeBox chosen(const DemRequest& request, const RasterFile& raster, const GridGeometry& grid) {
    if (!request.choose) return NodeBox::all(grid);
    return request.choose(Raster{grid, {}, gdal::horizontal_wkt(raster.crs()), raster.file().string()});
}

/// The pixels that the window touches, as they are.
Raster copied(const RasterFile& raster, const std::array<double, 4>& window, const DemRequest& request,
              std::vector<std::string>& log) {
    const auto [i, nx] = gdal::touched(raster.x_axis(), window[0], window[2]);
    const auto [j, ny] = gdal::touched(raster.y_axis(), window[1], window[3]);
    check_size(raster, double(nx), double(ny));
    const NodeBox part = chosen(request, raster, raster.pixels(i, j, nx, ny));
    Raster dem = raster.read_raster(i + part.i0, j + part.j0, part.nx, part.ny);
    const auto extent = raster.pixels(i, j, nx, ny).pixel_extent();
    double moved = 0.0;
    for (std::size_t k = 0; k < 4; ++k) moved = std::max(moved, std::abs(extent[k] - window[k]));
    if (request.window && moved > 2.0 * round_off * dem.geometry.cell)
        log.push_back(fmt::format("{}: window widened to whole pixels: {}", raster.name(), extent_text(extent)));
    return dem;
}

/// Cells counted from the window's south-west corner.
Raster resampled(const RasterFile& raster, const std::array<double, 4>& window, double cell, const DemRequest& request,
                 std::vector<std::string>& log) {
    const double width = window[2] - window[0], height = window[3] - window[1];
    const double nx = std::floor(width / cell + round_off), ny = std::floor(height / cell + round_off);
    if (nx < 1.0 || ny < 1.0)
        throw UserError(fmt::format("{}: the window {} is smaller than one cell of {:g} m; choose a smaller cell",
                                    raster.file().string(), extent_text(window), cell));
    check_size(raster, nx, ny);
    Raster dem;
    dem.geometry = {Index(nx), Index(ny), window[0] + 0.5 * cell, window[1] + 0.5 * cell, cell};
    dem.geometry = chosen(request, raster, dem.geometry).of(dem.geometry);
    dem.values = gdal::onto_grid(raster, dem.geometry);
    dem.crs_wkt = gdal::horizontal_wkt(raster.crs());
    dem.source = raster.file().string();
    log.push_back(raster.name() + ": " + gdal::how_resampled(raster, cell));
    const double east = width - nx * cell, north = height - ny * cell;
    if (std::max(east, north) > 2.0 * round_off * cell)
        log.push_back(fmt::format("{}: whole cells leave out {:.6g} m in the east and {:.6g} m in the north",
                                  raster.name(), std::max(0.0, east), std::max(0.0, north)));
    return dem;
}

/// Heights in feet that the file only speaks of: no unit of the band and no vertical CRS says so.
void remark_named_feet(const RasterFile& raster, std::vector<std::string>& log) {
    if (!raster.unit().empty()) return;
    static const Pattern feet("\\b(feet|foot|ft|ftUS)\\b", Pattern::Case::ignored);
    std::istringstream lines(raster.description());
    for (std::string line; std::getline(lines, line);)
        if (feet.is_in(line)) return remark_on(log, Remark::named_feet, raster.name(), {NAN, 0.0, line});
}

}  // namespace

Raster GdalReader::read_dem(const std::filesystem::path& file, const DemRequest& request,
                            std::vector<std::string>& log) const {
    const RasterFile raster(file, gdal::Meaning::elevation, log);
    const auto used = request.window.value_or(raster.extent());
    gdal::Place place{
        file, &raster.crs(), {0.5 * (used[0] + used[2]), 0.5 * (used[1] + used[3])}, raster.unit(), raster.scaled()};
    gdal::require_metres(place, log);
    remark_named_feet(raster, log);
    if (raster.has_palette())
        log.push_back(raster.name() + ": has a palette, its numbers are used; is this a picture rather than a field?");
    const auto window = checked_window(raster, request);
    const double pixel = std::min(raster.x_axis().size, raster.y_axis().size);
    const double cell = request.cell.value_or(pixel);
    if (!(cell > 0.0) || !std::isfinite(cell))
        throw UserError(fmt::format("{}: a cell of {:g} m; expected a positive length", file.string(), cell));
    const bool as_is = raster.square() && (!request.cell || std::abs(cell - raster.x_axis().size) <= same_cell * cell);
    Raster dem = as_is ? copied(raster, window, request, log) : resampled(raster, window, cell, request, log);
    if (std::all_of(dem.values.begin(), dem.values.end(), [](double z) { return std::isnan(z); }))
        throw UserError(fmt::format("{}: holds no data in {}; expected elevations there; move the window",
                                    file.string(), extent_text(window)));
    return dem;
}

std::function<Raster(const NodeBox&)> GdalReader::read_dem_later(const std::filesystem::path& file,
                                                                 const DemRequest& request) const {
    return [file, request](const NodeBox& box) {
        DemRequest part = request;
        part.choose = [&box](const Raster&) { return box; };
        std::vector<std::string> said_before;
        return GdalReader().read_dem(file, part, said_before);
    };
}

std::string crs_of_raster(const std::filesystem::path& file) {
    std::vector<std::string> log;
    return gdal::horizontal_wkt(RasterFile(file, gdal::Meaning::any, log).crs());
}

std::pair<std::string, std::string> band_words(const std::filesystem::path& file) {
    std::vector<std::string> log;
    const RasterFile raster(file, gdal::Meaning::any, log);
    const std::string words = raster.description();  // of the file follow on lines of their own
    return {raster.unit(), words.substr(0, words.find('\n'))};
}

}  // namespace frana
