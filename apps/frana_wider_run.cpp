#include "frana_wider_run.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "frana_figures.h"
#include "io/gdal_reader.h"
#include "terrain/part_of.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

void take(const Polygons& polygons, std::vector<Vec2>& points) {
    for (const Polygon& polygon : polygons.parts)
        for (const auto& ring : polygon.rings) points.insert(points.end(), ring.begin(), ring.end());
}

/// Corners of the box around what changed.
void take_changed(const Raster& change, double noise, std::vector<Vec2>& points) {
    const GridGeometry& g = change.geometry;
    NodeBox box;
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i)
            if (std::abs(change.at(i, j)) > noise) box = united(box, {i, j, 1, 1});
    if (box.nx == 0) return;
    points.emplace_back(g.x(box.i0), g.y(box.j0));
    points.emplace_back(g.x(box.i0 + box.nx - 1), g.y(box.j0 + box.ny - 1));
}

/// Where the survey is. What cannot be read is left out: it is told when it is read for good.
std::vector<Vec2> places_of(const SurveyFiles& files, const Raster& like) {
    constexpr double kFar = 1e9;  // m: no map is so large
    const GdalReader reader;
    std::vector<Vec2> points;
    std::vector<std::string> said_later;
    const auto attempt = [&](const fs::path& file, const auto& read) {
        if (file.empty()) return;
        try {
            read();
        } catch (const UserError&) {
        }
    };
    attempt(files.footprint, [&] {
        take(reader.read_survey(files.footprint, {-kFar, -kFar, kFar, kFar}, like.crs_wkt, said_later), points);
    });
    attempt(files.path, [&] {
        for (const Polyline& line : reader.read_lines(files.path, like.crs_wkt, said_later))
            points.insert(points.end(), line.begin(), line.end());
    });
    attempt(files.bed_change, [&] {
        take_changed(reader.read_deposit(files.bed_change, like.geometry, like.crs_wkt, said_later),
                     files.bed_change_noise, points);
    });
    return points;
}

/// The bed as the run has it in its files. Nothing: it left none.
std::optional<Raster> bed_in_files(const FigureSource& source) {
    const fs::path file = source.run_dir / "rasters" / "elevation.tif";
    constexpr double kFar = 1e300;
    std::vector<std::string> said_by_the_run;
    if (fs::exists(file)) return GdalReader().read_raster(file, {-kFar, -kFar, kFar, kFar}, "", said_by_the_run);
    if (fs::exists(source.run_dir / "terrain.vti")) return source.bed;
    return {};
}

/// Along the edge of the run's rasters, where a step would be. Within them releases and barriers may have changed it.
bool goes_on(const Raster& wide, const Raster& run, const NodeBox& at) {
    constexpr double round_off = 2.0 * std::numeric_limits<float>::epsilon();  // files hold floats
    for (Index j = 0; j < at.ny; ++j)
        for (Index i = 0; i < at.nx; ++i) {
            if (i > 0 && j > 0 && i < at.nx - 1 && j < at.ny - 1) continue;
            const double ours = run.at(i, j), theirs = wide.at(at.i0 + i, at.j0 + j);
            if (std::isnan(ours) != std::isnan(theirs)) return false;
            if (std::abs(ours - theirs) > round_off * std::max(1.0, std::abs(ours))) return false;
        }
    return true;
}

/// On the nodes of `wide`, which has those of the raster at `at`. `beyond` them, where there is terrain.
Raster spread(const Raster& raster, const Raster& wide, const NodeBox& at, double beyond) {
    const GridGeometry& g = wide.geometry;
    Raster all = part_of(raster, {-at.i0, -at.j0, g.nx, g.ny});
    all.geometry = g;
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) {
            const bool inside = i >= at.i0 && j >= at.j0 && i < at.i0 + at.nx && j < at.j0 + at.ny;
            if (!inside && !std::isnan(wide.at(i, j))) all.at(i, j) = beyond;
        }
    return all;
}

/// Those that scores and pictures of a comparison are made of. Others are dropped: they may be many, and large.
void spread_all(FigureSource& source, const Raster& wide, const NodeBox& at) {
    std::vector<ProductRaster> kept;
    for (const char* name : {"peak_depth", "final_depth", "final_water_depth", "deposited_depth", "lying_depth",
                             "bed_change", "arrival_time"})
        if (const ProductRaster* product = find_product(source.rasters, name)) {
            kept.push_back(*product);
            const double beyond = name == std::string("arrival_time") ? Raster::nodata : 0.0;
            kept.back().raster = spread(product->raster, wide, at, beyond);
        }
    source.rasters = std::move(kept);
    Raster bed = wide;
    bed.crs_wkt = source.rasters.front().raster.crs_wkt;
    const GridGeometry& own = source.bed.geometry;
    for (Index j = 0; j < own.ny && !source.bed.values.empty(); ++j)
        for (Index i = 0; i < own.nx; ++i) bed.at(at.i0 + i, at.j0 + j) = source.bed.at(i, j);
    source.bed = std::move(bed);
}

std::string box_text(const GridGeometry& grid) {
    const auto e = grid.pixel_extent();
    return fmt::format("x {:.10g} to {:.10g}, y {:.10g} to {:.10g}", e[0], e[2], e[1], e[3]);
}

}  // namespace

void widen_to_survey(FigureSource& source, const SurveyFiles& files, std::vector<std::string>& said) {
    const ProductRaster* peak = find_product(source.rasters, "peak_depth");
    if (peak == nullptr || !fs::exists(source.run_dir / "resolved.toml")) return;
    const Raster like = peak->raster;
    const GridGeometry& shown = like.geometry;
    const std::vector<Vec2> places = places_of(files, like);
    if (const NodeBox own = NodeBox::all(shown); united(own, cells_of(places, shown)) == own) return;
    const auto tell = [&](const std::string& why) {
        said.push_back(
            fmt::format("{}; expected the elevation model that the run had, since the survey reaches beyond the run's "
                        "rasters ({}); what lies beyond them counts as outside of the run's terrain",
                        why, box_text(shown)));
    };
    const CaseFile run_case = case_of_run(source.run_dir);
    const std::string dem = run_case.path("terrain.dem").string();
    const std::string changed = fmt::format("{}: found other elevations than those of the run", dem);
    try {
        NodeBox at;
        bool wider = true;
        const Raster wide = dem_of_case(run_case, [&](const Raster& whole) {
            const NodeBox all = NodeBox::all(whole.geometry);
            const auto run = box_of(shown, whole.geometry);
            if (!run || !(common(*run, all) == *run)) throw UserError(changed);
            constexpr Index kAll = 4'000'000;  // nodes: some 200 MB of rasters
            const NodeBox near = common(united(*run, cells_of(places, whole.geometry)), all);
            const NodeBox wanted = !(near == *run) && whole.geometry.size() <= kAll ? all : near;  // paths go on there
            wider = !(wanted == *run);
            at = {run->i0 - wanted.i0, run->j0 - wanted.j0, run->nx, run->ny};
            return wanted;
        });
        if (!wider) return;
        const std::optional<Raster> own = bed_in_files(source);
        if (own && own->geometry == shown && !goes_on(wide, *own, at)) return tell(changed);
        spread_all(source, wide, at);
    } catch (const UserError& error) {
        tell(error.what());
    }
}

}  // namespace frana
