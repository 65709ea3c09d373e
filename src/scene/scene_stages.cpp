// The [[stage]]s of a case: particles first, or from the start 3D points.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scene/scene_parts.h"

namespace frana {
namespace {

class StageReader {
public:
    StageReader(const CaseFile& file, const Scene& scene, Problems& problems)
        : case_(file), scene_(scene), problems_(problems) {}

    std::optional<SolidStage> read() {
        const Index count = case_.count("stage");
        Index space = count;  // the 3D one
        for (Index i = 0; i < count; ++i) {
            prefix_ = fmt::format("stage.{}.", i);
            const bool in_3d = case_.word(prefix_ + "model") == "mpm3d";
            if (in_3d && space == count) space = i;
            if (space < count ? i > space + 1 || (in_3d && i > space) || space > 1 : i > 0)
                return refuse(i, "found it after the others",
                              "expected depth_averaged, then mpm3d, then depth_averaged, or a part of that",
                              "remove it; `frana convert` makes points of particles and particles of points besides");
            if (i + 1 < count && !given("until"))
                return refuse(i, "not given until, and another stage follows",
                              "expected the time at which the next stage begins", "add until = ... under [[stage]]");
        }
        require_no_end();
        if (space == count) return {};
        const double begin = space > 0 ? case_.number(fmt::format("stage.{}.until", space - 1)) : 0.0;
        prefix_ = fmt::format("stage.{}.", space);
        return solid(begin, space + 1 == count);
    }

private:
    std::optional<SolidStage> refuse(Index i, const char* found, const char* expected, const char* advice) {
        problems_.add(case_.table_place(fmt::format("stage.{}", i)), found, expected, advice);
        return {};
    }
    bool given(const char* name) const { return case_.given(prefix_ + name); }
    double number(const char* name) const { return case_.number(prefix_ + name); }
    double number_or(const char* name, double otherwise) const { return given(name) ? number(name) : otherwise; }

    /// Sizes that no 3D grid has: after a slip in the key, work or memory would have no end.
    void require_size(const SolidStage& stage) {
        const std::array<Index, 4>& w = stage.window;
        const double cell = scene_.bed.geometry.cell;
        const double side = static_cast<double>(std::min(w[2] - w[0], w[3] - w[1]) + 1) * cell;
        if (stage.cell > side)
            problems_.add(case_.place(prefix_ + "cell"), fmt::format("found {:.6g} m", stage.cell),
                          fmt::format("expected at most the window's shorter side, {:.6g} m", side),
                          "give a smaller cell, or a larger window");
        if (!stage.top) return;
        constexpr double kHighest = 10e3;  // above the ground: no avalanche rises so far [m]
        double low = INFINITY, high = -INFINITY;
        for (Index j = w[1]; j <= w[3]; ++j)
            for (Index i = w[0]; i <= w[2]; ++i) {
                const double z = scene_.bed.at(i, j);
                low = std::fmin(low, z), high = std::fmax(high, z);
            }
        if (!std::isfinite(high)) return;
        if (!(*stage.top > low))
            problems_.add(case_.place(prefix_ + "top"), fmt::format("found {:.6g} m", *stage.top),
                          fmt::format("expected more than the window's lowest ground, {:.6g} m", low),
                          "give an elevation a little above the highest that material reaches");
        if (*stage.top <= high + kHighest) return;
        problems_.add(case_.place(prefix_ + "top"), fmt::format("found {:.6g} m", *stage.top),
                      fmt::format("expected at most {:.6g} m, 10 km above the window's ground", high + kHighest),
                      "give an elevation a little above the highest that material reaches");
    }

    std::optional<SolidStage> solid(double begin, bool last) {
        SolidStage stage;
        stage.from = begin;
        if (begin >= scene_.end)
            problems_.add(case_.place("stage.0.until"), fmt::format("found {:.10g} s", begin),
                          fmt::format("expected a time before time.end = {:.10g} s", scene_.end),
                          "let the run end later, or the stage earlier");
        if (!last) read_end(stage);
        if (read_window(stage)) require_ground(stage);
        read_closed(stage);
        stage.cell = number_or("cell", 0.5 * scene_.bed.geometry.cell);
        stage.spacing = number_or("spacing", 0.5 * stage.cell);
        if (given("top")) stage.top = number("top");
        if (stage.spacing > stage.cell)
            problems_.add(
                case_.place(prefix_ + "spacing"), fmt::format("found {:.6g} m", stage.spacing),
                fmt::format("expected at most the stage's cell, {:.6g} m, or gaps open between the points", stage.cell),
                "give a smaller spacing, or a larger cell");
        if (given("sound_speed")) stage.sound_speed = number("sound_speed");
        require_size(stage);
        stage.law = law(stage);
        stage.stuck = given("stuck") && case_.flag(prefix_ + "stuck");
        stage.stuck_where_resolved = !given("stuck") && mud_of_bed() && !given("bed_friction");
        stage.split = given("split") ? case_.flag(prefix_ + "split") : solid::is_granular(stage.law);
        stage.bed_friction = number_or("bed_friction", friction_at_rest(scene_.bed_law));
        stage.whole_bed_law = !given("bed_friction") && (scene_.bed_laws() || hangs_on_speed(scene_.bed_law));
        stage.cfl = number("cfl");
        read_transfer(stage);
        stage.profile = profile_of(case_.word(prefix_ + "profile"));
        stage.along_bed = case_.word(prefix_ + "vertical") == "along-bed";
        return stage;
    }

    /// Of the last stage, whose keys are the ones that are read.
    void require_no_end() {
        if (case_.count("stage") == 0 || !given("until") || number("until") == scene_.end) return;
        problems_.add(case_.place(prefix_ + "until"), fmt::format("found {:.10g} s", number("until")),
                      fmt::format("expected none in the last stage, or time.end = {:.10g} s", scene_.end),
                      "remove it, or change time.end");
    }

    void read_end(SolidStage& stage) {
        stage.until = number("until");
        if (*stage.until > stage.from && *stage.until < scene_.end) return;
        problems_.add(case_.place(prefix_ + "until"), fmt::format("found {:.10g} s", *stage.until),
                      fmt::format("expected a time between the stage's begin, {:.10g} s, and time.end = {:.10g} s",
                                  stage.from, scene_.end),
                      "correct it, or remove the stage after it");
    }

    /// Sand flips: where layers of few cells flow, a step's damping holds them back. The pressure of fluids is
    /// quieter without.
    void read_transfer(SolidStage& stage) {
        const std::string word = given("transfer")               ? case_.word(prefix_ + "transfer")
                                 : solid::is_granular(stage.law) ? "flip"
                                                                 : "tpic";
        stage.transfer = word == "apic" ? Transfer::apic : word == "flip" ? Transfer::flip : Transfer::tpic;
        stage.blending = number_or("blending", std::sqrt(stage.cell / scene_.gravity));
        if (given("blending") && word != "flip")  // by default: a word that is given has its row of combinations
            problems_.add(case_.place(prefix_ + "blending"),
                          fmt::format("found with a law that has stage.transfer = \"{}\"", word),
                          "expected it with \"flip\" only", "remove it, or choose \"flip\"");
    }

    /// The cells whose nodes lie in the window.
    bool read_window(SolidStage& stage) {
        const GridGeometry& g = scene_.bed.geometry;
        stage.window = {0, 0, g.nx - 1, g.ny - 1};
        if (!given("window")) return true;
        const auto& w = case_.numbers(prefix_ + "window");
        const auto e = (scene_.wider ? scene_.wider->grid : g).pixel_extent();
        const bool inside = w[0] >= e[0] && w[1] >= e[1] && w[2] <= e[2] && w[3] <= e[3];
        constexpr double kRoundOff = 1e-9;
        const auto first = [&](double at, double start) {
            return static_cast<Index>(std::ceil((at - start) / g.cell - kRoundOff));
        };
        const auto last = [&](double at, double start) {
            return static_cast<Index>(std::floor((at - start) / g.cell + kRoundOff));
        };
        stage.window = {first(w[0], g.x0), first(w[1], g.y0), last(w[2], g.x0), last(w[3], g.y0)};
        if (inside && w[0] < w[2] && w[1] < w[3] && stage.window[2] - stage.window[0] >= 2 &&
            stage.window[3] - stage.window[1] >= 2)
            return true;
        stage.window = {0, 0, g.nx - 1, g.ny - 1};
        problems_.add(
            case_.place(prefix_ + "window"), "found " + toml_text(w),
            fmt::format("expected [xmin, ymin, xmax, ymax] of at least 3 x 3 cells of {:.6g} m within x {:.10g} "
                        "to {:.10g}, y {:.10g} to {:.10g}",
                        g.cell, e[0], e[2], e[1], e[3]),
            "correct the coordinates, or widen terrain.window");
        return false;
    }

    void read_closed(SolidStage& stage) {
        const char* const sides[] = {"west", "south", "east", "north"};
        const auto& closed = case_.words(prefix_ + "closed");
        for (std::size_t side = 0; side < 4; ++side)
            stage.closed[side] = std::find(closed.begin(), closed.end(), sides[side]) != closed.end();
        const GridGeometry& g = scene_.bed.geometry;
        if (!are_closed(scene_.sides)) return;  // walls of the terrain hold points back as well
        const std::array<Index, 4> wall = {0, 0, g.nx - 1, g.ny - 1};
        for (std::size_t side = 0; side < 4; ++side) {
            // Points go on for a cell beyond an open side, which would be through a wall that is nearer.
            if (std::abs(stage.window[side] - wall[side]) > (stage.closed[side] ? 0 : 1)) continue;
            stage.window[side] = wall[side];
            stage.closed[side] = true;
            stage.mirrors[side] = scene_.sides == Sides::mirror;
        }
    }

    /// 3D points need ground below them everywhere.
    void require_ground(const SolidStage& stage) {
        const std::array<Index, 4>& w = stage.window;
        for (Index j = w[1]; j <= w[3]; ++j)
            for (Index i = w[0]; i <= w[2]; ++i) {
                if (std::isfinite(scene_.bed.at(i, j))) continue;
                const GridGeometry& g = scene_.bed.geometry;
                problems_.add(given("window") ? case_.place(prefix_ + "window")
                                              : case_.table_place(prefix_.substr(0, prefix_.size() - 1)),
                              fmt::format("found no elevation at x {:.10g}, y {:.10g}", g.x(i), g.y(j)),
                              "expected ground everywhere in the window", "give a window without nodata");
                return;
            }
    }

    /// The 3D material of the case, where the stage names no law. It is mud or a fluid by its rheology. Without one,
    /// and with friction at the bed, it is sand with the same friction inside.
    std::string law_of_case() const {
        if (given("law")) return case_.word(prefix_ + "law");
        if (std::holds_alternative<rheology::Bingham>(scene_.rheology)) return "bingham";
        if (const bed::Bingham* mud = mud_of_bed()) return mud->yield_stress > 0.0 ? "bingham" : "fluid";
        const bool viscous = std::holds_alternative<rheology::Newtonian>(scene_.rheology) || given("viscosity");
        return viscous || !(friction_at_rest(scene_.bed_law) > 0.0) ? "fluid" : "of_bed";
    }

    /// A bed law that stands for mud that shears over its depth, where no rheology says otherwise.
    const bed::Bingham* mud_of_bed() const {
        if (given("law") || !std::holds_alternative<rheology::None>(scene_.rheology)) return nullptr;
        return std::get_if<bed::Bingham>(&scene_.bed_law);
    }

    /// Whether a stage of that law has a number of the case's rheology.
    bool takes_rheology(const std::string& law) const {
        const bool viscous = (law == "fluid" || law == "bingham") && !given("viscosity");
        const bool yields = (law == "bingham" || law == "herschel_bulkley") && !given("yield_stress") &&
                            std::holds_alternative<rheology::Bingham>(scene_.rheology);
        return viscous || yields;
    }

    SolidLaw law(SolidStage& stage) {
        const std::string law = law_of_case();
        if (mud_of_bed() && scene_.bed_laws())
            problems_.add(case_.place("material.bed.law"),
                          "found \"bingham\" that varies from place to place, with a stage",
                          "expected one yield stress and viscosity: mud in 3D has the same everywhere",
                          "name the stage's law, or remove what makes material.bed differ");
        if (scene_.rheologies() && takes_rheology(law))
            problems_.add(
                case_.place("material.rheology.law"),
                fmt::format("found \"{}\" that varies from place to place, with a stage that takes its numbers",
                            case_.word("material.rheology.law")),
                "expected one of each: material in 3D has the same everywhere",
                "give stage.viscosity and stage.yield_stress, or remove what makes material.rheology differ");
        if (law == "of_bed") return law_of_bed(stage);
        stage.fluid_by_drag = law == "fluid" && hangs_on_speed(scene_.bed_law) && !given("law") &&
                              !given("viscosity") && !mud_of_bed() &&
                              std::holds_alternative<rheology::None>(scene_.rheology);
        refuse_others(law, [&](const std::string& key) { return solid::has_key(law, key); });
        const solid::Values value = [&](const std::string& name) { return value_of(name); };
        if (solid::has_key(law, "yield_stress") && !(value("yield_stress").value_or(0.0) > 0.0))
            problems_.add(case_.place(prefix_ + "law"), fmt::format("found \"{}\" without a yield stress", law),
                          "expected stage.yield_stress, or that of material.rheology", "give one, or choose \"fluid\"");
        if (law == "mu_i" && !has_grains()) return {};
        if (solid::has_key(law, "cohesion") && !has_apex(*value("friction_angle_deg"), *value("cohesion"))) return {};
        return solid::make(law, value);
    }

    /// Without a law of its own: sand as strong as the bed's friction, or grains with the bed's mu(I). Of their keys the
    /// speed of sound alone may be given. Where mu(I) varies, or stage.bed_friction stands in its place, it is sand.
    SolidLaw law_of_bed(SolidStage& stage) {
        stage.of_bed = true;
        const auto sound_alone = [](const std::string& key) { return key == "sound_speed"; };
        if (grains_of_bed() != nullptr && !scene_.bed_laws() && !given("bed_friction")) {
            refuse_others("mu_i by the bed's friction", sound_alone);
            return solid::MuI::grains([&](const std::string& name) { return of_grains(name); });
        }
        refuse_others("drucker_prager by the bed's friction", sound_alone);
        return solid::DruckerPrager::of({}, std::atan(friction_at_rest(scene_.bed_law)), 0.0);
    }

    const bed::Pouliquen* grains_of_bed() const { return std::get_if<bed::Pouliquen>(&scene_.bed_law); }

    /// A number of the bed's mu(I), by its name there and in mu_i.
    std::optional<double> of_grains(const std::string& name) const {
        const bed::Pouliquen* grains = grains_of_bed();
        if (grains == nullptr) return {};
        for (const auto& key : bed::Pouliquen::keys())
            if (name == key.name) return grains->*key.parameter;
        return {};
    }

    /// mu_i has its grains from the stage or from the bed's law.
    bool has_grains() {
        const char* const numbers[] = {"mu_s", "mu_2", "i0", "grain_diameter", "solid_fraction"};
        const bool all_given =
            std::all_of(std::begin(numbers), std::end(numbers), [&](auto* name) { return given(name); });
        if (scene_.bed_laws() && grains_of_bed() != nullptr && !all_given) {
            problems_.add(case_.place("material.bed.law"),
                          "found \"pouliquen\" that varies from place to place, with a stage that takes its numbers",
                          "expected one mu(I): grains in 3D have the same everywhere",
                          "give all of stage.mu_s, mu_2, i0, grain_diameter, solid_fraction, or remove what makes "
                          "material.bed differ");
            return false;
        }
        std::string missing;
        for (const char* name : {"mu_s", "mu_2", "grain_diameter"})
            if (!value_of(name)) missing += (missing.empty() ? "" : ", ") + std::string("stage.") + name;
        if (!missing.empty())
            problems_.add(case_.place(prefix_ + "law"), "found \"mu_i\" without " + missing,
                          "expected it here, or material.bed.law = \"pouliquen\", which has it", "give one of both");
        if (!missing.empty()) return false;
        if (*value_of("mu_2") > *value_of("mu_s")) return true;
        problems_.add(case_.place(prefix_ + "law"),
                      fmt::format("found mu_2 = {:.6g} with mu_s = {:.6g}", *value_of("mu_2"), *value_of("mu_s")),
                      "expected mu_2 above mu_s",
                      "mu_s is the friction of slow flow, mu_2 that of fast flow; correct one");
        return false;
    }

    /// Of a key of the stage's law, in the case or by default; else what the case's material has of that name.
    std::optional<double> value_of(const std::string& name) const {
        const std::string key = prefix_ + name;
        if (case_.has(key)) {
            const std::vector<std::string>& choices = find_parameter(key)->choices;
            if (choices.empty()) return case_.number(key);
            return static_cast<double>(std::find(choices.begin(), choices.end(), case_.word(key)) - choices.begin());
        }
        if (const std::optional<double> grains = of_grains(name)) return grains;
        const bed::Bingham* mud = mud_of_bed();
        if (name == "viscosity") {
            if (const auto* newtonian = std::get_if<rheology::Newtonian>(&scene_.rheology)) return newtonian->viscosity;
            if (const auto* bingham = std::get_if<rheology::Bingham>(&scene_.rheology)) return bingham->viscosity;
            if (mud != nullptr) return mud->viscosity;
        }
        if (name == "yield_stress") {
            if (const auto* bingham = std::get_if<rheology::Bingham>(&scene_.rheology)) return bingham->yield_stress;
            if (mud != nullptr) return mud->yield_stress;
        }
        return {};
    }

    /// The cone's apex lies at the tension cohesion / tan(angle): without an angle there is none.
    bool has_apex(double angle, double cohesion) {
        if (angle > 0.0 || !(cohesion > 0.0)) return true;
        problems_.add(case_.place(prefix_ + "friction_angle_deg"),
                      fmt::format("found {:.6g} with stage.cohesion = {:.6g} Pa", angle, cohesion),
                      "expected an angle above 0: the cone of a cohesive material has an apex",
                      "give an angle, a small one for clay that does not drain, or leave out the cohesion");
        return false;
    }

    /// Keys of laws that this one does not take.
    template <class Takes>
    void refuse_others(const std::string& law, const Takes& takes) {
        for (const solid::SharedKey& shared : solid::shared_keys())
            if (given(shared.key.name) && !takes(shared.key.name)) unused(shared.key.name, law);
    }

    void unused(const char* name, const std::string& law) {
        problems_.add(case_.place(prefix_ + name), fmt::format("found, but the law \"{}\" does not use it", law),
                      "expected it with another law only", "remove it, or choose another stage.law");
    }

    static VelocityProfile profile_of(const std::string& word) {
        if (word == "linear") return VelocityProfile::linear;
        if (word == "parabolic") return VelocityProfile::parabolic;
        return word == "bagnold" ? VelocityProfile::bagnold : VelocityProfile::plug;
    }

    const CaseFile& case_;
    const Scene& scene_;
    Problems& problems_;
    std::string prefix_;
};

}  // namespace

std::optional<SolidStage> read_solid_stage(const CaseFile& file, const Scene& scene, Problems& problems) {
    return StageReader(file, scene, problems).read();
}

}  // namespace frana
