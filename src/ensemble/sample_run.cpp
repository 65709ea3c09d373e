#include "ensemble/sample_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <ostream>

#include "base/error.h"
#include "compare/deposit.h"
#include "compare/flow_tracks.h"
#include "compare/flow_width.h"
#include "compare/outline_step.h"
#include "compare/overlap.h"
#include "compare/runout.h"
#include "observe/budget.h"
#include "run/run_loop.h"
#include "run/simulation.h"
#include "scene/bed_over.h"
#include "scene/build_scene.h"
#include "scene/flow_start.h"
#include "scene/taken_of_bed.h"
#include "terrain/places.h"

namespace frana {
namespace {

/// The plan's fields of the last frame, and where it lies.
class LastPeaks : public Observer {
public:
    explicit LastPeaks(const std::vector<std::string>& fields) : fields_(fields) {}
    std::string name() const override { return "peaks"; }
    bool looks_at_fields() const override { return false; }  // at the end it does
    void end(const Frame& last) override {
        grid = last.grid;
        const auto count = static_cast<std::size_t>(last.grid.size());
        for (const std::string& name : fields_) {
            const Field* field = last.node(name);
            values.emplace_back(count, 0.0);
            if (field) std::copy(field->data, field->data + count, values.back().begin());
        }
        if (const Field* taken = last.node("eroded_depth")) eroded.assign(taken->data, taken->data + count);
        const Field *flow = last.node("depth"), *left = last.node("deposited_depth");
        for (std::size_t n = 0; flow && left && n < count; ++n) lying.push_back(flow->data[n] + left->data[n]);
    }
    GridGeometry grid;
    std::vector<std::vector<double>> values;  ///< by field; zero where a model does not have it
    std::vector<double> eroded;               ///< of the bed that was there at the start; empty without one [m]
    std::vector<double> lying;                ///< at the end, with what became bed; empty where none can [m]

private:
    const std::vector<std::string>& fields_;
};

/// Nothing is written of a run of an ensemble, and nothing is needed of it on the way.
std::vector<std::string> quiet(std::vector<std::string> sets) {
    sets.emplace_back("output.formats=[]");
    return sets;
}

Scene scene_of(const EnsemblePlan& plan, const std::vector<std::string>& sets, const GisReader& reader,
               const MeshReader& meshes) {
    return build_scene(CaseFile::read(plan.case_file, quiet(sets)), reader, meshes);
}

/// A key of a numbered table that the case does not have would be a table of its own in each run, of defaults else.
void require_tables(const EnsemblePlan& plan, const CaseFile& file) {
    for (const Vary& vary : plan.vary) {
        const std::string table = repeated_table_of(vary.key);
        if (table.empty() || std::isdigit(static_cast<unsigned char>(vary.key[table.size() + 1])) == 0) continue;
        const Index number = std::stoll(vary.key.substr(table.size() + 1)), has = file.count(table);
        if (number >= has)
            throw UserError(fmt::format(
                "{}: {}: found a varied key of a table that {} does not have; it has {} [[{}]], which count from 0; "
                "correct the number, or add the table to the case",
                plan.file.string(), vary.key, plan.case_file.string(), has, table));
    }
}

/// Where runouts are measured from and along.
struct Way {
    std::optional<Vec2> start;
    Polyline path;
    std::vector<Polyline> others;  ///< from where else material is or comes in
};

/// Middles of the releases, the largest first: of the nodes that are nearest to particles.
std::vector<Vec2> middles_of_releases(const Scene& scene) {
    const GridGeometry& g = scene.bed.geometry;  // also where it is a small part of the terrain
    Raster released;
    released.geometry = g, released.values.assign(static_cast<std::size_t>(g.size()), Raster::nodata);
    for (std::size_t p = 0; p < scene.particles.x.size(); ++p)
        if (const NodeAt at = nearest_node(g, {scene.particles.x[p], scene.particles.y[p]}); has_node(g, at))
            released.at(at.i, at.j) = 0.0;
    return release_middles(released);
}

/// Places where the flow begins, as a comparison of the run has them.
std::vector<Vec2> starts_of(const Scene& scene) {
    std::vector<Vec2> starts = middles_of_releases(scene);
    for (const Vec2& start : starts_of_what_comes_in(scene)) starts.push_back(start);
    return starts;
}

/// To the edge of those nodes of the terrain: a scene may hold no more of it than where its flow begins.
Way way_of(const Scene& scene, const GridGeometry& shown) {
    Way way;
    const std::vector<Vec2> starts = starts_of(scene);
    if (starts.empty()) return way;
    const Raster bed = bed_over(scene.bed, scene.wider.get(), shown);
    way.start = starts.front(), way.path = steepest_path(bed, starts.front());
    if (!(length_of(way.path) > 0.0)) way.path.clear();
    for (std::size_t n = 1; n < starts.size() && !way.path.empty(); ++n)
        if (Polyline path = steepest_path(bed, starts[n]); length_of(path) > 0.0) way.others.push_back(std::move(path));
    return way;
}

/// The base's, so that runs compare. A flow that begins more than a cell from there has its own. That goes over the
/// ground that it came to, as that of a comparison of the run.
Way way_of(const Scene& scene, const EnsembleBase& base, const GridGeometry& shown) {
    const std::vector<Vec2> starts = starts_of(scene);
    if (!starts.empty() && base.start && (starts.front() - *base.start).norm() <= base.whole.cell)
        return {base.start, base.path, base.others};
    return way_of(scene, shown);
}

/// Distances, and how far the extent is the surveyed one.
void measure_extent(const EnsembleBase& base, const Scene& scene, const Raster& depth, SampleResult& result) {
    const Rings outline = pixel_outline(depth, base.footprint_depth);
    const double cell = base.whole.cell;
    if (base.survey) {
        result.iou = overlap(depth, base.footprint_depth, *base.survey).iou();
        if (!outline.empty()) result.boundary = distance_between(outline, *base.survey, outline_step(cell)).mean;
    }
    if (outline.empty()) return;
    const Way way = way_of(scene, base, depth.geometry);
    if (!way.start) return;
    if (way.path.empty()) {
        result.runout = result.reach = farthest_from(*way.start, outline);
        return;
    }
    std::vector<Polyline> paths{way.path};
    paths.insert(paths.end(), way.others.begin(), way.others.end());
    const std::vector<Rings> rings = rings_of_parts(paths, depth, base.footprint_depth, outline);
    result.reach = farthest_from(*way.start, rings.front());
    result.runout = fronts_along(paths, rings, cell).front().place;
}

/// How deep each place was covered ever, by flow or by what lies there.
Raster ever_covered(const LastPeaks& peaks) {
    Raster depth;
    depth.geometry = peaks.grid, depth.values = peaks.values.front();
    if (peaks.lying.empty()) return depth;
    Raster lying = depth;
    lying.values = peaks.lying;
    return deepest_cover(depth, lying);
}

void remark_on_width(const Raster& depth, const EnsembleBase& base, const Simulation& simulation,
                     SampleResult& result) {
    const double width = flow_width(depth, base.footprint_depth), cell = base.whole.cell;
    std::string text = width_remark(width, cell, !of_water_alone(simulation.extras()));
    if (!text.empty()) result.remarks.push_back({std::move(text), -width / cell});
}

void measure(const Scene& scene, const EnsembleBase& base, const RunSummary& run, const LastPeaks& peaks,
             const Raster& depth, double infiltrated, SampleResult& result) {
    std::vector<const double*> fields;
    for (const auto& field : peaks.values) fields.push_back(field.data());
    result.peaks = sparse_of(fields, depth.values.data(), peaks.grid, base.whole, base.footprint_depth);
    const double cell = base.whole.cell;
    result.footprint_area = static_cast<double>(result.peaks.pixels()) * cell * cell;
    result.max_depth = run.extremes.max_depth, result.max_speed = run.extremes.max_speed;
    const Status& last = run.last;
    const double taken = taken_of_bed(scene, peaks.grid, peaks.eroded);
    const double flowed = mass_flowed(run.first, last, taken);
    if (scene.erodible) result.eroded = taken / scene.erodible->density;
    const double taken_again = last.bed.eroded - taken;  // of what was left behind
    if (last.bed.deposited > 0.0) result.deposited = std::max(0.0, last.bed.deposited - taken_again) / scene.density;
    result.volume = flowed / scene.density;
    result.left_share = left_share(last.mass_left, infiltrated, flowed);
    result.mass_error = budget(run.first, last).mass_error;
    measure_extent(base, scene, depth, result);
}

void run_scene(const EnsemblePlan& plan, const EnsembleBase& base, const Scene& scene, const Interrupt& interrupt,
               std::unique_ptr<Observer> also, SampleResult& result) {
    const std::unique_ptr<Simulation> simulation = make_simulation(scene);
    Observers observers;
    auto owned = std::make_unique<LastPeaks>(plan.fields);
    const LastPeaks& peaks = *owned;
    observers.push_back(std::move(owned));
    auto owned_gauges = std::make_unique<GaugePeaks>(scene.gauges, base.footprint_depth);
    const GaugePeaks& gauges = *owned_gauges;
    if (!scene.gauges.empty()) observers.push_back(std::move(owned_gauges));
    if (also) observers.push_back(std::move(also));
    std::ostream nowhere(nullptr);
    Progress progress(nowhere, Progress::Style::silent, scene.density);
    RunPlan steps;
    steps.end = steps.every = scene.end;
    steps.stop_at_rest = scene.stop_at_rest;
    steps.cell = scene.bed.geometry.cell;
    steps.rest_fraction = scene.rest_fraction;
    const RunSummary run = frana::run(*simulation, steps, observers, interrupt, progress);
    result.reason = run.reason, result.message = run.failure_text, result.still_moves = run.still_moves();
    result.time = run.last.time, result.steps = run.steps;
    result.gauges = gauges.peaks();
    for (EndRemark& remark : remarks_at_end(*simulation, run)) result.remarks.push_back(std::move(remark));
    if (peaks.values.empty()) return;
    const Raster depth = ever_covered(peaks);
    remark_on_width(depth, base, *simulation, result);
    const std::optional<WaterBudget> water = simulation->extras().water;
    measure(scene, base, run, peaks, depth, water ? water->infiltrated_mass : 0.0, result);
}

/// Of what the scene was built from; those that the case makes too are told once, of the case.
std::vector<std::string> remarks_on_inputs(const Scene& scene, const EnsembleBase& base) {
    std::vector<std::string> remarks;
    for (const std::string& remark : scene.log)
        if (std::find(base.remarks.begin(), base.remarks.end(), remark) == base.remarks.end())
            remarks.push_back(remark);
    return remarks;
}

/// Of a bed that no run changes there is nothing to map. A key that varies may give one its bed.
void remark_on_fields_of_bed(const EnsemblePlan& plan, const Scene& scene, EnsembleBase& base) {
    const auto gives_bed = [](const Vary& vary) {
        const auto of = [&](const char* table) { return vary.key.rfind(table, 0) == 0; };
        return of("erodible.") || of("deposition.") || of("forest.");
    };
    if (scene.bed_changes() || std::any_of(plan.vary.begin(), plan.vary.end(), gives_bed)) return;
    for (const std::string& field : plan.fields)
        if (peak_field(field).of_bed)
            base.remarks.push_back(
                fmt::format("{}: ensemble.fields: found \"{}\"; expected a field of this case, since the bed does not "
                            "change; its maps are 0 everywhere, so take it out",
                            plan.file.string(), field));
}

}  // namespace

void require_kept_thresholds(const EnsemblePlan& plan, double footprint_depth, const std::string& table) {
    const auto asked = plan.exceed.find("peak_depth");
    if (asked == plan.exceed.end()) return;
    for (const double threshold : asked->second)
        if (threshold < footprint_depth)
            throw UserError(
                fmt::format("{}: {}.exceed.peak_depth: found {:g} m; expected at least the case's "
                            "output.footprint_depth = {:g} m, below which nothing is kept; raise it or lower that key",
                            plan.file.string(), table, threshold, footprint_depth));
}

std::vector<std::string> remarks_on_zones(const EnsemblePlan& plan, const CaseFile& file) {
    const std::string bed = "material.bed.";
    const auto varies = [&](const std::string& key) {
        return std::any_of(plan.vary.begin(), plan.vary.end(), [&](const Vary& vary) { return vary.key == key; });
    };
    std::vector<std::string> remarks;
    for (const Vary& vary : plan.vary) {
        if (vary.key.rfind(bed, 0) != 0) continue;
        std::string zones, keys;
        for (Index k = 0; k < file.count("material.zone"); ++k) {
            const std::string zone = fmt::format("material.zone.{}", k), key = zone + "." + vary.key.substr(bed.size());
            if (!file.given(key) || varies(key)) continue;
            zones += (zones.empty() ? "" : ", ") + zone, keys += (keys.empty() ? "" : ", ") + key;
        }
        if (!zones.empty())
            remarks.push_back(fmt::format("{} holds outside of zones that set it ({}); vary {} as well if it is meant",
                                          vary.key, zones, keys));
    }
    return remarks;
}

EnsembleBase ensemble_base(const EnsemblePlan& plan, const GisReader& reader, const MeshReader& meshes) {
    const CaseFile file = CaseFile::read(plan.case_file, quiet({}));
    require_tables(plan, file);
    const Scene scene = build_scene(file, reader, meshes);
    EnsembleBase base;
    base.remarks = scene.log;
    for (const std::string& remark : remarks_on_zones(plan, file)) base.remarks.push_back(remark);
    remark_on_fields_of_bed(plan, scene, base);
    base.bed = scene.bed;
    base.whole = scene.wider ? scene.wider->grid : scene.bed.geometry;
    base.title = scene.title;
    base.footprint_depth = scene.output.footprint_depth;
    base.gauges = scene.gauges;
    base.bed_changes = scene.bed_changes();
    base.barriers = scene.barriers;
    base.wider = scene.wider;
    Way way = way_of(scene, base.whole);
    base.start = way.start, base.path = std::move(way.path), base.others = std::move(way.others);
    if (!base.others.empty())
        base.remarks.push_back(
            fmt::format("the flow begins at {} places; runout and reach are those of the flow from {:.10g}, {:.10g}, "
                        "with all that touches it",
                        base.others.size() + 1, base.start->x(), base.start->y()));
    base.footprint = scene.survey;
    if (scene.survey) base.survey = rings_of(*scene.survey);
    require_kept_thresholds(plan, base.footprint_depth, "ensemble");
    return base;
}

std::vector<std::string> remarks_of_sample(const EnsemblePlan& plan, const EnsembleBase& base, Index sample,
                                           const GisReader& reader, const MeshReader& meshes) {
    std::vector<std::string> remarks;
    try {
        for (const std::string& remark : remarks_on_inputs(scene_of(plan, plan.sets_of(sample), reader, meshes), base))
            remarks.push_back(fmt::format("sample {}: {}", sample, remark));
    } catch (const UserError&) {  // its row in runs.csv says why
    }
    return remarks;
}

std::optional<SampleResult> run_sample(const EnsemblePlan& plan, const EnsembleBase& base, Index sample,
                                       const GisReader& reader, const MeshReader& meshes, const Interrupt& interrupt,
                                       std::unique_ptr<Observer> also) {
    SampleResult result;
    result.sample = sample;
    const auto start = std::chrono::steady_clock::now();
    try {
        const Scene scene = scene_of(plan, plan.sets_of(sample), reader, meshes);
        for (std::string& remark : remarks_on_inputs(scene, base)) result.remarks.push_back({std::move(remark)});
        run_scene(plan, base, scene, interrupt, std::move(also), result);
    } catch (const UserError& error) {  // one run that cannot be is a result of the ensemble, and stops no other
        result.reason = "refused", result.message = error.what();
    } catch (const NumericsError& error) {
        result.reason = "numerics", result.message = error.what();
    }
    if (result.reason == "interrupted") return std::nullopt;
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return result;
}

}  // namespace frana
