#include "compare/comparison.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "compare/flow_tracks.h"
#include "compare/given_path.h"
#include "compare/outline_step.h"

namespace frana {
namespace {

class Comparing {
public:
    Comparing(const SimulatedRun& run, const Survey& survey)
        : run_(run), survey_(survey), rings_(rings_of(survey.footprint)) {
        expect(run.peak_depth != nullptr, "a comparison needs the peak depth");
        result_.extents = area_of(rings_) > 0.0;
        expect(result_.extents || survey.bed_change, "a survey has an area, or changes of the bed");
        result_.survey = survey.footprint.source;
        result_.path_source = survey.path_source;
        result_.deposit_source = survey.deposit_source;
        result_.bed_change_source = survey.bed_change_source;
        result_.limit = run.limit;
        result_.cell = run.peak_depth->geometry.cell;
        step_ = outline_step(result_.cell);
    }

    Comparison all() {
        find_cover();
        choose_path();
        if (survey_.path) judge_given_path();
        if (result_.extents) compare_extents();
        compare_beds();
        if (result_.extents) make_remarks();
        return std::move(result_);
    }

private:
    void find_cover() {
        if (run_.final_depth) lying_ = with_deposit(*run_.final_depth, run_.deposited_depth);
        if (lying_ && run_.deposited_depth) buried_ = deepest_cover(*run_.peak_depth, *lying_);
    }

    /// What was ever covered [m].
    const Raster& cover() const { return buried_ ? *buried_ : *run_.peak_depth; }

    void compare_extents() {
        const Raster& ever = cover();
        result_.outline = pixel_outline(ever, run_.limit);
        find_paths(ever);
        result_.trace = scores(ever, result_.outline);
        if (lying_) result_.final = scores(*lying_, pixel_outline(*lying_, run_.limit));
        if (!result_.path.empty()) {
            const std::vector<Rings> of_survey = rings_of_survey(), of_flows = rings_of_flows(result_.outline);
            const std::vector<FrontAlong> surveyed = fronts_along(paths_, of_survey, result_.cell),
                                          simulated = fronts_along(paths_, of_flows, result_.cell);
            surveyed_front_ = surveyed.front(), simulated_front_ = simulated.front();
            for (std::size_t n = 1; n < paths_.size(); ++n)
                result_.others.push_back({paths_[n], simulated[n].place, surveyed[n].place});
            result_.surveyed_runout = surveyed_front_.place;
            result_.surveyed_reach = farthest_from(result_.path.front(), of_survey.front());
        }
        if (survey_.deposit && lying_) result_.deposit = deposit_errors(*lying_, *survey_.deposit, run_.limit);
    }

    void choose_path() {
        if (survey_.path) {
            result_.path = *survey_.path, result_.path_is_given = true;
            const double rise = height_at(result_.path.back()) - height_at(result_.path.front());
            if (run_.bed && std::isnan(rise))
                remark(
                    "{}: found an end of the path where the terrain has no elevation, so which way it falls is not "
                    "checked; expected it drawn downhill, from the release to the toe",
                    survey_.path_source);
            if (rise > 0.0) {
                std::reverse(result_.path.begin(), result_.path.end());
                remark("{}: the path is drawn uphill and was turned round", survey_.path_source);
            }
        } else if (run_.bed && run_.arrival_time) {
            starts_ = release_middles(*run_.arrival_time);
            released_ = !starts_.empty();
            starts_.insert(starts_.end(), run_.starts.begin(), run_.starts.end());
            if (!starts_.empty()) result_.path = steepest_path(*run_.bed, starts_.front());
            if (length_of(result_.path) > 0.0)
                result_.path_source = fmt::format("steepest path from {}", begins_at());
            else
                result_.path.clear();
        }
        if (result_.path.empty())
            remark("no steepest path from the start of the flow is known, so no {}; give one with --path",
                   result_.extents ? "runout" : "volumes along it");
    }

    /// A line that has nothing to do with the flow gives runouts that look like answers.
    void judge_given_path() {
        const double cell = result_.cell;
        const bool to_flow = comes_to_flow(result_.path, cover(), run_.limit);
        const bool to_survey = result_.extents
                                   ? comes_to_polygons(result_.path, survey_.footprint, cell)
                                   : comes_to_changes(result_.path, *survey_.bed_change, survey_.bed_change_noise);
        if (!to_flow && !to_survey) {
            result_.stray_path = words_on_stray(survey_.path_source);
            remark("{}; {} not known", result_.stray_path,
                   result_.extents ? "runouts are" : "the changes along it are");
            result_.path.clear(), result_.path_source.clear();
            return;
        }
        const bool anything = comes_to_anything(cover());
        if (!to_survey || (!to_flow && anything))
            remark(
                "{}: the path does not touch what was {}, whose {} are those of the places along it that lie nearest; "
                "draw it along the flow",
                survey_.path_source, to_survey ? "simulated" : "surveyed", result_.extents ? "runouts" : "changes");
        tell_begin();
    }

    bool comes_to_anything(const Raster& depth) const {
        return std::any_of(depth.values.begin(), depth.values.end(), [&](double h) { return h > run_.limit; });
    }

    /// Runouts count from the path's beginning.
    void tell_begin() {
        if (!run_.arrival_time) return;
        const double apart = distance_to_start(result_.path.front(), *run_.arrival_time, run_.starts);
        if (!(apart > kNoticeable * result_.cell)) return;
        remark(
            "{}: the path begins {:.4g} m from the nearest place where material was released or came in, and distances "
            "along it count from there; expected it from the release to the toe",
            survey_.path_source, apart);
    }

    void find_paths(const Raster& ever) {
        paths_ = {result_.path};
        if (result_.path.empty() || survey_.path) return;
        tracks_.emplace(ever, run_.limit, starts_);
        paths_.clear();
        for (const RunoutPath& path : runout_paths(*run_.bed, ever, run_.limit, *tracks_, starts_)) {
            if (path.of_flow) follow_flow(paths_.empty(), path);
            paths_.push_back(path.line);
        }
        result_.path = paths_.front();
    }

    const char* begins_at() const { return released_ ? "the release" : "where material comes in"; }

    void follow_flow(bool first, const RunoutPath& path) {
        if (first) result_.path_source = fmt::format("track of the flow from {}", begins_at()), follows_flow_ = true;
        result_.remarks.push_back(remark_on_track(path) +
                                  "; other runs may have other tracks, so give one with --path to compare them");
    }

    std::vector<Rings> rings_of_survey() const {
        return tracks_ ? rings_of_polygons(paths_, survey_.footprint, result_.cell) : std::vector<Rings>{rings_};
    }

    std::vector<Rings> rings_of_flows(const Rings& outline) const {
        return tracks_ ? rings_of_parts(paths_, *tracks_, outline) : std::vector<Rings>{outline};
    }

    /// NaN where there is no terrain.
    double height_at(const Vec2& p) const {
        if (!run_.bed) return Raster::nodata;
        const GridGeometry& g = run_.bed->geometry;
        const double i = std::round((p.x() - g.x0) / g.cell), j = std::round((p.y() - g.y0) / g.cell);
        const bool inside = i >= 0 && j >= 0 && i < static_cast<double>(g.nx) && j < static_cast<double>(g.ny);
        return inside ? run_.bed->at(static_cast<Index>(i), static_cast<Index>(j)) : Raster::nodata;
    }

    ExtentScores scores(const Raster& depth, const Rings& outline) const {
        ExtentScores scores;
        scores.areas = overlap(depth, run_.limit, rings_);
        scores.boundary = distance_between(outline, rings_, step_);
        if (!result_.path.empty()) {
            const std::vector<Rings> rings = rings_of_flows(outline);
            scores.runout = fronts_along(paths_, rings, result_.cell).front().place;
            scores.reach = farthest_from(result_.path.front(), rings.front());
        }
        return scores;
    }

    void compare_beds() {
        if (!survey_.bed_change || !run_.bed_change) return;
        const Raster change =
            surface_change(*run_.bed_change, run_.final_depth, run_.arrival_time, run_.released_later);
        const double noise = survey_.bed_change_noise;
        result_.bed_change = bed_change_errors(change, *survey_.bed_change, noise);
        result_.bed_change_steps = bed_change_along(result_.path, change, *survey_.bed_change, noise);
        const BedChangeErrors& errors = *result_.bed_change;
        if (!(errors.surveyed.all() > 0.0))
            remark("{} changes nowhere by more than {:.3g} m outside of the releases, so its errors are no numbers",
                   result_.bed_change_source, noise);
        if (errors.unsurveyed.all() > 0.0)
            remark(
                "{:.6g} m3 of the simulated changes of the bed lie where {} has no data and are in none of its errors",
                errors.unsurveyed.all(), result_.bed_change_source);
    }

    template <class... Parts>
    void remark(const char* form, const Parts&... parts) {
        result_.remarks.push_back(fmt::format(fmt::runtime(form), parts...));
    }

    void make_remarks() {
        const Overlap& areas = result_.trace.areas;
        if (areas.missed_outside > 0.0)
            remark(
                "{:.6g} m2 of the survey ({:.3g} %) lie outside the run's terrain and count as missed; widen the "
                "elevation model or terrain.window",
                areas.missed_outside, 100.0 * areas.missed_outside / areas.surveyed());
        if (!(areas.simulated() > 0.0)) remark("nothing was ever deeper than {:.6g} m", run_.limit);
        const double length = length_of(result_.path);
        const double farthest = std::fmax(result_.surveyed_runout, result_.trace.runout);
        constexpr double round_off = 1e-9;
        const std::string end = remark_on_end(length, farthest, round_off * length);
        if (!end.empty()) result_.remarks.push_back(end);
        tell_other_valleys();
        tell_other_flow();
        if (!doubt_path()) doubt_end();
        if (!result_.deposit) return;
        const DepositErrors& deposit = *result_.deposit;
        if (deposit.unsurveyed_volume > 0.0)
            remark(
                "{:.6g} m3 of the simulated deposit lie where {} has no data and are in none of its errors; if no "
                "data means no deposit there, write zeros",
                deposit.unsurveyed_volume, result_.deposit_source);
        if (deposit.negative > 0)
            remark("{} pixels of {} are below zero and are taken as they are", deposit.negative,
                   result_.deposit_source);
    }

    /// Beside the end of the path nothing tells how far a flow runs.
    void doubt_end() {
        if (result_.path.empty()) return;
        const bool survey = turns_off(surveyed_front_, kNoticeable * result_.cell);
        const std::string turn =
            remark_on_turn(survey ? surveyed_front_ : simulated_front_, kNoticeable * result_.cell);
        if (!turn.empty())
            remark("{}, so the runout {} ends with the path; give the whole track of the flow with --path", turn,
                   survey ? "of the survey" : "that was simulated");
    }

    void tell_other_valleys() {
        if (result_.others.empty()) return;
        std::string runouts;
        const auto metres = [](double length) { return std::isnan(length) ? "-" : fmt::format("{:.4g} m", length); };
        for (const OtherRunout& other : result_.others)
            runouts +=
                fmt::format("{}{} / {} from {:.10g}, {:.10g}", runouts.empty() ? "" : "; ", metres(other.simulated),
                            metres(other.surveyed), other.path.front().x(), other.path.front().y());
        result_.remarks.push_back(
            fmt::format("{}. A surveyed polygon counts for the paths that start in it. Runouts of the others, "
                        "simulated / surveyed: {}",
                        remark_on_others(result_.path.front()), runouts));
    }

    /// The farthest front along the path may be that of another release, on the same slope or farther down its gully.
    void tell_other_flow() {
        if (!tracks_ || result_.path.empty()) return;
        const double own = front_of_own_part(result_.path, *tracks_, result_.outline, result_.cell).place;
        if (!(result_.trace.runout > own + kNoticeable * result_.cell)) return;
        remark(
            "the flow from {:.10g}, {:.10g} itself reaches {:.4g} m along the path; the runout of {:.4g} m is that of "
            "another flow, which does not touch it",
            result_.path.front().x(), result_.path.front().y(), own, result_.trace.runout);
    }

    /// A flow that runs up an opposite slope or over a dam leaves the path that water would take.
    bool doubt_path() {
        if (survey_.path || result_.path.empty() || !result_.others.empty() || follows_flow_) return false;
        const double along = result_.trace.runout - result_.surveyed_runout;
        const double straight = result_.trace.reach - result_.surveyed_reach;
        if (!(std::abs(along - straight) > kNoticeable * result_.cell)) return false;
        remark(
            "the steepest path may turn away from the fronts: they differ by {:+.4g} m along it, but by {:+.4g} "
            "m straight from the release; give the track of the flow with --path",
            along, straight);
        return true;
    }

    const SimulatedRun& run_;
    const Survey& survey_;
    Rings rings_;
    bool follows_flow_ = false;         ///< the path is the track of the flow itself
    bool released_ = false;             ///< the first start is that of the largest release
    std::vector<Vec2> starts_;          ///< of releases, then of what came in later
    std::vector<Polyline> paths_;       ///< the path, then those of releases in other valleys
    std::optional<FlowTracks> tracks_;  ///< of what was ever covered, where the paths are not the survey's
    FrontAlong surveyed_front_, simulated_front_;
    double step_ = 1.0;
    Comparison result_;
    std::optional<Raster> lying_;   ///< at the end, also what has become bed [m]
    std::optional<Raster> buried_;  ///< what was ever covered, where some became bed [m]
};

}  // namespace

std::vector<Polyline> paths_of(const Comparison& comparison) {
    std::vector<Polyline> paths;
    if (!comparison.path.empty()) paths.push_back(comparison.path);
    for (const OtherRunout& other : comparison.others) paths.push_back(other.path);
    return paths;
}

Comparison compare(const SimulatedRun& run, const Survey& survey) { return Comparing(run, survey).all(); }

}  // namespace frana
