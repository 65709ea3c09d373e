// What of a case that can run is worth a remark: scene/remarks.h says from which number on.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "base/number_text.h"
#include "scene/inflow_facts.h"
#include "scene/parameter_ranges.h"
#include "scene/remarks.h"
#include "scene/salm_table.h"
#include "scene/scene_parts.h"

namespace frana {
namespace {

/// "dem.tif dem_metres.tif": what a line of gdal_translate ends with.
std::string into(const std::string& source, const char* suffix) {
    const std::string file = source.empty() ? "dem.tif" : source;
    const std::size_t dot = file.rfind('.');
    return fmt::format("{} {}{}.tif", file, file.substr(0, dot), suffix);
}

/// A band of exact zeros, two nodes and more wide, that ends at a step of more than 60 degrees. A low coast at sea
/// level is none: there most of the band's edge is flat.
void remark_zero_margin(Scene& scene, const std::string& place) {
    constexpr double kCliff = 1.7320508075688772;  // tangent of 60 degrees
    constexpr Index kSmeared = 3;                  // cells over which resampling smears a step
    const GridGeometry& g = scene.bed.geometry;
    Index rim = 0, cliffs = 0;
    double highest = 0.0;
    const auto sample = [&](Index i, Index j, Index di, Index dj) {
        const Index ahead_i = i + kSmeared * di, ahead_j = j + kSmeared * dj, behind_i = i - di, behind_j = j - dj;
        const auto inside = [&](Index a, Index b) { return a >= 0 && b >= 0 && a < g.nx && b < g.ny; };
        if (!inside(ahead_i, ahead_j) || !inside(behind_i, behind_j)) return;
        if (scene.bed.at(behind_i, behind_j) != 0.0 || scene.bed.at(i + di, j + dj) == 0.0) return;
        const double step = std::abs(scene.bed.at(ahead_i, ahead_j));
        if (!std::isfinite(step)) return;
        ++rim;
        if (step <= kCliff * double(kSmeared) * g.cell) return;
        ++cliffs;
        highest = std::max(highest, step);
    };
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i)
            if (scene.bed.at(i, j) == 0.0)
                for (const auto& [di, dj] : {std::pair<Index, Index>{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
                    sample(i, j, di, dj);
    remark_on(scene.log, Remark::zero_margin, place,
              {2 * cliffs > rim ? double(cliffs) : 0.0, highest, into(scene.bed.source, "_nodata")});
}

/// Heights in feet are 3.28 times as high, and ground of 28 degrees then has 60.
void remark_feet(Scene& scene, const std::string& place) {
    constexpr double kSteep2 = 3.0;  // square of the tangent of 60 degrees
    const GridGeometry& g = scene.bed.geometry;
    Index known = 0, steep = 0;
    double highest = -INFINITY;
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) {
            if (std::isnan(scene.bed.at(i, j))) continue;
            ++known;
            highest = std::max(highest, scene.bed.at(i, j));
            if (node_gradient(scene.bed, i, j).squaredNorm() > kSteep2) ++steep;
        }
    const std::string files = into(scene.bed.source, "_metres");
    remark_on(scene.log, Remark::steep_as_in_feet, place, {100.0 * double(steep) / double(known), 0.0, files});
    remark_on(scene.log, Remark::high_as_in_feet, place, {highest, 0.0, files});
}

/// Whether a value lies in a range but for round-off.
bool lies_in(double value, double low, double high) {
    constexpr double round_off = 1e-9;
    return value >= low * (1.0 - round_off) && value <= high * (1.0 + round_off);
}

/// A value outside of the range for the kind of mass. Its meaning is that of the key `meaning`.
void judge_by_kind(const CaseFile& file, const std::string& place, double value, const std::string& meaning,
                   Scene& scene) {
    const std::string& kind = file.word("case.kind");
    const RangeKey known = range_key(meaning);
    const std::optional<Plausible> range = plausible(kind, known.key, file.word("material.bed.law"));
    if (!range || range->low == range->high) return;  // one value that was published is no limit
    const double low = known.scale(range->low), high = known.scale(range->high);
    if (lies_in(value, low, high)) return;
    const std::string& unit = find_parameter(meaning)->unit;
    remark_on(scene.log, Remark::kind_range, place,
              {value, 0.0, fmt::format("{:.4g} to {:.4g}{} for {}", low, high, after_number(unit), kind)});
}

/// What brakes free water, outside of all that water flows over.
void judge_water(const std::string& place, double value, const std::string& meaning, Scene& scene) {
    const std::optional<Plausible> range = plausible(kFreeWater, meaning, "");
    if (!range || lies_in(value, range->low, range->high)) return;
    remark_on(
        scene.log, Remark::water_range, place,
        {value, 0.0,
         fmt::format("{:.4g} to {:.4g}{}", range->low, range->high, after_number(find_parameter(meaning)->unit))});
}

/// Of all zones as well.
void remark_on_water_friction(const CaseFile& file, Scene& scene) {
    for (const std::string meaning : {"water.manning_n", "water.darcy_f"}) {
        std::vector<std::string> keys = {meaning};
        for (Index i = 0; i < file.count("material.zone"); ++i)
            keys.push_back(fmt::format("material.zone.{}.{}", i, meaning));
        for (const std::string& key : keys)
            if (file.given(key) && !file.is_text(key)) judge_water(file.place(key), file.number(key), meaning, scene);
    }
}

void remark_on_kind(const CaseFile& file, const std::string& key, const std::string& meaning, Scene& scene) {
    if (file.given(key) && !file.is_text(key)) judge_by_kind(file, file.place(key), file.number(key), meaning, scene);
}

/// Of all zones as well. Rasters are judged once they are read.
void remark_on_kind(const CaseFile& file, Scene& scene) {
    if (!file.has("case.kind")) return;
    // The kind's density is that of what flows: of grains and water together.
    if (file.word("water.model") == "none") remark_on_kind(file, "material.density", "material.density", scene);
    for (const std::string name : {"rheology.yield_stress", "rheology.viscosity"}) {
        const std::string of_case = "material." + name;
        remark_on_kind(file, of_case, of_case, scene);
        for (Index i = 0; i < file.count("material.zone"); ++i)
            remark_on_kind(file, fmt::format("material.zone.{}.{}", i, name), of_case, scene);
    }
    for (const char* key : {"erodible.rate", "erodible.threshold", "erodible.depth_per_stress", "erodible.energy"})
        if (file.has(key)) remark_on_kind(file, key, key, scene);
    for (const std::string name : {"mu", "friction_angle_deg", "xi", "manning_n", "yield_stress", "viscosity"}) {
        const std::string of_bed = "material.bed." + name;
        remark_on_kind(file, of_bed, of_bed, scene);
        for (Index i = 0; i < file.count("material.zone"); ++i)
            remark_on_kind(file, fmt::format("material.zone.{}.{}", i, name), of_bed, scene);
    }
}

/// Densities besides that of the mass: of what the flow takes up, and of the water beside it.
void remark_on_other_densities(const CaseFile& file, Scene& scene) {
    for (const char* key : {"erodible.density", "water.density"})
        if (file.given(key)) remark_on(scene.log, Remark::density, file.place(key), {file.number(key)});
}

/// "small" (5000 to 25000 m3).
std::string size_text(std::size_t size) {
    const auto& limits = salm::size_limits;
    const std::string volumes = size == 0 ? fmt::format("below {:g} m3", limits.front())
                                : size == limits.size()
                                    ? fmt::format("{:g} m3 or more", limits.back())
                                    : fmt::format("{:g} to {:g} m3", limits[size - 1], limits[size]);
    return fmt::format("\"{}\" ({})", salm::size_names[size], volumes);
}

/// Why no frame of the scene has a field; empty: one has.
std::string why_without(const Scene& scene, const std::string& field) {
    const auto is = [&](std::initializer_list<const char*> names) {
        return std::find(names.begin(), names.end(), field) != names.end();
    };
    if (is({"stress"}) && !scene.structure && !scene.solid && std::holds_alternative<rheology::None>(scene.rheology))
        return "material.rheology.law = \"none\" has no stress";
    if (is({"effective_stress"}) && !scene.structure && std::holds_alternative<rheology::None>(scene.rheology))
        return "material.rheology.law = \"none\" has no stress of particles";
    if (is({"damage", "cohesion"}) && !scene.structure)
        return "material.structure.law = \"none\" holds nothing together";
    if (is({"water_depth", "water_velocity"}) && !scene.water) return "there is no free water";
    if (is({"water_depth", "water_velocity"}) && !scene.structure) return "all is water, and depth is the water's";
    if (is({"bed_change", "eroded_depth", "deposited_depth"}) && !scene.bed_changes()) return "the bed does not change";
    return "";
}

void judge_angle(const CaseFile& file, const std::string& place, double degrees, Scene& scene) {
    if (degrees == 0.0 && file.word("material.bed.law") == bed::Manning::name) return;  // his term alone
    remark_on(scene.log, Remark::friction, place, {degrees});
}

/// Of a number of a law, what all nodes of the ground have that no zone gives it. Empty where all are of zones.
FrictionPart::Extent extent_without_zones(const CaseFile& file, const Scene& scene, const std::string& in_zone) {
    FrictionPart::Extent all{in_zone, "", INFINITY, -INFINITY};
    for (const FrictionPart& part : scene.friction->parts) {
        const std::string zone = part.name.substr(0, part.name.find(' '));
        const bool is_zone = zone.rfind("material.zone.", 0) == 0;
        if (is_zone && file.given(fmt::format("{}.{}", zone, in_zone))) continue;
        for (const FrictionPart::Extent& extent : part.extents)
            if (extent.key == in_zone)
                all.low = std::min(all.low, extent.low), all.high = std::max(all.high, extent.high);
    }
    return all;
}

/// An end of what a raster holds, for a key of that name in the tables of friction.
void judge_end(const CaseFile& file, const std::string& key, const char* end, double value, Scene& scene) {
    const std::string place = fmt::format("{} (the {} of its raster)", file.place(key), end);
    const std::string name = key.substr(key.rfind('.') + 1);
    if (name == "friction_angle_deg") judge_angle(file, place, value, scene);
    if (name == "mu" || name == "mu_s" || name == "mu_2")
        judge_angle(file, place, std::atan(value) * constants::kRadian, scene);
    if (name == "xi") remark_on(scene.log, Remark::xi, place, {value});
    judge_water(place, value, key, scene);
    const bool of_kind = find_parameter(key) && !range_key(key).key.empty() && name != "mu_s" && name != "mu_2";
    if (of_kind && file.has("case.kind")) judge_by_kind(file, place, value, key, scene);
}

/// A depth without an outline is that of all of the terrain, which is seldom meant.
void remark_on_whole_terrain(const CaseFile& file, const ReleaseSummary& release, Scene& scene) {
    const std::string prefix = fmt::format("release.{}.", release.table);
    for (const char* bound : {"outline", "surface"})
        if (file.given(prefix + bound)) return;
    const std::string place = file.table_place(fmt::format("release.{}", release.table));
    if (file.given(prefix + "mask")) {
        const GridGeometry& g = scene.bed.geometry;
        constexpr double kRoundOff = 1e-9;
        if (release.report.area > (1.0 - kRoundOff) * (g.x_max() - g.x0) * (g.y_max() - g.y0))
            scene.log.push_back(
                fmt::format("{}: found a mask above 0 everywhere, so that all of the terrain is released: {:.6g} m3 on "
                            "{:.6g} m2; expected 0 around the release; correct the mask, unless this is meant",
                            place, release.report.volume, release.report.area));
        return;
    }
    if (file.is_text(prefix + "depth")) return;
    scene.log.push_back(
        fmt::format("{}: found no outline, so that all of the terrain is released: {:.6g} m3 on {:.6g} m2; expected an "
                    "outline; give one, unless this is meant",
                    place, release.report.volume, release.report.area));
}

}  // namespace

void remark_on_terrain(const CaseFile& file, Scene& scene) {
    const std::string place = file.place("terrain.dem");
    remark_on(scene.log, Remark::gravity, file.place("terrain.gravity"), {scene.gravity});
    remark_zero_margin(scene, place);
    remark_feet(scene, place);
}

void remark_on_material(const CaseFile& file, Scene& scene) {
    const bool given = file.given("material.density");
    if (!water_alone(file))
        remark_on(scene.log, given ? Remark::density : Remark::density_not_given, file.place("material.density"),
                  {file.number("material.density"), 0.0,
                   file.has("case.kind") ? " (case.kind = \"" + file.word("case.kind") + "\")" : ""});
    const auto angle = [&](const std::string& key, bool tangent) {
        if (!file.given(key) || file.is_text(key)) return;
        const double value = file.number(key);
        judge_angle(file, file.place(key), tangent ? std::atan(value) * constants::kRadian : value, scene);
    };
    const auto xi = [&](const std::string& key) {
        if (file.given(key) && !file.is_text(key))
            remark_on(scene.log, Remark::xi, file.place(key), {file.number(key)});
    };
    std::vector<std::string> tables = {"material.bed."};
    for (Index i = 0; i < file.count("material.zone"); ++i) tables.push_back(fmt::format("material.zone.{}.", i));
    for (const std::string& table : tables) {
        for (const char* key : {"mu", "mu_s", "mu_2"}) angle(table + key, true);
        angle(table + "friction_angle_deg", false);
        xi(table + "xi");
    }
    remark_on_other_densities(file, scene);
    remark_on_water_friction(file, scene);
    angle("material.structure.friction_angle_deg", false);
    for (Index i = 0; i < file.count("stage"); ++i) angle(fmt::format("stage.{}.friction_angle_deg", i), false);
    remark_on_kind(file, scene);
}

void remark_on_friction_rasters(const CaseFile& file, Scene& scene) {
    if (!scene.friction) return;
    for (const std::string& key : rasters_of_laws(file)) {
        const bool of_bed = key.rfind("material.bed.", 0) == 0, of_rheology = key.rfind("material.rheology.", 0) == 0,
                   of_water = key.rfind("water.", 0) == 0;
        if (!of_bed && !of_rheology && !of_water) continue;
        const std::string name = key.substr(key.rfind('.') + 1), in_zone = of_bed     ? name
                                                                           : of_water ? key
                                                                                      : "rheology." + name;
        const bool degrees = name == "friction_angle_deg";  // laws have the tangent
        const FrictionPart::Extent found = extent_without_zones(file, scene, degrees ? "mu" : in_zone);
        const auto of_key = [&](double value) { return degrees ? std::atan(value) * constants::kRadian : value; };
        if (found.low > found.high) continue;
        judge_end(file, key, "least", of_key(found.low), scene);
        if (found.high > found.low) judge_end(file, key, "largest", of_key(found.high), scene);
    }
}

void remark_on_speed(const CaseFile& file, Index i, const Release& release, Scene& scene) {
    double fastest = release.velocity.norm();
    const auto largest = [](const std::optional<Raster>& part) {
        double most = 0.0;
        for (const double value : part ? part->values : std::vector<double>()) most = std::fmax(most, std::abs(value));
        return most;
    };
    fastest = std::max({fastest, largest(release.velocity_x), largest(release.velocity_y)});
    remark_on(scene.log, Remark::release_speed, file.place(fmt::format("release.{}.velocity", i)), {fastest});
}

void remark_on_footprint_depth(const CaseFile& file, const std::vector<ReleaseSummary>& releases, Scene& scene) {
    if (releases.empty() || !scene.inflows.empty() || scene.water || scene.bed_changes()) return;
    double deepest = 0.0;
    for (const ReleaseSummary& release : releases) deepest = std::max(deepest, release.max_depth);
    if (scene.output.footprint_depth < deepest) return;
    scene.log.push_back(
        fmt::format("{}: found {:.4g} m, and releases of {:.4g} m at most; expected less than these, or the footprint "
                    "is empty unless "
                    "the flow becomes deeper; give a smaller depth",
                    file.place("output.footprint_depth"), scene.output.footprint_depth, deepest));
}

void remark_on_size(const CaseFile& file, double released, Scene& scene) {
    const std::string key = "material.bed.volume_class";
    if (!file.given(key)) return;
    double volume = released;
    for (const Inflow& inflow : scene.inflows) volume += facts_of(inflow, scene.gravity).volume;
    const auto& names = salm::size_names;
    const auto given = static_cast<std::size_t>(std::find(names.begin(), names.end(), file.word(key)) - names.begin());
    const std::size_t size = salm::size_of(volume);
    if (volume > 0.0 && given != size)
        remark_on(scene.log, Remark::size_class, file.place(key),
                  {volume, 0.0, fmt::format("{}, not {}", size_text(given), size_text(size))});
}

void remark_on_fields(const CaseFile& file, Scene& scene) {
    for (const std::string& field : scene.output.fields)
        if (const std::string why = why_without(scene, field); !why.empty())
            scene.log.push_back(fmt::format(
                "{}: found \"{}\"; expected a field of this case, since {}; frames go without it, so take it out",
                file.place("output.fields"), field, why));
}

void remark_on_releases(const CaseFile& file, const std::vector<ReleaseSummary>& releases, Scene& scene) {
    for (const ReleaseSummary& release : releases) {
        const std::string place = file.table_place(fmt::format("release.{}", release.table));
        remark_on(scene.log, Remark::release_slope, place, {release.slope_max_deg});
        remark_on(scene.log, Remark::release_depth, place, {release.max_depth});
        remark_on_whole_terrain(file, release, scene);
    }
    Index count = 0;
    for (const Seeds* seeds : scene.all_particles()) count += seeds->count();
    if (count == 0 && !scene.inflows.empty()) return;  // all is still to come in
    if (scene.water && !scene.structure) return;       // which is on cells from the start
    const char* const key = file.given("particles.count") ? "particles.count" : "particles.per_cell";
    remark_on(scene.log, Remark::few_particles, file.place(key), {double(count)});
}

void remark_on_gaps(const Raster& field, const NodeMarks& claimed, const std::string& place,
                    std::vector<std::string>& log) {
    Index gaps = 0, all = 0;
    for (std::size_t k = 0; k < claimed.size(); ++k) {
        if (!claimed[k]) continue;
        ++all;
        if (std::isnan(field.values[k])) ++gaps;
    }
    remark_on(log, Remark::depth_without_data, place, {double(gaps), double(all)});
}

}  // namespace frana
