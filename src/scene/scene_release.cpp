// [[release]] of the case file -> Release of the particle generation.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/compensated_sum.h"
#include "base/error.h"
#include "base/layer_name.h"
#include "scene/nodes_of_place.h"
#include "scene/scene_parts.h"
#include "scene/speed_unit.h"
#include "terrain/bed_points.h"
#include "terrain/part_of.h"

namespace frana {
namespace {

const std::string kField = "field:";  // before an attribute's name
constexpr double unknown_depth = std::numeric_limits<double>::infinity();

class ReleaseReader {
public:
    ReleaseReader(const CaseFile& file, Index i, Scene& scene, const GisReader& reader)
        : case_(file),
          table_(fmt::format("release.{}", i)),
          prefix_(table_ + "."),
          bed_(scene.bed),
          terrain_(scene.wider ? scene.wider->grid : scene.bed.geometry),
          reader_(reader),
          log_(scene.log) {}

    std::vector<Release> read(Problems& problems) {
        Release release;
        release.name = case_.table_place(table_);
        bool good = true;
        if (given("outline")) good &= problems.attempt(place("outline"), [&] { release.outline = outline(); });
        if (!depth_attribute().empty()) {  // depths come with the outline
            return good ? by_depth(release, problems) : std::vector<Release>();
        }
        const char* depth_key = given("mask") ? "mask" : given("surface") ? "surface" : "depth";
        good &= problems.attempt(place(depth_key), [&] { set_depth(release); });
        good &= problems.attempt(place("velocity"), [&] { set_velocity(release); });
        if (!good) return {};
        return {release};
    }

private:
    bool given(const char* name) const { return case_.given(prefix_ + name); }

    /// A release for each depth that the outline's features have, the smallest first.
    std::vector<Release> by_depth(const Release& all, Problems& problems) {
        std::map<double, Polygons> parts;
        for (std::size_t n = 0; n < all.outline->parts.size(); ++n) {
            Polygons& same = parts[depths_[n]];
            same.crs_wkt = all.outline->crs_wkt, same.source = all.outline->source;
            same.parts.push_back(all.outline->parts[n]);
        }
        remark_on_overlap(parts);
        std::vector<Release> releases;
        const bool good = problems.attempt(place("depth"), [&] {
            if (!(parts.begin()->first > 0.0))
                throw UserError(
                    fmt::format("found a depth of {:.6g} m in {}; expected depths above 0; correct the attribute",
                                parts.begin()->first, all.outline->source));
            for (const auto& [depth, outline] : parts) {
                releases.push_back(all);
                releases.back().outline = outline;
                depth_of_features_ = depth;
                set_depth(releases.back());
                set_velocity(releases.back());
            }
        });
        return good ? releases : std::vector<Release>();
    }

    /// Polygons of one depth count once where they overlap. Those of other depths add up, which is rarely meant.
    void remark_on_overlap(const std::map<double, Polygons>& parts) const {
        if (parts.size() < 2) return;
        const GridGeometry points = points_over(parts);
        NodeMarks covered(static_cast<std::size_t>(points.size()), 0);
        double twice = 0.0, more = 0.0;                                   // [m2], [m3]
        for (auto part = parts.rbegin(); part != parts.rend(); ++part) {  // the deepest first
            NodeMarks marks(covered.size(), 0);
            for (const Polygon& polygon : part->second.parts) mark_inside(polygon, points, marks);
            double again = 0.0;
            for (std::size_t k = 0; k < marks.size(); ++k) {
                again += marks[k] && covered[k] ? points.cell * points.cell : 0.0;
                covered[k] |= marks[k];
            }
            twice += again, more += again * part->first;
        }
        if (!(twice > 0.0)) return;
        log_.push_back(fmt::format(
            "{}: polygons of {} overlap on about {:.3g} m2; their depths add up there, to about {:.3g} m3 more than by "
            "the deepest of them; if that is not meant, cut them so that none overlaps another",
            place("depth"), parts.begin()->second.source, twice, more));
    }

    /// Points all over the outline, some to a cell.
    GridGeometry points_over(const std::map<double, Polygons>& parts) const {
        constexpr double kPerCell = 4.0, kMost = 2000.0;  // along a side
        Vec2 low(INFINITY, INFINITY), high(-INFINITY, -INFINITY);
        for (const auto& part : parts)
            for (const Polygon& polygon : part.second.parts)
                for (const auto& ring : polygon.rings)
                    for (const Vec2& corner : ring) low = low.cwiseMin(corner), high = high.cwiseMax(corner);
        const Vec2 size = high - low;
        const double step = std::max(bed_.geometry.cell / kPerCell, size.maxCoeff() / kMost);
        const auto count = [&](double length) { return static_cast<Index>(std::ceil(length / step)); };
        return {count(size.x()), count(size.y()), low.x() + 0.5 * step, low.y() + 0.5 * step, step};
    }

    /// Of "field:thickness_m"; empty for other depths.
    std::string depth_attribute() const {
        if (!given("depth") || !case_.is_text(key("depth"))) return {};
        const std::string& text = case_.word(key("depth"));
        return text.rfind(kField, 0) == 0 ? text.substr(kField.size()) : std::string();
    }

    double depth_number(const char* name) const {
        return depth_of_features_ ? *depth_of_features_ : case_.number(key(name));
    }
    std::string key(const char* name) const { return prefix_ + name; }
    bool is_file(const char* name) const { return given(name) && case_.is_text(key(name)); }

    Raster raster(const std::filesystem::path& path) const {
        return reader_.read_raster(path, bed_.geometry.pixel_extent(), bed_.crs_wkt, log_);
    }

    /// Of a raster of depths, what lies beyond the part of it that was read [m3]. Nothing where that cannot be told.
    double volume_beyond(const std::filesystem::path& file, const Raster& part) const {
        constexpr double kFar = 1e9;  // [m]; farther than any coordinate of a map
        const auto box = reader_.extent_above_zero(file, {-kFar, -kFar, kFar, kFar}, bed_.crs_wkt);
        const auto has = part.geometry.pixel_extent();
        const double slack = 0.5 * part.geometry.cell;
        if (!box || ((*box)[0] > has[0] - slack && (*box)[1] > has[1] - slack && (*box)[2] < has[2] + slack &&
                     (*box)[3] < has[3] + slack))
            return 0.0;
        std::vector<std::string> said_already;
        const auto volume = [](const Raster& depths) {
            CompensatedSum sum;
            for (const double depth : depths.values)
                if (depth > 0.0) sum.add(depth * depths.geometry.cell * depths.geometry.cell);
            return sum.value();
        };
        const auto& [x0, y0, x1, y1] = *box;
        constexpr double kAtOnce = 4e6;  // [pixels]; the raster may be of a whole country
        const double cell = part.geometry.cell, within = 0.25 * cell;
        const double strip = std::max(1.0, std::floor(kAtOnce * cell / (x1 - x0))) * cell;
        double whole = 0.0;
        for (double y = y0; y < y1 - slack; y += strip)
            whole += volume(
                reader_.read_raster(file, {x0 + within, y + within, x1 - within, std::min(y + strip, y1) - within},
                                    bed_.crs_wkt, said_already));
        return std::max(0.0, whole - volume(part));
    }

    Polygons outline() {
        std::string name = case_.path(key("outline")).string();
        if (given("layer")) name = with_layer(name, case_.word(key("layer")));
        const std::string attribute = depth_attribute();
        ValuedPolygons valued;
        if (attribute.empty())
            valued.polygons = reader_.read_polygons(name, bed_.crs_wkt, log_);
        else
            valued = reader_.read_valued_polygons(name, attribute, bed_.crs_wkt, log_);
        depths_ = valued.values;
        Polygons& polygons = valued.polygons;
        const auto extent = terrain_.pixel_extent();
        const double slack = 1e-9 * (std::abs(extent[2]) + std::abs(extent[3]) + 1.0);
        Index outside = 0;
        Index vertices = 0;
        Vec2 example{0, 0};
        for (const Polygon& polygon : polygons.parts) {
            for (const auto& ring : polygon.rings) {
                for (const Vec2& v : ring) {
                    ++vertices;
                    const bool in = v.x() >= extent[0] - slack && v.x() <= extent[2] + slack &&
                                    v.y() >= extent[1] - slack && v.y() <= extent[3] + slack;
                    if (!in && outside++ == 0) example = v;
                }
            }
        }
        if (vertices == 0)
            throw UserError(fmt::format(
                "{}: found no polygon; expected the outline of a release; export it as polygons", polygons.source));
        if (outside == 0) return polygons;
        throw UserError(
            fmt::format("found {} of {} vertices outside the terrain, such as {:.10g}, {:.10g}; expected all within x "
                        "{:.10g} to {:.10g}, y {:.10g} "
                        "to {:.10g}; correct the outline or its CRS, or widen terrain.window",
                        outside, vertices, example.x(), example.y(), extent[0], extent[2], extent[1], extent[3]));
    }

    std::string place(const char* name) const { return case_.place(key(name)); }

    static NodeMarks marks_above_zero(const Raster& mask) {
        NodeMarks marks(mask.values.size(), 0);
        for (std::size_t k = 0; k < marks.size(); ++k) marks[k] = mask.values[k] > 0.0;
        return marks;
    }

    /// The pixels that the outline covers a part of, or all.
    static NodeMarks claimed(const Release& release, const GridGeometry& pixels) {
        if (release.outline) return pixels_under(*release.outline, pixels);
        return NodeMarks(static_cast<std::size_t>(pixels.size()), 1);
    }

    void set_depth(Release& release) const {
        const bool normal = case_.word(key("thickness")) == "normal";
        if (given("mask")) {
            const Raster mask =
                reader_.read_mask(case_.path(key("mask")), bed_.geometry.pixel_extent(), bed_.crs_wkt, log_);
            release.depth_field = depth_on(mask.geometry, true, marks_above_zero(mask));
            for (std::size_t k = 0; k < mask.values.size(); ++k)
                if (!(mask.values[k] > 0.0)) release.depth_field->values[k] = Raster::nodata;
        } else if (!depth_of_features_ && is_file("depth")) {
            reader_.require_metres(case_.path(key("depth")));
            release.depth_field = raster(case_.path(key("depth")));
            // Of a thickness normal to the bed the volume hangs on the slope, which is not known beyond the terrain.
            if (!release.outline && !normal)
                release.left_out = volume_beyond(case_.path(key("depth")), *release.depth_field);
            const NodeMarks wanted = claimed(release, release.depth_field->geometry);
            remark_on_gaps(*release.depth_field, wanted, place("depth"), log_);
            judge_negative(*release.depth_field, wanted);
            *release.depth_field = finer_field(*release.depth_field, bed_.geometry.cell);
        } else if (auto below = depth_below_surface(release)) {
            release.depth_field = finer_field(*below, bed_.geometry.cell);
        } else if (given("surface") || normal) {
            release.depth_field = depth_on(bed_.geometry, given("outline"), claimed(release, bed_.geometry));
        } else {
            release.depth = depth_number("depth");
        }
        if (normal) make_vertical(*release.depth_field, claimed(release, release.depth_field->geometry));
    }

    /// A raster of depths has some below 0 where it was resampled: a remark. Where that is much it is a difference of two
    /// surveys, in which the scar has one sign and the deposit the other.
    void judge_negative(const Raster& depth, const NodeMarks& wanted) const {
        constexpr double kMuch = 0.1;  // of what is above 0
        std::size_t count = 0, first = 0;
        double below = 0.0, above = 0.0;
        for (std::size_t k = depth.values.size(); k-- > 0;) {
            const double value = depth.values[k];
            if (!wanted[k] || std::isnan(value)) continue;
            if (value < 0.0) ++count, first = k, below -= value;
            above += std::max(0.0, value);
        }
        if (count == 0) return;
        const double pixel = depth.geometry.cell * depth.geometry.cell;
        const std::string found = fmt::format("found {} pixels below 0 with {:.4g} m3, such as {:.6g} at {}", count,
                                              below * pixel, depth.values[first], place_text(depth.geometry, first));
        if (below > kMuch * above)
            throw UserError(fmt::format(
                "{}; expected depths of what is released, 0 or more; of a later surface minus an earlier one "
                "reverse the sign, and cut out the deposit",
                found));
        log_.push_back(fmt::format("{}: {}; they are taken as 0", place("depth"), found));
    }

    /// The depth below a surface that has the pixels of the elevation model, in those, where they are larger than the
    /// cells. Both interpolated by themselves would differ by more than their pixels do, beside each step of the surface.
    /// Nothing otherwise, or where material is claimed over nodata.
    std::optional<Raster> depth_below_surface(const Release& release) const {
        if (!given("surface") || !is_file("surface")) return {};
        const std::vector<std::string> before = log_;
        std::optional<Raster> depth = surface_minus_model(release);
        if (!depth) log_ = before;
        return depth;
    }

    std::optional<Raster> surface_minus_model(const Release& release) const {
        constexpr double kRoundOff = 1e-9;
        const std::filesystem::path file = case_.path(key("surface")), dem = case_.path("terrain.dem");
        const GridGeometry& g = bed_.geometry;
        const Vec2 middle(0.5 * (g.x0 + g.x_max()), 0.5 * (g.y0 + g.y_max()));
        std::vector<std::string> unused;
        const auto part = [&](const std::filesystem::path& path, const std::array<double, 4>& extent) {
            return reader_.read_raster(path, extent, bed_.crs_wkt, unused);
        };
        try {
            const Raster pixel = part(dem, {middle.x(), middle.y(), middle.x() + g.cell, middle.y() + g.cell});
            if (!(pixel.geometry.cell > (1.0 + kRoundOff) * g.cell)) return {};
            reader_.require_metres(file);
            Raster depth = raster(file);
            const double within = kRoundOff * depth.geometry.cell;
            const auto [x0, y0, x1, y1] = depth.geometry.pixel_extent();
            const Raster model = part(dem, {x0 + within, y0 + within, x1 - within, y1 - within});
            const std::optional<NodeBox> same = box_of(depth.geometry, model.geometry);
            if (!same || !(*same == NodeBox::all(model.geometry))) return {};
            const NodeMarks wanted = claimed(release, depth.geometry);
            remark_on_gaps(depth, wanted, place("surface"), log_);
            for (std::size_t k = 0; k < depth.values.size(); ++k) {
                const bool known = std::isfinite(model.values[k]) || std::isnan(depth.values[k]);
                if (!known && release.outline && wanted[k]) return {};
                depth.values[k] = known ? depth.values[k] - model.values[k] : Raster::nodata;
            }
            return depth;
        } catch (const UserError&) {
            return {};  // the other way says what is wrong
        }
    }

    /// Depth, or surface minus bed, at the pixels of `grid`. Over nodata of the bed the depth is unknown when
    /// the case claims material there, and none otherwise.
    Raster depth_on(const GridGeometry& grid, bool claimed, const NodeMarks& places) const {
        const char* name = given("surface") ? "surface" : "depth";
        const bool file = !depth_of_features_ && is_file(name);
        if (file) reader_.require_metres(case_.path(key(name)));
        Raster field = file ? reader_.read_onto(case_.path(key(name)), grid, bed_.crs_wkt, log_)
                            : Raster::filled(grid, depth_number(name));
        if (field.source.empty()) field.source = key(name);
        if (file) remark_on_gaps(field, places, place(name), log_);
        if (!given("surface")) {
            if (file) judge_negative(field, places);
            return field;
        }
        for (Index j = 0; j < grid.ny; ++j) {
            for (Index i = 0; i < grid.nx; ++i) {
                const double bed = bed_at(grid, i, j);
                double& value = field.at(i, j);
                if (std::isnan(bed))
                    value = claimed && !std::isnan(value) ? unknown_depth : Raster::nodata;
                else
                    value -= bed;
            }
        }
        return field;
    }

    double bed_at(const GridGeometry& grid, Index i, Index j) const {
        if (grid == bed_.geometry) return bed_.at(i, j);
        return bilinear(bed_, within_terrain(Vec2(grid.x(i), grid.y(j))));
    }

    /// Pixels at the edge of a mask may have their centre beyond the terrain that they overlap.
    Vec2 within_terrain(const Vec2& point) const {
        const auto extent = bed_.geometry.pixel_extent();
        return {std::clamp(point.x(), extent[0], extent[2]), std::clamp(point.y(), extent[1], extent[3])};
    }

    /// depth = thickness / cos(slope) = thickness sqrt(1 + |grad Z|^2); outside of the claimed pixels none where the
    /// bed is not known
    void make_vertical(Raster& field, const NodeMarks& places) const {
        Raster stretch = bed_;
        for (Index j = 0; j < bed_.geometry.ny; ++j)
            for (Index i = 0; i < bed_.geometry.nx; ++i)
                stretch.at(i, j) = std::isnan(bed_.at(i, j)) ? Raster::nodata
                                                             : std::sqrt(1.0 + node_gradient(bed_, i, j).squaredNorm());
        const bool same = field.geometry == bed_.geometry;
        for (Index j = 0; j < field.geometry.ny; ++j) {
            for (Index i = 0; i < field.geometry.nx; ++i) {
                double& value = field.at(i, j);
                if (!(value > 0.0)) continue;
                const Vec2 centre(field.geometry.x(i), field.geometry.y(j));
                const double factor = same ? stretch.at(i, j) : bilinear(stretch, within_terrain(centre));
                const bool wanted = places[static_cast<std::size_t>(j * field.geometry.nx + i)] != 0;
                if (!std::isnan(factor))
                    value *= factor;
                else
                    value = wanted ? unknown_depth : Raster::nodata;
            }
        }
    }

    void set_velocity(Release& release) const {
        const std::string velocity = key("velocity");
        if (case_.is_text(velocity)) {
            release.velocity_x = speed_raster(case_.resolve(case_.words(velocity)[0]));
            release.velocity_y = speed_raster(case_.resolve(case_.words(velocity)[1]));
        } else {
            release.velocity = Vec2(case_.numbers(velocity)[0], case_.numbers(velocity)[1]);
        }
    }

    /// In m/s, whatever unit of speed its file has.
    Raster speed_raster(const std::filesystem::path& file) const {
        const std::string unit = reader_.unit_of(file), name = file.filename().string();
        const std::optional<double> factor = metres_per_second(unit);
        if (!factor)
            throw UserError(
                fmt::format("{}: found values in {}; expected m/s or another unit of speed, such as km/h; convert "
                            "them, or correct the unit: gdal_edit.py -units m/s {}",
                            name, unit, file.string()));
        Raster speeds = raster(file);
        if (*factor == 1.0) return speeds;
        for (double& speed : speeds.values) speed *= *factor;
        const std::string remark = fmt::format("{}: values in {}, converted to m/s", name, unit);
        if (std::find(log_.begin(), log_.end(), remark) == log_.end()) log_.push_back(remark);
        return speeds;
    }

    const CaseFile& case_;
    std::string table_;
    std::string prefix_;
    const Raster& bed_;
    GridGeometry terrain_;  ///< of which the bed may be a part
    const GisReader& reader_;
    std::vector<std::string>& log_;
    std::vector<double> depths_;               ///< of the outline's polygons, when they have their own [m]
    std::optional<double> depth_of_features_;  ///< of those that are a release now [m]
};

}  // namespace

std::vector<Release> read_release(const CaseFile& file, Index i, Scene& scene, const GisReader& reader,
                                  Problems& problems) {
    return ReleaseReader(file, i, scene, reader).read(problems);
}

}  // namespace frana
