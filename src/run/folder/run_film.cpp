#include "run/folder/run_film.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "run/folder/barrier_plans.h"
#include "run/folder/cutoff.h"
#include "terrain/part_of.h"
#include "vtk_io/figures/film.h"
#include "vtk_io/figures/filmstrip.h"
#include "vtk_io/figures/shared_view.h"
#include "vtk_io/reader.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

/// Up to `most` of `count` frames, evenly spread, the first and the last among them.
std::vector<Index> spread_frames(Index count, Index most) {
    std::vector<Index> chosen;
    const Index n = std::min(count, most);
    for (Index k = 0; k < n; ++k) chosen.push_back(n == 1 ? 0 : k * (count - 1) / (n - 1));
    return chosen;
}

/// The depth of an output with the survey, without a title. What has become bed counts. Frames may show a smaller part
/// of the terrain than the last one. UserError when the frame has none on the terrain's nodes.
MapFigure depth_map(const FigureSource& source, Index number) {
    LoadedFrame frame = read_frame(source.run_dir, number, {"depth", "deposited_depth"});
    const auto box = box_of(source.bed.geometry, frame.grid);
    if (!frame.has("depth") || !box) throw UserError("the frames hold no depth on the terrain's nodes");
    add_deposit(frame);
    MapFigure map;
    map.bed = source.bed;
    map.field = part_of(Raster{frame.grid, std::move(frame.nodes.at("depth")), "", ""}, *box).values;
    map.shown_above = source.footprint_depth;
    map.field_label = shows_bed(source) ? "depth with new bed [m]" : "depth [m]";
    map.thick_release = true;
    map.survey = source.survey;
    map.barriers = barrier_plans(source.barriers);
    return map;
}

/// Draws every frame twice over: once to find the range of all of them, then for good. They need not fit the memory
/// together.
bool draw_frames(const FigureSource& source, const std::vector<double>& times, const fs::path& film,
                 std::string& why_not) {
    const Index count = static_cast<Index>(times.size());
    SharedView view;
    for (Index number = 0; number < count; ++number) view.add(depth_map(source, number));
    const int digits = decimals_of(times);
    return make_film(film, count, why_not, [&](Index number, const fs::path& png) {
        MapFigure map = depth_map(source, number);
        view.apply(map);
        const double time = times[static_cast<std::size_t>(number)];
        map.title = fmt::format("{}: depth{}, t = {:.{}f} s", source.title,
                                shows_bed(source) ? " with what has become bed" : "", time, digits);
        map.footer = source.footer;
        map.width = source.width;
        map.height = source.height;
        return render_map(map, png, why_not);
    });
}

}  // namespace

bool shows_bed(const FigureSource& source) { return find_product(source.rasters, "lying_depth") != nullptr; }

void add_deposit(LoadedFrame& frame) {
    if (!frame.has("depth") || !frame.has("deposited_depth")) return;
    std::vector<double>& depth = frame.nodes.at("depth");
    const std::vector<double>& deposited = frame.nodes.at("deposited_depth");
    for (std::size_t n = 0; n < depth.size(); ++n)
        if (deposited[n] > 0.0) depth[n] += deposited[n];
}

int decimals_of(const std::vector<double>& times) {
    int digits = 0;
    for (std::size_t k = 0; k < times.size(); ++k)
        while (digits < (k + 1 < times.size() ? 3 : 1) &&
               std::abs(times[k] - std::round(times[k] * std::pow(10, digits)) / std::pow(10, digits)) > 5e-4)
            ++digits;
    return digits;
}

bool make_film(const fs::path& film, Index count, std::string& why_not,
               const std::function<bool(Index k, const fs::path& png)>& draw) {
    why_not = no_film_reason();
    if (!why_not.empty()) return false;
    FilmReel reel(film);
    for (Index k = 0; k < count; ++k) {
        if (Cutoff::asked()) return why_not = "the program was interrupted", false;
        if (!draw(k, reel.next())) return false;
    }
    constexpr double seconds = 8.0, slowest = 2.0, fastest = 25.0;
    return reel.join(std::clamp(static_cast<double>(count) / seconds, slowest, fastest), why_not);
}

void add_filmstrip(const FigureSource& source, Gallery& gallery) {
    if (source.bed.values.empty() || !fs::exists(source.run_dir / "grid.pvd")) return;
    const Index count = static_cast<Index>(frame_times(source.run_dir).size());
    if (count < 2) return;
    const char* const words =
        shows_bed(source) ? "depth at several times, with what has become bed" : "depth at several times";
    gallery.add({"figures/filmstrip_depth.png", words}, [&source, count](const fs::path& png, std::string& why_not) {
        const std::vector<double> times = frame_times(source.run_dir);
        Filmstrip strip;
        for (const Index number : spread_frames(count, 6)) {
            strip.maps.push_back(depth_map(source, number));
            strip.maps.back().title = fmt::format("t = {:.6g} s", times[static_cast<std::size_t>(number)]);
        }
        return render_filmstrip(strip, png, why_not);
    });
}

void add_film(const FigureSource& source, const std::string& kind, Gallery& gallery) {
    gallery.add({"figures/film_depth." + kind, "depth through time"},
                [&source](const fs::path& film, std::string& why_not) {
                    why_not = no_film_reason();
                    if (!why_not.empty()) return false;
                    if (source.bed.values.empty() || !fs::exists(source.run_dir / "grid.pvd")) {
                        why_not = "the run has no frames on the grid; add \"vtk\" to output.formats and run again";
                        return false;
                    }
                    const std::vector<double> times = frame_times(source.run_dir);
                    if (times.empty()) return why_not = "the run has no frames yet", false;
                    return draw_frames(source, times, film, why_not);
                });
}

}  // namespace frana
