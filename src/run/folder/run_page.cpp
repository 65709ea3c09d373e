#include "run/folder/run_page.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/error.h"
#include "compare/deposit.h"
#include "observe/table.h"
#include "run/folder/left_terrain.h"
#include "run/folder/run_film.h"
#include "run/web/web_page.h"
#include "scene/case_file.h"
#include "terrain/part_of.h"
#include "vtk_io/figures/map_range.h"
#include "vtk_io/reader.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

using RecordJson = nlohmann::ordered_json;

constexpr const char* kPage = "figures/view.html";

/// "24 300", a thin space at each thousand.
std::string grouped(double value, int decimals = 0) {
    std::string text = fmt::format("{:.{}f}", value, decimals);
    const std::size_t point = std::min(text.find('.'), text.size()), first = value < 0.0 ? 1 : 0;
    for (std::size_t at = point; at > first + 3; at -= 3) text.insert(at - 3, "\u2009");
    return text;
}

/// With three digits or more.
std::string measured(double value, const char* unit) {
    const double size = std::abs(value);
    const int decimals =
        size >= 100.0 || size == 0.0 ? 0 : std::clamp(2 - static_cast<int>(std::floor(std::log10(size))), 0, 6);
    return grouped(value, decimals) + "\u2009" + unit;
}

std::string end_of(const RecordJson& record) {
    std::string reason = record.value("exit_reason", "");
    if (reason == "rest") return "the mass came to rest";
    if (reason == "end") return "the simulated time was over";
    if (reason == "until") return "it was to go on until then (--until)";
    if (reason == "left") return "no material was left";
    return reason;
}

/// At the start and later [m3]; runs of an earlier version do not tell the latter.
double released_in_all(const RecordJson& record) {
    return record.at("release_volume").get<double>() + record.value("release_volume_later", 0.0);
}

/// By inflows, rain and the like [m3].
double came_in(const RecordJson& record) {
    const RecordJson& budgets = record.at("budgets");
    if (const auto water = budgets.find("water"); water != budgets.end())
        return water->value("rained", 0.0) + water->value("entered", 0.0) + water->value("fed", 0.0);
    const auto inflow = budgets.find("inflow");
    return inflow != budgets.end() ? inflow->value("volume", 0.0) : 0.0;
}

/// Of the material, so that masses are volumes as they are in the flow [kg/m3].
double density_of(const FigureSource& source, const RecordJson& record) {
    const double mass = record.at("budgets").at("mass").at("initial"), volume = record.at("release_volume");
    return source.density > 0.0 ? source.density : mass / std::max(volume, 1e-300);
}

/// As the bed had it, by its own density, like eroded_depth.tif and studies. Runs without that raster tell its mass alone,
/// which becomes a volume as it is in the flow [m3].
double taken_volume(const FigureSource& source, const RecordJson& record, const RecordJson& bed) {
    const double mass = bed.value("taken_of_bed", 0.0);
    const ProductRaster* const eroded = find_product(source.rasters, "eroded_depth");
    if (!(mass > 0.0) || eroded == nullptr) return mass / density_of(source, record);
    return volume_of(eroded->raster);
}

/// What there was of the flow, and where it went. What there was none of has no row.
std::vector<std::pair<std::string, std::string>> volumes_of(const FigureSource& source, const RecordJson& record) {
    const RecordJson& budgets = record.at("budgets");
    std::vector<std::pair<std::string, std::string>> facts;
    const auto add = [&](const char* name, double volume) {
        if (volume > 0.0) facts.emplace_back(name, measured(volume, "m\u00b3"));
    };
    add("Released", released_in_all(record));
    add("Came in", came_in(record));
    if (const auto bed = budgets.find("bed"); bed != budgets.end()) {
        add("Taken of the bed", taken_volume(source, record, *bed));
        add("Became bed", bed->value("lies_behind", 0.0) / density_of(source, record));
    }
    if (const double left = left_share_in(record); left > 0.0)
        facts.emplace_back("Left the terrain", fmt::format("{:.3g} % of all that flowed", 100.0 * left));
    return facts;
}

std::vector<std::pair<std::string, std::string>> facts_of(const FigureSource& source, const RecordJson& record) {
    const RecordJson &results = record.at("results"), &mass = record.at("budgets").at("mass");
    std::vector<std::pair<std::string, std::string>> facts = volumes_of(source, record);
    const std::vector<std::pair<std::string, std::string>> others = {
        {"Farthest front", measured(results.at("max_front"), "m")},
        {"Largest depth", measured(results.at("max_depth"), "m")},
        {"Largest speed", measured(results.at("max_speed"), "m/s")},
        {"Covered area", measured(results.at("footprint_area"), "m\u00b2")},
        {"Simulated time", measured(record.at("simulated_time"), "s")},
        {"Ended because", end_of(record)},
        {"Cells", measured(record.at("grid").at("cell"), "m")},
        {"Mass error", fmt::format("{:.1e}", mass.at("relative_error").get<double>())}};
    facts.insert(facts.end(), others.begin(), others.end());
    return facts;
}

struct DrapeRule {
    const char *name, *label, *unit;
    Colormap colours;
    double factor;  ///< from SI
};
constexpr DrapeRule kDrapes[] = {
    {"peak_depth", "peak depth", "m", Colormap::depth, 1.0},
    {"peak_speed", "peak speed", "m/s", Colormap::speed, 1.0},
    {"peak_dynamic_pressure", "peak dynamic pressure", "kPa", Colormap::pressure, 1e-3},
    {"arrival_time", "arrival time", "s", Colormap::speed, 1.0},
    {"final_depth", "depth at the end", "m", Colormap::depth, 1.0},
    {"lying_depth", "depth at the end, with what has become bed", "m", Colormap::depth, 1.0},
    {"bed_change", "change of the bed", "m", Colormap::diverging, 1.0},
};

/// The part of a raster that was ever covered, or changed, in units for people; nothing when there is none.
std::optional<PageDrape> drape_of(const FigureSource& source, const DrapeRule& rule) {
    const ProductRaster *product = find_product(source.rasters, rule.name),
                        *peak = find_product(source.rasters, "peak_depth");
    if (product == nullptr || peak == nullptr) return {};
    if (std::string(rule.name) == "final_depth" && product != find_lying(source.rasters)) return {};
    const bool bed = rule.colours == Colormap::diverging, end = product == find_lying(source.rasters);
    const Raster& extent = end ? product->raster : peak->raster;
    PageDrape drape{rule.name, rule.label, rule.unit, rule.colours, 0.0, 1.0, product->raster};
    bool any = false;
    for (std::size_t n = 0; n < drape.raster.values.size(); ++n) {
        double& value = drape.raster.values[n];
        const bool shown = extent.values[n] > source.footprint_depth || (bed && value != 0.0);
        value = shown ? value * rule.factor : Raster::nodata;
        any |= std::isfinite(value) && (!bed || value != 0.0);
    }
    if (!any) return {};
    const ColourRange range = colour_range(drape.raster.values, bed ? 0.0 : kAll, rule.colours, {},
                                           bed || drape.name == "peak_depth" ? Top::flow : Top::percentile);
    drape.low = range.low, drape.high = range.high;
    drape.above = range.more_above, drape.below = range.more_below;
    return drape;
}

/// What lies as bed in the rows of history.csv [m3]: all that came to lie up to then, which rows have, but for what the
/// flow has taken up again of it. Of that frames tell how much it is. A frame may lie between two rows, of which the
/// later has much more come to lie; what was taken up again only ever grows.
class LyingBed {
public:
    LyingBed(const std::vector<PackedFrame>& frames, const Table& history, double density)
        : frames_(frames),
          time_(history.column("t")),
          came_(history.column("deposited_mass")),
          taken_(history.column("eroded_mass")),
          density_(density) {
        if (time_.empty()) return;
        std::vector<double> least, most;  // by the rows around each frame
        for (const PackedFrame& frame : frames) {
            const std::size_t row = row_at(frame.time), next = std::min(row + 1, time_.size() - 1);
            least.push_back(came_[row] / density - frame.lying);
            most.push_back(came_[time_[row] == frame.time ? row : next] / density - frame.lying);
        }
        again_ = most;
        double bound = 0.0;
        for (std::size_t k = 0; k < again_.size(); ++k)
            again_[k] = bound = std::min(std::max(bound, least[k]), most[k]);
        bound = std::numeric_limits<double>::infinity();
        for (std::size_t k = again_.size(); k-- > 0;) {
            bound = std::max(std::min(bound, most[k]), least[k]);
            again_[k] = 0.5 * (again_[k] + bound);
        }
    }

    double at_row(std::size_t row) const { return frames_.empty() ? 0.0 : came_[row] / density_ - again_at(row); }

private:
    /// The last one that is not later.
    std::size_t row_at(double time) const {
        const auto after = std::upper_bound(time_.begin(), time_.end(), time);
        return after == time_.begin() ? 0 : static_cast<std::size_t>(after - time_.begin()) - 1;
    }
    /// What was taken up again goes between frames as the flow takes of its bed [m3].
    double again_at(std::size_t row) const {
        const auto later = [](double time, const PackedFrame& frame) { return time < frame.time; };
        const auto next = std::upper_bound(frames_.begin(), frames_.end(), time_[row], later);
        const auto k = static_cast<std::size_t>(next - frames_.begin());
        if (k == 0 || next == frames_.end()) return k == 0 ? again_.front() : again_.back();
        const std::size_t from = row_at(frames_[k - 1].time), until = row_at(frames_[k].time);
        const double taken = taken_[until] - taken_[from], span = time_[until] - time_[from];
        const double share = taken > 0.0  ? (taken_[row] - taken_[from]) / taken
                             : span > 0.0 ? (time_[row] - time_[from]) / span
                                          : 0.0;
        return again_[k - 1] + share * (again_[k] - again_[k - 1]);
    }

    const std::vector<PackedFrame>& frames_;
    const std::vector<double>&time_, &came_, &taken_;
    double density_;
    std::vector<double> again_;  ///< taken up again until each frame [m3]
};

/// Of history.csv; none where it is gone. The volume is that of the depth on show: what has become bed counts.
PageCurves curves_of(const FigureSource& source, const FlowFrames& frames, const RecordJson& record,
                     std::vector<std::string>& warnings) {
    PageCurves curves;
    curves.runout_name = "Farthest front from " + source.front_origin;
    const auto lies = [](const PackedFrame& frame) { return frame.lying > 0.0; };
    curves.volume_name = std::any_of(frames.frames().begin(), frames.frames().end(), lies)
                             ? "Volume, with what has become bed"
                             : "Volume";
    try {
        const Table history = read_table(source.run_dir / "history.csv");
        curves.time = history.column("t"), curves.runout = history.column("front"),
        curves.volume = history.column("mass");
        const double density = density_of(source, record);
        const LyingBed bed(frames.frames(), history, density);
        for (std::size_t k = 0; k < curves.volume.size(); ++k)
            curves.volume[k] = curves.volume[k] / density + bed.at_row(k);
    } catch (const UserError& error) {
        warnings.push_back(fmt::format("{} shows no curves: {}", kPage, error.what()));
    }
    return curves;
}

std::vector<PageBarrier> barriers_of(const FigureSource& source) {
    std::vector<PageBarrier> barriers;
    BarrierMeshes meshes;
    const auto by_mesh = [](const Barrier& b) { return b.outline.parts.empty() && b.line.empty(); };
    if (std::any_of(source.barriers.begin(), source.barriers.end(), by_mesh))
        meshes = read_barrier_meshes(source.run_dir);
    for (std::size_t i = 0; i < source.barriers.size(); ++i) {
        const Barrier& b = source.barriers[i];
        PageBarrier barrier{b.name, b.outline, b.line, b.top, b.height, i < meshes.size() ? meshes[i] : nullptr};
        if (barrier.mesh || !by_mesh(b)) barriers.push_back(std::move(barrier));
    }
    return barriers;
}

/// The largest of what frames hold. Of the peaks, where the run has them, so that both have the same colours.
PageTop top_of(const std::vector<PageDrape>& drapes, const char* name, double of_frames) {
    for (const PageDrape& drape : drapes)
        if (drape.name == name) return {drape.high, of_frames > drape.high};
    return {of_frames > 0.0 ? of_frames : 1.0, false};
}

WebPage page_of(const FigureSource& source, const FlowFrames& frames, const RecordJson& record,
                std::vector<std::string>& warnings) {
    WebPage page;
    page.title = source.title, page.caption = source.footer;
    page.facts = facts_of(source, record);
    page.bed = source.bed;
    page.frames = &frames;
    for (const DrapeRule& rule : kDrapes)
        if (auto drape = drape_of(source, rule)) page.drapes.push_back(std::move(*drape));
    double deepest = 0.0, fastest = 0.0;
    for (const PackedFrame& frame : frames.frames())
        deepest = std::max(deepest, frame.deepest), fastest = std::max(fastest, frame.fastest);
    page.depth = top_of(page.drapes, "peak_depth", deepest);
    page.speed = top_of(page.drapes, "peak_speed", fastest);
    page.footprint_depth = source.footprint_depth;
    page.survey = source.survey;
    for (const Profile& profile : source.profiles) page.lines.push_back({profile.name, profile.line});
    for (const Section& section : source.sections) page.lines.push_back({section.name, section.line});
    for (const NamedLine& plan : inflow_plans(source.inflows)) page.lines.push_back({plan.name, plan.line});
    for (const Gauge& gauge : source.gauges) page.gauges.push_back({gauge.name, gauge.point});
    page.barriers = barriers_of(source);
    page.curves = curves_of(source, frames, record, warnings);
    if (frames.frames().empty())
        page.remarks.push_back(
            "The run left no frames, so there is no film of it: \"vtk\" or \"web\" in output.formats makes them.");
    return page;
}

}  // namespace

bool asks_for_page(const CaseFile& file) {
    const auto& formats = file.words("output.formats");
    return std::find(formats.begin(), formats.end(), "web") != formats.end();
}

void check_page(const CaseFile& file) {
    if (const std::string why_not = no_page_reason(); asks_for_page(file) && !why_not.empty())
        throw UserError(fmt::format("{}: found \"web\"; {}", file.place("output.formats"), why_not));
}

FlowFrames frames_of_run(const FigureSource& source) {
    FlowFrames frames(source.footprint_depth);
    if (!fs::exists(source.run_dir / "grid.pvd")) return frames;
    const std::vector<double> times = frame_times(source.run_dir);
    for (Index number = 0; number < static_cast<Index>(times.size()); ++number) {
        LoadedFrame frame = read_frame(source.run_dir, number);
        if (!frame.has("depth")) continue;
        const double lying =
            frame.has("deposited_depth") ? volume_on(frame.grid, frame.nodes.at("deposited_depth").data()) : 0.0;
        add_deposit(frame);
        std::vector<double>& depth = frame.nodes.at("depth");
        if (frame.has("elevation"))
            for (std::size_t n = 0; n < depth.size(); ++n)
                if (std::isnan(frame.nodes.at("elevation")[n])) depth[n] = 0.0;
        frames.add(number, times[static_cast<std::size_t>(number)],
                   {frame.grid, depth.data(), frame.has("speed") ? frame.nodes.at("speed").data() : nullptr}, lying);
    }
    return frames;
}

void add_page(const FigureSource& source, const FlowFrames& frames, const std::string& record, Gallery& gallery) {
    std::string why_not = no_page_reason();
    if (why_not.empty() && source.bed.values.empty()) why_not = "the run's terrain is not known";
    std::shared_ptr<const WebPage> page;
    if (why_not.empty()) try {
            std::vector<std::string> warnings;
            page = std::make_shared<const WebPage>(page_of(source, frames, RecordJson::parse(record), warnings));
            for (std::string& warning : warnings) gallery.warn(std::move(warning));
        } catch (const std::exception& error) {
            why_not = error.what();
        }
    gallery.add({kPage, "the run in three dimensions and through time, for a browser"},
                [page, why_not](const fs::path& html, std::string& reason) {
                    reason = why_not;
                    if (page) write_text(html, web_page(*page));
                    return page != nullptr;
                });
}

}  // namespace frana
