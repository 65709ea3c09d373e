// Friction that differs in space: rasters under [material.bed], and [[material.zone]].
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "scene/combinations.h"
#include "scene/ground_classes.h"
#include "scene/nodes_of_place.h"
#include "scene/salm_table.h"
#include "scene/scene_parts.h"

namespace frana {
namespace {

using laws::Key;

constexpr const char* kLaw = "material.bed.";

bool is_raster(const CaseFile& file, const std::string& key) { return file.given(key) && file.is_text(key); }

std::string name_of(const CaseFile& file, const std::string& zone) {
    return file.given(zone + ".outline") ? fmt::format("{} ({})", zone, file.word(zone + ".outline")) : zone;
}

/// The laws of all nodes, laid one over the other: the case's own, rasters, zones.
template <class Law>
class LawLayers {
public:
    LawLayers(const CaseFile& file, const GisReader& reader, Scene& scene, Law law)
        : case_(file),
          reader_(reader),
          scene_(scene),
          grid_(scene.bed.geometry),
          keys_(Law::keys()),
          laws_(scene.bed.values.size(), law),
          part_(scene.bed.values.size(), 0) {}

    /// mu and xi of each node by its ground and altitude.
    void lay_table(double released) {
        if (!by_table()) return;
        const std::string of = kLaw;
        const auto index_of = [](const auto& names, const std::string& name) {
            return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
        };
        const auto* periods = salm::return_periods.begin();
        const auto period = static_cast<std::size_t>(
            std::find(periods, salm::return_periods.end(), case_.number(of + "return_period")) - periods);
        const std::size_t size = case_.given(of + "volume_class")
                                     ? index_of(salm::size_names, case_.word(of + "volume_class"))
                                     : static_cast<std::size_t>(std::upper_bound(salm::size_limits.begin(),
                                                                                 salm::size_limits.end(), released) -
                                                                salm::size_limits.begin());
        const std::vector<double>& limits = case_.numbers(of + "altitude_limits");
        const std::vector<std::uint8_t> grounds = ground_classes(scene_.bed, borders());
        std::array<double, 4> shares{};
        const auto share = 100.0 / static_cast<double>(ground_count());
        for (std::size_t k = 0; k < laws_.size(); ++k) {
            const double z = scene_.bed.values[k];
            const std::size_t ground = grounds[k], altitude = (z >= limits[0] ? 1U : 0U) + (z >= limits[1] ? 1U : 0U);
            set(k, "mu", salm::mu[size][period][ground][altitude]);
            set(k, "xi", salm::xi[size][ground][altitude]);
            if (is_ground(k)) shares[ground] += share;
        }
        remark_table(size, released, shares);
    }

    void lay_rasters(Problems& problems) {
        for (const Key<Law>& key : keys_) {
            const std::string name = kLaw + std::string(key.name);
            if (is_raster(case_, name)) problems.attempt(case_.place(name), [&] { lay_raster(key, name); });
        }
    }

    void lay_zones(Problems& problems) {
        for (Index i = 0; i < case_.count("material.zone"); ++i)
            problems.attempt(case_.table_place(fmt::format("material.zone.{}", i)), [&] { lay_zone(i); });
    }

    /// Every node of the ground has all parameters, and they go together.
    void check() const {
        for (const Key<Law>& key : keys_) {
            std::size_t bad = 0, first = 0;
            for (std::size_t k = laws_.size(); k-- > 0;)
                if (is_ground(k) && std::isnan(laws_[k].*key.parameter)) ++bad, first = k;
            if (bad > 0 && key.name == bed::plain_name(keys_, key.parameter)) refuse_gaps(key.name, bad, first);
            if (*key.more_than != '\0') require_more(key);
        }
    }

    std::shared_ptr<const Friction> friction() {
        fill_gaps();
        Friction all;
        for (const Key<Law>& key : keys_)
            if (key.name == bed::plain_name(keys_, key.parameter) && is_said(key.parameter))
                all.keys.push_back(key.name);
        const Index zones = case_.count("material.zone");
        for (Index i = 0; i <= zones; ++i) {
            const bool zone = i < zones;
            FrictionPart part = part_of(static_cast<std::uint32_t>(zone ? i + 1 : 0));
            part.name = zone        ? name_of(case_, fmt::format("material.zone.{}", i))
                        : zones > 0 ? "elsewhere"
                                    : "everywhere";
            if (part.area == 0.0 && scene_.wider) {
                if (zone)
                    scene_.log.push_back(part.name + ": not around the releases; it counts where the flow comes to it");
                continue;
            }
            if (zone && part.area == 0.0)
                scene_.log.push_back(fmt::format("{}: later zones cover all of it",
                                                 case_.table_place(fmt::format("material.zone.{}", i))));
            if (zone || part.area > 0.0) all.parts.push_back(std::move(part));
        }
        all.laws = bed::law_map(laws_);
        return std::make_shared<const Friction>(std::move(all));
    }

    /// Its parameters are those of the nodes on average.
    Law mean() const {
        Law law = laws_.front();
        for (const Key<Law>& key : keys_) {
            double sum = 0.0, count = 0.0;
            for (std::size_t k = 0; k < laws_.size(); ++k)
                if (is_ground(k)) sum += laws_[k].*key.parameter, count += 1.0;
            law.*key.parameter = sum / count;
        }
        return law;
    }

private:
    bool by_table() const { return friction_by_table(case_); }

    GroundBorders borders() const {
        GroundBorders all;
        all.length = case_.number("material.bed.curvature_length");
        all.flat_below_deg = case_.number("material.bed.flat_below_deg");
        const std::vector<double>& limits = case_.numbers("material.bed.curvature_limits");
        std::copy(limits.begin(), limits.end(), all.curvature.begin());
        return all;
    }

    void set(std::size_t node, const std::string& name, double value) {
        for (const Key<Law>& key : keys_)
            if (name == key.name) laws_[node].*key.parameter = value;
    }

    void remark_table(std::size_t size, double released, const std::array<double, 4>& shares) {
        std::string text;
        for (std::size_t ground = 0; ground < shares.size(); ++ground)
            text += fmt::format("{}{:.3g} % {}", ground == 0 ? "" : ", ", shares[ground], salm::ground_names[ground]);
        const GroundBorders all = borders();
        scene_.log.push_back(fmt::format(
            "{}: size {}{}, {:.6g} years: {}; what divides the classes is a choice of frana's, not of the table's: "
            "terrain "
            "averaged over {:.6g} m, flat below {:.6g} degrees, plan curvatures {:.6g}, {:.6g}, {:.6g} 1/m",
            case_.place("material.bed.table"), salm::size_names[size],
            case_.given("material.bed.volume_class") ? "" : fmt::format(" ({:.6g} m3 are released)", released),
            case_.number("material.bed.return_period"), text, all.length, all.flat_below_deg, all.curvature[0],
            all.curvature[1], all.curvature[2]));
    }

    bool is_ground(std::size_t k) const { return !std::isnan(scene_.bed.values[k]); }
    Index ground_count() const {
        Index count = 0;
        for (std::size_t k = 0; k < laws_.size(); ++k) count += is_ground(k);
        return count;
    }

    template <class Body>
    void for_each_node(Body&& body) const {
        for (Index j = 0; j < grid_.ny; ++j)
            for (Index i = 0; i < grid_.nx; ++i)
                body(static_cast<std::size_t>(j * grid_.nx + i), grid_.x(i), grid_.y(j));
    }

    /// Of the pixel at each node. Where there is none: the key's default, or NaN.
    void lay_raster(const Key<Law>& key, const std::string& name) {
        const std::filesystem::path path = case_.path(name);
        const Raster pixels = pixels_on(path, reader_, scene_);
        require_range(pixels, key.range, path.string());
        Index gaps = 0;
        for_each_node([&](std::size_t k, double x, double y) {
            const double value = pixel_at(pixels, x, y);
            if (!std::isnan(value)) {
                laws_[k].*key.parameter = key.convert(value);
                return;
            }
            if (is_ground(k)) ++gaps;
            if (key.missing == laws::Missing::refused) laws_[k].*key.parameter = Raster::nodata;
        });
        if (gaps > 0 && key.missing != laws::Missing::refused)
            scene_.log.push_back(fmt::format(
                "{}: {:.3g} % of {} have no data there; they have {:.6g} where no zone says more", case_.place(name),
                100.0 * double(gaps) / double(ground_count()), nodes_text(scene_), Law{}.*key.parameter));
    }

    /// By outline, by elevation, or what both have.
    NodeMarks nodes_of(const std::string& zone) const {
        NodeMarks marks(laws_.size(), 1);
        if (case_.given(zone + ".outline")) {
            std::fill(marks.begin(), marks.end(), char{0});
            const Polygons outline =
                reader_.read_polygons(case_.path(zone + ".outline"), scene_.bed.crs_wkt, scene_.log);
            for (const Polygon& polygon : outline.parts) mark_inside(polygon, grid_, marks);
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

    void lay_zone(Index number) {
        const std::string zone = fmt::format("material.zone.{}", number);
        const NodeMarks marks = nodes_of(zone);
        bool any = false;
        for (std::size_t k = 0; k < marks.size(); ++k) {
            if (!marks[k]) continue;
            any = any || is_ground(k);
            part_[k] = static_cast<std::uint32_t>(number + 1);
            for (const Key<Law>& key : keys_)
                if (const std::string name = zone + "." + key.name; case_.given(name))
                    laws_[k].*key.parameter = key.convert(case_.number(name));
        }
        if (!any && !may_lie_farther(zone))
            throw UserError(
                "found no node of the terrain in it; expected some; correct the outline, its CRS or the elevations, or "
                "remove the zone");
    }

    /// Whether the terrain beyond the part that is held may have nodes of a zone.
    bool may_lie_farther(const std::string& zone) const {
        if (!case_.given(zone + ".outline")) return scene_.wider != nullptr;
        std::vector<std::string> said;
        return may_begin_beyond(reader_.read_polygons(case_.path(zone + ".outline"), scene_.bed.crs_wkt, said), scene_);
    }

    [[noreturn]] void refuse_gaps(const std::string& key, std::size_t count, std::size_t first) const {
        throw UserError(fmt::format(
            "found no value at {} of {} nodes, such as {}; expected one at each, since {}{} has no default; fill the "
            "gaps of the raster, or give {} there by a [[material.zone]]",
            count, ground_count(), place_text(grid_, first), kLaw, key, key));
    }

    void require_more(const Key<Law>& key) const {
        const auto smaller = std::find_if(keys_.begin(), keys_.end(),
                                          [&](const auto& k) { return std::string(k.name) == key.more_than; });
        for (std::size_t k = 0; k < laws_.size(); ++k) {
            const double value = laws_[k].*key.parameter, other = laws_[k].*(smaller->parameter);
            if (!is_ground(k) || value > other) continue;
            throw UserError(fmt::format("found {} = {:.6g} at {}; expected more than {} = {:.6g} there; {}", key.name,
                                        value, place_text(grid_, k), key.more_than, other, key.way_out));
        }
    }

    /// Beyond the ground nothing is known, and nothing moves.
    void fill_gaps() {
        const Law middle = mean();
        for (std::size_t k = 0; k < laws_.size(); ++k)
            for (const Key<Law>& key : keys_)
                if (std::isnan(laws_[k].*key.parameter)) laws_[k].*key.parameter = middle.*key.parameter;
    }

    /// Whether a raster or a zone says something of a parameter, by any of its keys.
    bool is_said(double Law::*parameter) const {
        for (const Key<Law>& key : keys_) {
            if (key.parameter != parameter) continue;
            if (is_raster(case_, kLaw + std::string(key.name)) || by_table()) return true;
            for (Index i = 0; i < case_.count("material.zone"); ++i)
                if (case_.given(fmt::format("material.zone.{}.{}", i, key.name))) return true;
        }
        return false;
    }

    FrictionPart part_of(std::uint32_t number) const {
        FrictionPart part;
        std::vector<const Key<Law>*> shown;
        for (const Key<Law>& key : keys_)
            if (key.name == bed::plain_name(keys_, key.parameter) && is_said(key.parameter)) {
                shown.push_back(&key);
                part.extents.push_back({key.name, key.unit, INFINITY, -INFINITY});
            }
        for (std::size_t k = 0; k < laws_.size(); ++k) {
            if (part_[k] != number || !is_ground(k)) continue;
            part.area += grid_.cell * grid_.cell;
            for (std::size_t n = 0; n < shown.size(); ++n) {
                const double value = laws_[k].*(shown[n]->parameter);
                part.extents[n].low = std::min(part.extents[n].low, value);
                part.extents[n].high = std::max(part.extents[n].high, value);
            }
        }
        if (part.area == 0.0) part.extents.clear();
        return part;
    }

    const CaseFile& case_;
    const GisReader& reader_;
    Scene& scene_;
    const GridGeometry& grid_;
    std::vector<Key<Law>> keys_;
    std::vector<Law> laws_;            ///< of the nodes; NaN: a parameter that is not known
    std::vector<std::uint32_t> part_;  ///< of the nodes: 0, or the number of their zone + 1
};

}  // namespace

bool friction_by_table(const CaseFile& file) { return file.word("material.bed.table") != "none"; }

bool friction_differs(const CaseFile& file) {
    return friction_by_table(file) || file.count("material.zone") > 0 || !rasters_in(file, "material.bed").empty();
}

void read_friction(const CaseFile& file, const GisReader& reader, double released, Scene& scene, Problems& problems) {
    if (!friction_differs(file)) return;
    std::visit(
        [&](const auto& law) {
            LawLayers layers(file, reader, scene, law);
            layers.lay_table(released);
            layers.lay_rasters(problems);
            layers.lay_zones(problems);
            if (!problems.empty()) return;  // what was not laid would be missed once more
            if (!problems.attempt(file.place("material.bed.law"), [&] { layers.check(); })) return;
            scene.friction = layers.friction();
            scene.bed_law = layers.mean();
        },
        BedLaw(scene.bed_law));
}

BedLaw bed_law_at(const Scene& scene, const Vec2& place) {
    if (!scene.friction) return scene.bed_law;
    const GridGeometry& g = scene.bed.geometry;
    const auto node = [&](double at, Index count) {
        return static_cast<Index>(std::clamp(std::floor(at / g.cell + 0.5), 0.0, static_cast<double>(count - 1)));
    };
    return scene.friction->laws.at(
        static_cast<std::size_t>(node(place.y() - g.y0, g.ny) * g.nx + node(place.x() - g.x0, g.nx)));
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
