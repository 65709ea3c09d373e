#include "run/calibrate/event_survey.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/error.h"
#include "compare/blocks.h"
#include "compare/given_path.h"
#include "run/folder/comparison.h"
#include "run/folder/products.h"
#include "run/folder/release_results.h"
#include "scene/bed_over.h"
#include "scene/case_file.h"
#include "terrain/part_of.h"

namespace frana {
namespace {

constexpr double kSlow = 0.1;  ///< a speed that nobody tells from none [m/s]

double perimeter_of(const Rings& rings) {
    double sum = 0.0;
    for (const auto& ring : rings)
        for (std::size_t k = 0; k < ring.size(); ++k) sum += (ring[(k + 1) % ring.size()] - ring[k]).norm();
    return sum;
}

/// A raster without values where the run begins and where the survey is. Both are needed of what else was surveyed.
Raster around(const EnsembleBase& base) {
    std::vector<Vec2> points;
    for (const auto& ring : *base.survey) points.insert(points.end(), ring.begin(), ring.end());
    const NodeBox part = box_of(base.bed.geometry, base.whole).value();
    Raster like;
    like.geometry = common(united(part, cells_of(points, base.whole)), NodeBox::all(base.whole)).of(base.whole);
    like.crs_wkt = base.bed.crs_wkt;
    return like;
}

/// What the case holds of the terrain, and what is needed to know which way a path falls.
Raster bed_under(const Polyline& path, const EnsembleBase& base) {
    return bed_over(base.bed, base.wider.get(), cells_of(path, base.whole).of(base.whole));
}

/// Nothing lies where the flow never came.
void zero_where_unknown(Raster& raster) {
    for (double& value : raster.values)
        if (std::isnan(value)) value = 0.0;
}

UserError lacks(const SurveyedEvent& event, const std::string& key, const std::string& what,
                const std::string& way_out) {
    return UserError(fmt::format("{}: {}: found none; expected {} of the event \"{}\"; {}",
                                 event.runs.case_file.string(), key, what, event.name, way_out));
}

}  // namespace

EventSurvey::EventSurvey(const SurveyedEvent& event, const EnsembleBase& base)
    : objective_(event.objective),
      crs_wkt_(base.bed.crs_wkt),
      limit_(base.footprint_depth),
      correlation_(event.errors.correlation) {
    if (!base.survey) throw lacks(event, "survey.footprint", "the surveyed footprint", "name it there");
    SurveyFiles files = survey_files(CaseFile::read(event.runs.case_file));
    files.footprint.clear();  // was read with the case
    for (const auto& [kind, key, file] : {std::tuple{Evidence::deposit, "survey.deposit", files.deposit},
                                          std::tuple{Evidence::bed_change, "survey.bed_change", files.bed_change}})
        if (counts(kind) && file.empty())
            throw lacks(event, key, "the surveyed raster", "name it there, or take it out of the objective");
    std::vector<std::string> remarks;  // the case made them
    const Raster like = around(base);
    survey_ = read_survey_files(files, like, remarks);
    if (counts(Evidence::bed_change))
        later_ = may_be_released_later_on(release_sources(CaseFile::read(event.runs.case_file)), like);
    survey_.footprint = *base.footprint;
    perimeter_ = perimeter_of(*base.survey);
    if (survey_.path && counts(Evidence::runout)) require_on_survey(event, base.bed.geometry.cell);
    if (survey_.path)
        bed_ = bed_under(*survey_.path, base);
    else if (!base.path.empty())
        survey_.path = base.path;
    if (counts(Evidence::runout) && !survey_.path)
        throw lacks(event, "survey.path", "the path", "draw it, since no steepest path from the release is known");
    read_gauges(event);
}

/// Beside the surveyed extent a path has no surveyed runout, whatever flows.
void EventSurvey::require_on_survey(const SurveyedEvent& event, double cell) const {
    if (comes_to_polygons(*survey_.path, survey_.footprint, cell)) return;
    throw UserError(fmt::format(
        "{}: survey.path: found a line that does not touch the surveyed footprint; expected the path of the "
        "event \"{}\", from the release to the toe; draw it along the flow, or check its coordinates and "
        "its CRS",
        event.runs.case_file.string(), event.name));
}

bool EventSurvey::counts(Evidence evidence) const {
    return std::count(objective_.begin(), objective_.end(), evidence) > 0;
}

/// What lies below these bounds is like nothing at all, and every run meets it as well as every other.
void EventSurvey::require_visible(const SurveyedEvent& event, const SeenAtGauge& seen) const {
    const auto refuse = [&](const char* what, const std::optional<double>& number, double least, const char* unit,
                            const char* bound) {
        if (number && !(*number > least))
            throw UserError(
                fmt::format("{}: event.gauge.{}: found {:g} {} at \"{}\" of the event \"{}\"; expected more than {:g} "
                            "{}, {}, below "
                            "which runs cannot be told apart; leave it out",
                            event.runs.file.string(), what, *number, unit, seen.name, event.name, least, unit, bound));
    };
    refuse("depth", seen.depth, limit_, "m", "output.footprint_depth of its case");
    refuse("speed", seen.speed, kSlow, "m/s", "a speed that nobody sees");
}

void EventSurvey::read_gauges(const SurveyedEvent& event) {
    const CaseFile file = CaseFile::read(event.runs.case_file);
    for (const SeenAtGauge& seen : event.gauges) {
        std::string names;
        const std::size_t before = gauges_.size();
        for (Index k = 0; k < file.count("gauge"); ++k) {
            const std::string& name = file.word(fmt::format("gauge.{}.name", k));
            names += (names.empty() ? "" : ", ") + name;
            const std::vector<double>& point = file.numbers(fmt::format("gauge.{}.point", k));
            if (name == seen.name) gauges_.push_back({name, {point[0], point[1]}}), seen_.push_back(seen);
        }
        require_visible(event, seen);
        if (gauges_.size() == before)
            throw UserError(
                fmt::format("{}: gauge: found none of the name \"{}\"; expected one of the event \"{}\"; {}",
                            event.runs.case_file.string(), seen.name, event.name,
                            names.empty() ? "add it" : "is one of " + names + " meant?"));
    }
}

/// Stores the largest depths and speeds at the gauges, and compares the last frame.
class EventSurvey::Watch : public Observer {
public:
    Watch(const EventSurvey& event, EventScores& scores)
        : event_(event), scores_(scores), gauges_(event.gauges_, event.limit_) {}
    std::string name() const override { return "survey"; }
    bool looks_at_fields() const override { return false; }  // at the end it does

    void step(const Status& now, const Probe& probe) override { gauges_.step(now, probe); }

    void end(const Frame& last) override {
        const std::vector<ProductRaster> rasters = product_rasters(last, event_.crs_wkt_);
        if (!find_product(rasters, "peak_depth")) return;
        const Comparison found =
            compare_rasters(rasters, event_.bed_ ? &*event_.bed_ : nullptr, event_.limit_, event_.survey_);
        scores_.iou = found.trace.areas.iou();
        if (std::isnan(found.trace.boundary.rms)) return;  // nothing flowed
        scores_.boundary = found.trace.boundary.mean;
        note(Evidence::outline, {found.trace.boundary.rms, event_.perimeter_ / event_.correlation_});
        note(Evidence::runout, {std::abs(found.trace.runout - found.surveyed_runout), 1.0});
        compare_heights(found, rasters);
        note(Evidence::gauges, at_gauges());
    }

private:
    void note(Evidence evidence, const Misfit& misfit) {
        if (event_.counts(evidence)) scores_.misfits[static_cast<std::size_t>(evidence)] = misfit;
    }

    static const Raster* of(const std::vector<ProductRaster>& rasters, const char* name) {
        const ProductRaster* product = find_product(rasters, name);
        return product ? &product->raster : nullptr;
    }

    void compare_heights(const Comparison& found, const std::vector<ProductRaster>& rasters) {
        const std::optional<Raster> solids = solids_at_end(rasters);
        const Raster* const lying = solids ? &*solids : nullptr;
        const auto note_blocks = [&](Evidence evidence, const Raster& ours, const Raster& theirs, double unsurveyed) {
            const BlockErrors errors = block_errors(ours, theirs, event_.correlation_);
            if (errors.number > 0.0)
                note(evidence, {errors.rms, errors.number, unsurveyed});  // nothing else is an answer
        };
        if (event_.counts(Evidence::deposit) && lying) {
            Raster all = with_deposit(*lying, of(rasters, "deposited_depth"));
            zero_where_unknown(all);
            note_blocks(Evidence::deposit, all, *event_.survey_.deposit,
                        found.deposit ? found.deposit->unsurveyed_volume : 0.0);
        }
        const Raster* change = of(rasters, "bed_change");
        if (!event_.counts(Evidence::bed_change) || !change) return;
        std::optional<Raster> later;
        if (event_.later_) later = part_of(*event_.later_, box_of(change->geometry, event_.later_->geometry).value());
        note_blocks(Evidence::bed_change,
                    surface_change(*change, lying, of(rasters, "arrival_time"), later ? &*later : nullptr),
                    *event_.survey_.bed_change, found.bed_change ? found.bed_change->unsurveyed.all() : 0.0);
    }

    /// Where the flow did not come, it counts as just too shallow and too slow to be seen.
    Misfit at_gauges() const {
        double square = 0.0, number = 0.0;
        const auto add = [&](double ours, const std::optional<double>& theirs, double least) {
            if (!theirs) return;
            const double apart = std::log(std::max(ours, least) / *theirs);
            square += apart * apart, number += 1.0;
        };
        for (std::size_t k = 0; k < event_.seen_.size(); ++k) {
            const GaugePeak& peak = gauges_.peaks()[k];
            add(peak.depth.value_or(0.0), event_.seen_[k].depth, event_.limit_);
            add(peak.speed.value_or(0.0), event_.seen_[k].speed, kSlow);
        }
        return {number > 0.0 ? std::sqrt(square / number) : 0.0, number};
    }

    const EventSurvey& event_;
    EventScores& scores_;
    GaugePeaks gauges_;
};

std::unique_ptr<Observer> EventSurvey::watch(EventScores& scores) const {
    return std::make_unique<Watch>(*this, scores);
}

}  // namespace frana
