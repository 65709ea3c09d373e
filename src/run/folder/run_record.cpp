#include "run/folder/run_record.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/version.h"
#include "run/folder/left_terrain.h"
#include "run/folder/run_page.h"
#include "scene/case_file.h"
#include "scene/flow_start.h"
#include "scene/inflow_facts.h"
#include "scene/remarks.h"

namespace frana {
namespace {

using Json = nlohmann::ordered_json;

Json places_in(const std::vector<Vec2>& places) {
    Json json = Json::array();
    for (const Vec2& place : places) json.push_back({place.x(), place.y()});
    return json;
}

/// Values of a given key as text, with its unit from the parameter table.
std::vector<GivenKey> given_keys(const CaseFile& file) {
    std::vector<GivenKey> rows;
    const auto add = [&](const std::string& key, const Parameter& parameter) {
        if (file.given(key)) rows.push_back({key, toml_text(*file.find(key)), parameter.unit});
    };
    for (const Parameter& parameter : parameters()) {
        bool repeated = false;
        for (const std::string& table : repeated_tables()) {
            if (parameter.table() != table) continue;
            repeated = true;
            for (Index i = 0; i < file.count(table); ++i)
                add(fmt::format("{}.{}.{}", table, i, parameter.name()), parameter);
        }
        if (!repeated) add(parameter.key, parameter);
    }
    return rows;
}

/// "released 8391 m3, inflow 400 m3, ": what makes pictures differ though the material is the same.
std::string volumes_of(const Scene& scene) {
    double released = 0.0, inflow = 0.0;
    for (const Seeds* seeds : scene.all_particles())
        for (const double volume : seeds->volume) released += volume;
    for (const Inflow& source : scene.inflows) inflow += facts_of(source, scene.gravity).volume;
    std::string text;
    if (released > 0.0) text += fmt::format("released {:.6g} m3, ", released);
    if (inflow > 0.0) text += fmt::format("inflow {:.6g} m3, ", inflow);
    return text;
}

/// "released 8391 m3, density 1800 kg/m^3, bed.law voellmy, ..., terrain model steep, cells of 5 m".
std::string caption_of(const Scene& scene, const std::vector<GivenKey>& given) {
    std::string text = volumes_of(scene);
    for (const GivenKey& key : given) {
        const std::string table = key.key.substr(0, key.key.find('.'));
        const bool material = table == "material";
        if (!material && table != "water" && table != "erodible" && table != "deposition" && table != "forest")
            continue;
        std::string value = key.value;
        value.erase(std::remove(value.begin(), value.end(), '"'), value.end());
        if (value.size() > 2 && value.compare(value.size() - 2, 2, ".0") == 0) value.resize(value.size() - 2);
        const bool word = !key.value.empty() && key.value.front() == '"';
        const bool has_unit = !key.unit.empty() && key.unit != "1" && !word;
        text += fmt::format("{} {}{}{}, ", material ? key.key.substr(9) : key.key, value, has_unit ? " " : "",
                            has_unit ? key.unit : "");
    }
    const char* model = scene.terrain == TerrainModel::steep     ? "steep"
                        : scene.terrain == TerrainModel::shallow ? "shallow"
                                                                 : "linearised";
    return text + fmt::format("terrain model {}, cells of {:.6g} m", model, scene.bed.geometry.cell);
}

Json phases(const std::vector<PhaseTime>& parts) {
    Json result = Json::object();
    for (const PhaseTime& part : parts) result[part.name] = part.seconds;
    return result;
}

Json time_json(const RunSummary& s) {
    return {{"total", s.wall_seconds},
            {"solver", phases(s.solver)},
            {"output", phases(s.output)},
            {"output_total", s.output_seconds()},
            {"output_share", s.output_share()}};
}

Json mass_json(const RunRecord& record) {
    const RunSummary& s = record.summary;
    return {{"unit", "kg"},
            {"initial", s.first.mass},
            {"final", s.last.mass},
            {"came_in", mass_came_in(s.first, s.last)},
            {"left_domain", s.last.mass_left},
            {"left_share", left_share(record)},
            {"relative_error", budget(s.first, s.last).mass_error}};
}

Json momentum_json(const RunSummary& s) {
    return {{"unit", "kg m/s"},          {"initial", s.first.momentum},
            {"final", s.last.momentum},  {"left_domain", s.last.momentum_left},
            {"impulse", s.last.impulse}, {"residual", budget(s.first, s.last).momentum_residual}};
}

Json energy_json(const RunSummary& s) {
    return {{"unit", "J"},
            {"kinetic", s.last.kinetic},
            {"potential", s.last.potential},
            {"dissipated", s.last.dissipated},
            {"left_domain", s.last.energy_left},
            {"bed", s.last.bed.energy - s.first.bed.energy},
            {"stored", s.last.stored},
            {"points",
             {{"friction", s.last.in_3d.friction},
              {"walls", s.last.in_3d.walls},
              {"material", s.last.in_3d.material},
              {"numerical", s.last.in_3d.numerical}}},
            {"potential_initial", s.first.potential},
            {"kinetic_initial", s.first.kinetic},
            {"stored_initial", s.first.stored},
            {"residual", budget(s.first, s.last).energy_residual}};
}

Json bed_json(const RunRecord& record) {
    const RunSummary& s = record.summary;
    const Status::Bed& bed = s.last.bed;
    return {{"unit", "kg"},
            {"initial", bed.initial},
            {"eroded", bed.eroded},
            {"deposited", bed.deposited},
            {"final", bed.mass},
            {"taken_of_bed", record.taken_of_bed},
            {"taken_again", taken_again(record)},
            {"lies_behind", lies_behind(record)},
            {"relative_error", budget(s.first, s.last).bed_error},
            {"deepest", {{"unit", "m"}, {"eroded", bed.deepest}}}};
}

Json insitu_json(const std::vector<InsituTally>& tallies) {
    Json result = Json::array();
    for (const InsituTally& tally : tallies)
        result.push_back({{"name", tally.name},
                          {"kind", tally.kind},
                          {"made", tally.made},
                          {"failed", tally.failed},
                          {"first_failure", tally.first_failure}});
    return result;
}

Json results_json(const RunRecord& record) {
    const Extremes& most = record.summary.extremes;
    return {{"max_depth", most.max_depth},
            {"max_depth_time", most.max_depth_time},
            {"max_speed", most.max_speed},
            {"max_speed_time", most.max_speed_time},
            {"max_front", most.max_front},
            {"front_from", record.front_origin},
            {"footprint_area", record.footprint_area},
            {"footprint_depth", record.footprint_depth},
            {"flow_width", std::isfinite(record.flow_width) ? Json(record.flow_width) : Json(nullptr)},
            {"start", record.particles == 0 && !record.starts.empty()
                          ? Json{record.starts.front().x(), record.starts.front().y()}
                          : Json(nullptr)},
            {"starts", places_in(record.starts)},
            {"final_max_depth", record.final_depth},
            {"final_max_flow_depth", record.final_flow_depth},
            {"peak_pressure", record.peak_pressure},
            {"peak_dynamic_pressure", record.peak_dynamic_pressure}};
}

Json flow_width_cells(const RunRecord& record) {
    if (!std::isfinite(record.flow_width)) return nullptr;  // nothing was covered
    return record.flow_width / record.grid.cell;
}

}  // namespace

RunRecord begin_record(const Scene& scene, const CaseFile& file) {
    RunRecord record;
    record.name = scene.name;
    record.title = scene.title.empty() ? scene.name : scene.title;
    record.case_file = scene.case_file.string();
    record.survey_files = survey_files(file);
    record.barrier_sources = barrier_sources(file);
    record.release_sources = release_sources(file);
    const std::vector<std::string> formats = file.words("output.formats");
    record.netcdf = std::find(formats.begin(), formats.end(), "netcdf") != formats.end();
    record.given = given_keys(file);
    record.caption = caption_of(scene, record.given);
    record.grid = scene.wider ? scene.wider->grid : scene.bed.geometry;
    record.has_crs = !scene.bed.crs_wkt.empty();
    record.density = scene.density;
    if (scene.friction) record.friction = scene.friction->parts;
    record.particles = scene.particles.count();
    for (const double volume : scene.particles.volume) record.release_volume += volume;
    record.volume_of_releases = record.release_volume;
    record.end = record.whole_end = scene.end;
    if (file.given("time.end")) record.whole_end = file.number("time.end");
    record.footprint_depth = scene.output.footprint_depth;
    record.starts = starts_of_what_comes_in(scene);
    record.front_origin = front_origin(scene);
    record.page = asks_for_page(file);
    record.by_trees_alone = scene.forest && !scene.deposition;
    record.warnings = scene.log;
    record.gauges = scene.gauges;
    record.inflows = inflow_places(file, scene.bed.crs_wkt, record.warnings);
    join_remarks_on_coordinates(record.warnings);
    return record;
}

double released_later(const RunRecord& record) {
    double sum = 0.0;
    for (const LateEntry& late : record.extras.late)
        if (late.entered) sum += late.volume;
    return sum;
}

double taken_again(const RunRecord& record) {
    const Status::Bed& bed = record.summary.last.bed;
    constexpr double kRoundOff = 1e-12;
    const double again = bed.eroded - record.taken_of_bed;
    return bed.deposited > 0.0 && again > kRoundOff * bed.eroded ? again : 0.0;
}

double lies_behind(const RunRecord& record) { return record.summary.last.bed.deposited - taken_again(record); }

/// "1.2 % of the mass is still faster than 0.1 m/s along the map, the fastest, films too, has 3.4 m/s".
std::string motion_text(const RunSummary& s) {
    return fmt::format(
        "{:.3g} % of the mass {} faster than {:.2g} m/s along the map, the fastest, films too, has {:.3g} m/s",
        100.0 * s.motion.share(), s.motion.share() > 0.0 ? "is still" : "is", s.slow, s.motion.fastest);
}

/// Whether a rule, or the end of the time, stopped what was still in motion.
bool stopped_in_motion(const RunSummary& s) { return s.ended_by_rule() && s.motion.fastest > 0.0; }

bool nothing_came(const RunRecord& record) {
    const Status &first = record.summary.first, &last = record.summary.last;
    const bool to_come = record.extras.inflow || !record.extras.late.empty();
    return to_come && first.mass == 0.0 && last.mass == 0.0 && last.mass_in == 0.0;
}

bool more_to_come(const RunRecord& record) {
    constexpr double kNone = 1e-9;  // of the tables: round-off of their sums
    const auto& inflow = record.extras.inflow;
    const auto waits = [](const LateEntry& late) { return late.at && !late.entered; };
    return (inflow && inflow->tables - inflow->expected > kNone * inflow->tables) ||
           std::any_of(record.extras.late.begin(), record.extras.late.end(), waits);
}

std::string reason_text(const RunRecord& record) {
    const RunSummary& summary = record.summary;
    const bool moves = stopped_in_motion(summary);
    const char* const still = nothing_came(record)   ? "no material has come in yet"
                              : more_to_come(record) ? "nothing moves, but not all material has come in yet"
                                                     : "nothing moves any more";
    if (summary.reason == "until")
        return fmt::format("stopped by --until at {:.6g} of {:.6g} s; --resume goes on: {}", record.end,
                           record.whole_end, moves ? motion_text(summary) : still);
    if (summary.reason == "end")
        return moves ? "stopped by the rule time.end, the simulated time is over: " + motion_text(summary)
                     : fmt::format("the simulated time is over, and {}", still);
    if (summary.reason == "rest")
        return moves ? "stopped by the rule time.stop_at_rest, what still moves can change the deposit no more: " +
                           motion_text(summary)
                     : "the mass came to rest";
    if (summary.reason == "left")
        return summary.last.bed.deposited > 0.0 ? "no flow is left: it has become bed, or left the domain"
                                                : "no material is left in the domain";
    if (summary.reason == "interrupted") return "interrupted; everything up to here is valid";
    return summary.reason + ": " + summary.failure_text;
}

/// Why the run ended, and what was in motion then.
Json rest_json(const RunRecord& record) {
    const RunSummary& s = record.summary;
    return {{"reason", !s.ended_by_rule()     ? s.reason
                       : stopped_in_motion(s) ? "stopped by the rule"
                       : nothing_came(record) ? "before any material came in"
                       : more_to_come(record) ? "before all material came in"
                                              : "at rest"},
            {"moving_mass_share", s.motion.share()},
            {"faster_than", s.slow},
            {"fastest", s.motion.fastest}};
}

Json means_json(const std::vector<MeanForce>& means) {
    Json list = Json::array();
    for (const MeanForce& m : means)
        list.push_back({{"averaged_over", m.window},
                        {"largest", m.largest},
                        {"time", m.time},
                        {"force", {m.force[0], m.force[1], m.force[2]}},
                        {"moment", {m.moment[0], m.moment[1], m.moment[2]}}});
    return list;
}

/// `moments`: moments about a point of each barrier are known.
Json barriers_json(const std::vector<BarrierSummary>& barriers, bool moments) {
    Json list = Json::array();
    for (const BarrierSummary& b : barriers) {
        const bool measured = b.blur > 0.0;  // forces; particles alone tell none
        const auto if_measured = [&](double number) { return measured ? Json(number) : Json(nullptr); };
        list.push_back({{"name", b.name},
                        {"first_contact", b.first_contact >= 0.0 ? Json(b.first_contact) : Json(nullptr)},
                        {"peak_force", if_measured(b.peak_force)},
                        {"peak_force_time", if_measured(b.peak_force_time)},
                        {"averaged_over", if_measured(b.blur)},
                        {"raw_peak_force", if_measured(b.raw_peak_force)},
                        {"mean_forces", means_json(measured ? b.means : std::vector<MeanForce>())},
                        {"impulse", measured ? Json{b.impulse[0], b.impulse[1], b.impulse[2]} : Json(nullptr)},
                        {"moments_about", moments ? Json{b.about[0], b.about[1], b.about[2]} : Json(nullptr)},
                        {"run_up", std::isfinite(b.run_up) ? Json(b.run_up) : Json(nullptr)},
                        {"overtopped_volume", b.overtopped}});
    }
    return list;
}

Json inflow_json(const InflowBudget& inflow) {
    const double error = inflow.expected > 0.0 ? (inflow.volume - inflow.expected) / inflow.expected : 0.0;
    return {{"unit", "m3"},
            {"volume", inflow.volume},
            {"expected", inflow.expected},
            {"tables", inflow.tables},
            {"relative_error", error}};
}

Json late_json(const std::vector<LateEntry>& entries) {
    Json list = Json::array();
    for (const LateEntry& late : entries)
        list.push_back({{"name", late.name},
                        {"volume", late.volume},
                        {"when_hit", !late.at},
                        {"included_in_dem", late.of_bed},
                        {"at", late.at ? Json(*late.at) : Json(nullptr)},
                        {"entered", late.entered ? Json(*late.entered) : Json(nullptr)}});
    return list;
}

Json sections_json(const std::vector<SectionSummary>& sections) {
    Json list = Json::array();
    for (const SectionSummary& s : sections)
        list.push_back({{"name", s.name},
                        {"towards", {s.towards.x(), s.towards.y()}},
                        {"volume", s.volume},
                        {"sediment", s.sediment},
                        {"discharge_integral", s.integral},
                        {"peak_discharge", s.peak},
                        {"peak_discharge_time", s.peak_time}});
    return list;
}

Json friction_json(const std::vector<FrictionPart>& parts) {
    Json list = Json::array();
    for (const FrictionPart& part : parts) {
        Json one = {{"name", part.name}, {"area", part.area}};
        for (const FrictionPart::Extent& of : part.extents)
            one[of.key] = {{"unit", of.unit}, {"low", of.low}, {"high", of.high}};
        list.push_back(one);
    }
    return list;
}

Json breakage_json(const Breakage& b) {
    return {{"mean_damage", b.damage},
            {"pieces", b.pieces},
            {"neighbour_pairs", b.pairs},
            {"torn_pairs", b.torn},
            {"torn_without_damage", b.numerical},
            {"sub_cycling", b.sub_cycling},
            {"barriers_and_walls", {{"impulse", {{"unit", "kg m/s"}, {"x", b.pushed[0]}, {"y", b.pushed[1]}}}}}};
}

Json apart_json(const PointsApart& a) {
    return {{"pieces", a.pieces},
            {"share_apart", a.apart},
            {"share_alone", a.alone},
            {"most_apart", a.most_apart},
            {"most_apart_time", a.most_apart_time}};
}

Json water_json(const WaterBudget& w) {
    return {{"unit", "m3"},
            {"given", w.given},
            {"free", w.free},
            {"confined", w.confined},
            {"released", w.released},
            {"rained", w.rained},
            {"entered", w.entered},
            {"fed", w.fed},
            {"infiltrated", w.infiltrated},
            {"left_domain", w.left},
            {"residual", w.residual},
            {"relative_error", w.residual / std::max(w.given + w.rained + w.entered + w.fed, 1e-300)},
            {"energy_lost", {{"unit", "J"}, {"bed", w.bed}, {"viscosity", w.viscosity}, {"drag", w.drag}}},
            {"column_steps_per_water_step", w.steps}};
}

std::string run_json(const RunRecord& record) {
    const RunSummary& s = record.summary;
    const double per_second = s.wall_seconds > 0.0 ? s.particle_steps / s.wall_seconds : 0.0;
    Json figures = Json::array();
    for (const DrawnFigure& figure : record.figures) figures.push_back(figure.path);
    Json json = {{"version", FRANA_VERSION},
                 {"build", {{"type", FRANA_BUILD_TYPE}, {"compiler", FRANA_COMPILER}, {"arch", FRANA_ARCH}}},
                 {"case", record.name},
                 {"title", record.title},
                 {"caption", record.caption},
                 {"case_file", record.case_file},
                 {"overrides", record.command_line},
                 {"started", s.started},
                 {"ended", s.ended},
                 {"host_threads", std::thread::hardware_concurrency()},
                 {"threads", record.threads},
                 {"exit_reason", s.reason},
                 {"rest", rest_json(record)},
                 {"failure", s.failure_text},
                 {"simulated_time", s.last.time},
                 {"steps", s.steps},
                 {"frames", s.frames},
                 {"grid", {{"nx", record.grid.nx}, {"ny", record.grid.ny}, {"cell", record.grid.cell}}},
                 {"particles", {{"initial", record.particles}, {"final", s.last.particles}}},
                 {"density", record.density},
                 {"release_volume", record.release_volume},
                 {"release_volume_later", released_later(record)},
                 {"wall_seconds", time_json(s)},
                 {"particle_steps", s.particle_steps},
                 {"particle_steps_per_second", per_second},
                 {"budgets", {{"mass", mass_json(record)}, {"momentum", momentum_json(s)}, {"energy", energy_json(s)}}},
                 {"results", results_json(record)},
                 {"flow_width_cells", flow_width_cells(record)},
                 {"p2g_error_max", {{"mass", s.extremes.p2g_mass_error}, {"momentum", s.extremes.p2g_momentum_error}}},
                 {"figures", figures},
                 {"insitu", insitu_json(record.insitu)},
                 {"barriers", barriers_json(record.barriers, !record.extras.breakage)},
                 {"checkpoints",
                  {{"written", record.checkpoints.written},
                   {"failed", record.checkpoints.failed},
                   {"resumed_at", record.checkpoints.resumed_at}}},
                 {"remarks", record.warnings},
                 {"warnings", record.warnings},  // their earlier name
                 {"files", record.files}};
    if (record.extras.points_apart) json["points_apart"] = apart_json(*record.extras.points_apart);
    if (record.extras.breakage) json["structure"] = breakage_json(*record.extras.breakage);
    if (record.extras.water) {
        json["budgets"]["water"] = water_json(*record.extras.water);
        json["budgets"]["mass"]["infiltrated"] = record.extras.water->infiltrated_mass;
    }
    if (record.extras.inflow) json["budgets"]["inflow"] = inflow_json(*record.extras.inflow);
    if (!record.extras.late.empty()) json["late_releases"] = late_json(record.extras.late);
    if (s.last.bed.initial > 0.0 || s.last.bed.deposited > 0.0) json["budgets"]["bed"] = bed_json(record);
    if (!record.friction.empty()) json["friction"] = friction_json(record.friction);
    if (record.friction_of_part) json["friction_of_part"] = true;
    if (!record.sections.empty()) json["sections"] = sections_json(record.sections);
    return json.dump(2) + "\n";
}

}  // namespace frana
