// Spatially varying friction: rasters of the numbers of laws, classes of ground, and [[material.zone]].
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/error.h"
#include "scene/combinations.h"
#include "scene/ground_classes.h"
#include "scene/law_layers.h"
#include "scene/nodes_of_place.h"
#include "scene/salm_table.h"
#include "scene/scene_parts.h"

namespace frana {
namespace {

std::string zone_name(const CaseFile& file, Index zone) {
    const std::string name = fmt::format("material.zone.{}", zone), outline = name + ".outline";
    return file.given(outline) ? fmt::format("{} ({})", name, file.word(outline)) : name;
}

Index ground_count(const Scene& scene) {
    return std::count_if(scene.bed.values.begin(), scene.bed.values.end(), [](double z) { return !std::isnan(z); });
}

/// mu and xi of snow by ground and altitude.
class SnowClasses {
public:
    SnowClasses(const CaseFile& file, Scene& scene, double released)
        : case_(file), scene_(scene), released_(released) {}

    void lay(LawLayers& laws) const {
        const auto* periods = salm::return_periods.begin();
        const auto period = static_cast<std::size_t>(
            std::find(periods, salm::return_periods.end(), case_.number("material.bed.return_period")) - periods);
        const std::size_t size = size_class();
        const std::vector<double>& limits = case_.numbers("material.bed.altitude_limits");
        const std::vector<std::uint8_t> grounds = ground_classes(scene_.bed, borders());
        std::array<double, 4> shares{};
        const auto share = 100.0 / static_cast<double>(ground_count(scene_));
        for (std::size_t k = 0; k < grounds.size(); ++k) {
            const double z = scene_.bed.values[k];
            const std::size_t ground = grounds[k], altitude = (z >= limits[0] ? 1U : 0U) + (z >= limits[1] ? 1U : 0U);
            laws.set(k, "mu", salm::mu[size][period][ground][altitude]);
            laws.set(k, "xi", salm::xi[size][ground][altitude]);
            if (!std::isnan(z)) shares[ground] += share;
        }
        remark(size, shares);
    }

private:
    std::size_t size_class() const {
        const auto& names = salm::size_names;
        if (case_.given("material.bed.volume_class"))
            return static_cast<std::size_t>(
                std::find(names.begin(), names.end(), case_.word("material.bed.volume_class")) - names.begin());
        return salm::size_of(released_);
    }

    GroundBorders borders() const {
        GroundBorders all;
        all.length = case_.number("material.bed.curvature_length");
        all.flat_below_deg = case_.number("material.bed.flat_below_deg");
        const std::vector<double>& limits = case_.numbers("material.bed.curvature_limits");
        std::copy(limits.begin(), limits.end(), all.curvature.begin());
        return all;
    }

    void remark(std::size_t size, const std::array<double, 4>& shares) const {
        std::string text;
        for (std::size_t ground = 0; ground < shares.size(); ++ground)
            text += fmt::format("{}{:.3g} % {}", ground == 0 ? "" : ", ", shares[ground], salm::ground_names[ground]);
        const GroundBorders all = borders();
        const double cell = scene_.bed.geometry.cell;
        const std::string mean = averages(all.length, cell)
                                     ? fmt::format("terrain averaged over {:.6g} m", all.length)
                                     : fmt::format("terrain as its cells of {:.6g} m have it", cell);
        scene_.log.push_back(fmt::format(
            "{}: size {}{}, {:.6g} years: {}; what divides the classes is a choice of frana's, not of the table's: "
            "{}, flat below {:.6g} degrees, plan curvatures {:.6g}, {:.6g}, {:.6g} 1/m",
            case_.place("material.bed.table"), salm::size_names[size],
            case_.given("material.bed.volume_class") ? "" : fmt::format(" ({:.6g} m3 are released)", released_),
            case_.number("material.bed.return_period"), text, mean, all.flat_below_deg, all.curvature[0],
            all.curvature[1], all.curvature[2]));
    }

    const CaseFile& case_;
    Scene& scene_;
    double released_;  ///< [m3]
};

/// Which nodes zones have.
class ZoneNodes {
public:
    ZoneNodes(const CaseFile& file, const GisReader& reader, Scene& scene)
        : case_(file), reader_(reader), scene_(scene), part_(scene.bed.values.size(), 0) {}

    /// Of the nodes: 0, or the number of the last zone that has them + 1.
    const std::vector<std::uint32_t>& part() const { return part_; }

    /// All nodes of a zone, which become its own. Throws UserError where it has none.
    NodeMarks take(Index zone) {
        const std::string name = fmt::format("material.zone.{}", zone);
        NodeMarks marks = nodes_of(name);
        bool any = false;
        for (std::size_t k = 0; k < marks.size(); ++k) {
            if (!marks[k]) continue;
            any = any || !std::isnan(scene_.bed.values[k]);
            part_[k] = static_cast<std::uint32_t>(zone + 1);
        }
        if (!any && !may_lie_farther(name))
            throw UserError(
                "found no node of the terrain in it; expected some; correct the outline, its CRS or the elevations, or "
                "remove the zone");
        return marks;
    }

    double area_of(std::uint32_t number) const {
        const double cell = scene_.bed.geometry.cell;
        double area = 0.0;
        for (std::size_t k = 0; k < part_.size(); ++k)
            if (part_[k] == number && !std::isnan(scene_.bed.values[k])) area += cell * cell;
        return area;
    }

private:
    /// By outline, by elevation, or what both have.
    NodeMarks nodes_of(const std::string& zone) const {
        NodeMarks marks(part_.size(), 1);
        if (case_.given(zone + ".outline")) {
            std::fill(marks.begin(), marks.end(), char{0});
            const Polygons outline =
                reader_.read_polygons(case_.path(zone + ".outline"), scene_.bed.crs_wkt, scene_.log);
            for (const Polygon& polygon : outline.parts) mark_inside(polygon, scene_.bed.geometry, marks);
        }
        const auto limit = [&](const char* name, double otherwise) {
            return case_.given(zone + name) ? case_.number(zone + name) : otherwise;
        };
        const double low = limit(".above", -INFINITY), high = limit(".below", INFINITY);
        for (std::size_t k = 0; k < marks.size(); ++k) {
            const double z = scene_.bed.values[k];
            if (z < low || z >= high) marks[k] = 0;
        }
        return marks;
    }

    /// Whether the terrain beyond the part that is held may have nodes of a zone.
    bool may_lie_farther(const std::string& zone) const {
        if (!case_.given(zone + ".outline")) return scene_.wider != nullptr;
        std::vector<std::string> said;
        return may_begin_beyond(reader_.read_polygons(case_.path(zone + ".outline"), scene_.bed.crs_wkt, said), scene_);
    }

    const CaseFile& case_;
    const GisReader& reader_;
    Scene& scene_;
    std::vector<std::uint32_t> part_;
};

using AllLayers = std::vector<std::unique_ptr<LawLayers>>;

template <class Any>
void add_layers(const CaseFile& file, const GisReader& reader, Scene& scene, const LawPlace& place,
                laws::LawMap<Any> Friction::*map, Any& mean, AllLayers& all) {
    std::visit(
        [&](const auto& law) {
            using Law = std::decay_t<decltype(law)>;
            if constexpr (!std::is_empty_v<Law>) {  // it has numbers
                using Layers = LayersOf<Any, Law>;
                auto layers = std::make_unique<Layers>(file, reader, scene, place, typename Layers::Target{map, &mean});
                if (layers->is_said()) all.push_back(std::move(layers));
            }
        },
        mean);
}

/// Zones in their order, then what is outside of them.
std::vector<FrictionPart> parts_of(const CaseFile& file, const ZoneNodes& zones, const AllLayers& laws, Scene& scene) {
    std::vector<FrictionPart> parts;
    const Index count = file.count("material.zone");
    for (Index i = 0; i <= count; ++i) {
        const bool zone = i < count;
        const auto number = static_cast<std::uint32_t>(zone ? i + 1 : 0);
        FrictionPart part{zone        ? zone_name(file, i)
                          : count > 0 ? "elsewhere"
                                      : "everywhere",
                          zones.area_of(number),
                          {}};
        if (part.area > 0.0)
            for (const auto& of : laws) of->add_extents(zones.part(), number, part);
        if (part.area == 0.0 && scene.wider) {
            if (zone)
                scene.log.push_back(part.name + ": not around the releases; it counts where the flow comes to it");
            continue;
        }
        if (zone && part.area == 0.0)
            scene.log.push_back(
                fmt::format("{}: later zones cover all of it", file.table_place(fmt::format("material.zone.{}", i))));
        if (zone || part.area > 0.0) parts.push_back(std::move(part));
    }
    return parts;
}

/// Storage number of the node nearest to a place.
std::size_t place_of_nearest(const GridGeometry& g, const Vec2& place) {
    const auto node = [&](double at, Index count) {
        return static_cast<Index>(std::clamp(std::floor(at / g.cell + 0.5), 0.0, static_cast<double>(count - 1)));
    };
    return static_cast<std::size_t>(node(place.y() - g.y0, g.ny) * g.nx + node(place.x() - g.x0, g.nx));
}

}  // namespace

bool friction_by_table(const CaseFile& file) { return file.word("material.bed.table") != "none"; }

std::vector<std::string> rasters_of_laws(const CaseFile& file) {
    std::vector<std::string> keys;
    for (const LawPlace& place : kLawPlaces)
        for (const Parameter& parameter : parameters())
            if (parameter.switch_key == place.choice && parameter.kind == Kind::number_or_path &&
                file.given(parameter.key) && file.is_text(parameter.key))
                keys.push_back(parameter.key);
    return keys;
}

bool friction_differs(const CaseFile& file) {
    return friction_by_table(file) || file.count("material.zone") > 0 || !rasters_of_laws(file).empty();
}

void read_friction(const CaseFile& file, const GisReader& reader, double released, Scene& scene, Problems& problems) {
    if (!friction_differs(file)) return;
    WaterLaw of_water = law_of<WaterLaw>(file, kWaterPlace);
    AllLayers all;
    add_layers<BedLaw>(file, reader, scene, kBedPlace, &Friction::laws, scene.bed_law, all);
    add_layers<Rheology>(file, reader, scene, kRheologyPlace, &Friction::rheologies, scene.rheology, all);
    if (file.word("water.model") == "free")
        add_layers<WaterLaw>(file, reader, scene, kWaterPlace, &Friction::water, of_water, all);
    if (friction_by_table(file)) SnowClasses(file, scene, released).lay(*all.front());
    for (const auto& laws : all) laws->lay_rasters(problems);
    ZoneNodes zones(file, reader, scene);
    for (Index i = 0; i < file.count("material.zone"); ++i)
        problems.attempt(file.table_place(fmt::format("material.zone.{}", i)), [&] {
            const NodeMarks marks = zones.take(i);
            for (const auto& laws : all) laws->lay_zone(i, marks);
        });
    if (!problems.empty()) return;  // what was not laid would be missed once more
    bool whole = true;
    for (const auto& laws : all)
        whole = problems.attempt(file.place(laws->place().choice), [&] { laws->check(); }) && whole;
    if (!whole) return;
    Friction friction;
    friction.parts = parts_of(file, zones, all, scene);
    for (const auto& laws : all) laws->finish(friction);
    scene.friction = std::make_shared<const Friction>(std::move(friction));
}

BedLaw bed_law_at(const Scene& scene, const Vec2& place) {
    const bed::LawMap* laws = scene.bed_laws();
    return laws ? laws->at(place_of_nearest(scene.bed.geometry, place)) : scene.bed_law;
}

WaterFriction water_friction_at(const Scene& scene, const Vec2& place, const WaterFriction& everywhere) {
    const WaterLawMap* laws = scene.water_laws();
    return laws ? water_friction(laws->at(place_of_nearest(scene.bed.geometry, place))) : everywhere;
}

std::string friction_sentence(const FrictionPart& part) {
    std::string text = fmt::format("{:.6g} m2", part.area);
    for (const FrictionPart::Extent& of : part.extents) {
        text += fmt::format(", {} {:.6g}", of.key, of.low);
        if (of.high > of.low) text += fmt::format(" to {:.6g}", of.high);
        if (of.unit != "1") text += " " + of.unit;
    }
    return text;
}

}  // namespace frana
