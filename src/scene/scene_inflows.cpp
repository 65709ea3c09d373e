// [[inflow]] of the case file.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/constants.h"
#include "base/discharge.h"
#include "law/bed/normal_flow.h"
#include "particles/generate.h"
#include "scene/inflow_facts.h"
#include "scene/inflow_table.h"
#include "scene/remarks.h"
#include "scene/scene_parts.h"
#include "terrain/outline_area.h"

namespace frana {
namespace {

constexpr Index kReach = 6;         ///< cells; what holds the flow up behind the line takes so many
constexpr Index kWaterReach = 0;    ///< free water comes in at the cells that the line crosses
constexpr double kDeepest = 100.0;  ///< more than so much on all of the terrain is a mistake [m]
/// Over an area a row is complete when so much has come, in cells. The step at the area's edge then has hardly any
/// pressure, and a point is no crumb. A slow source, whose whole depth is little more, comes in as so many layers at
/// least.
constexpr double kLayer = 0.01, kFewestLayers = 50.0;
constexpr Index kParts = 16;        ///< of an interval of the table, where speeds follow from the discharge
constexpr Index kMostParts = 4000;  ///< of all

/// Whether two sides of a ring meet within both. Sides that lie in a line do not.
bool crosses_itself(const std::vector<Vec2>& ring) {
    const auto turn = [](const Vec2& a, const Vec2& b, const Vec2& c) {
        return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
    };
    const std::size_t count = ring.size();
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = i + 1; j < count; ++j) {
            const Vec2 &a = ring[i], &b = ring[(i + 1) % count], &c = ring[j], &d = ring[(j + 1) % count];
            if (turn(a, b, c) * turn(a, b, d) < 0.0 && turn(c, d, a) * turn(c, d, b) < 0.0) return true;
        }
    return false;
}

class InflowReader {
public:
    InflowReader(const CaseFile& file, Index i, const GisReader& reader, Scene& scene)
        : case_(file),
          prefix_(fmt::format("inflow.{}.", i)),
          reader_(reader),
          scene_(scene),
          bed_(scene.bed),
          water_(file.word("water.model") == "free"),
          reach_(water_ ? kWaterReach : kReach) {}

    /// Nothing when something is wrong.
    std::optional<Inflow> read(Problems& problems) {
        inflow_.name = case_.word(prefix_ + "name");
        inflow_.spacing = bed_.geometry.cell / std::sqrt(case_.number("particles.per_cell"));
        return given("area") ? read_area(problems) : read_line_of_it(problems);
    }

private:
    template <class Work>
    bool attempt(Problems& problems, const char* key, Work&& work) {
        return problems.attempt(case_.place(prefix_ + key), work);
    }

    std::optional<Inflow> read_line_of_it(Problems& problems) {
        Hydrograph table;
        bool good = attempt(problems, "line", [&] {
            inflow_.line = read_line(case_, prefix_ + "line", reader_, bed_.crs_wkt, scene_.log);
            require_ground();
        });
        good = good && attempt(problems, given("towards") ? "towards" : "line", [&] { choose_side(); });
        good &= attempt(problems, given("table") ? "table" : "volume", [&] {
            table = hydrograph();
            require_room(table);
        });
        if (!good) return {};
        if (!table.remark.empty()) scene_.log.push_back(table.remark);
        if (!table.velocity.empty() && !given("velocity"))
            scene_.log.push_back(
                fmt::format("inflow {}: the velocities of its table are not used, since velocity is not given and the "
                            "speed is that of uniform flow; give velocity = \"column\" to use them",
                            inflow_.name));
        inflow_.time = table.time, inflow_.discharge = table.discharge;
        if (!attempt(problems, "velocity", [&] { set_speed(table); })) return {};
        remark_on_climb();
        return inflow_;
    }

    /// With a speed of its own a flow may climb; it is seldom meant.
    void remark_on_climb() {
        constexpr double kEven = 1e-6;
        if (inflow_.slope >= -kEven) return;
        scene_.log.push_back(
            fmt::format("{}: found a line that the flow leaves up a slope of {:.3g} degrees; expected it to go down; "
                        "move towards to the other side, unless this is meant",
                        case_.place(prefix_ + "towards"), std::atan(-inflow_.slope) * constants::kRadian));
    }

    std::optional<Inflow> read_area(Problems& problems) {
        Hydrograph table;
        bool good = attempt(problems, "area", [&] {
            place_patches(read_outline(case_, prefix_ + "area", reader_, bed_.crs_wkt, scene_.log));
        });
        good &= attempt(problems, given("table") ? "table" : "volume", [&] {
            table = hydrograph();
            require_room(table);
        });
        if (!good) return {};
        if (!table.remark.empty()) scene_.log.push_back(table.remark);
        if (!table.velocity.empty())
            scene_.log.push_back(fmt::format(
                "inflow {}: the velocities of its table are not used; over an area it comes in at rest", inflow_.name));
        inflow_.time = table.time, inflow_.discharge = table.discharge;
        inflow_.speed.assign(table.time.size(), 0.0);
        inflow_.layer = water_ ? 0.0 : layer_of(table.volume() / inflow_.area);
        return inflow_;
    }

    /// As a release of that outline has its points; each gets what the outline covers of its patch.
    void place_patches(const Polygons& outline) {
        require_within(outline);
        Release release;
        release.outline = outline, release.depth = 1.0, release.name = "the area of inflow " + inflow_.name;
        ParticleOptions options;
        options.per_cell = case_.number("particles.per_cell");
        std::vector<ReleaseReport> reports;
        std::vector<std::string> unused;
        require_area(outline);
        const Seeds seeds = make_seeds({release}, bed_, options, reports, unused);
        inflow_.spacing = seeds.size.front();
        for (const double patch : seeds.volume) inflow_.area += patch;
        const double cell = bed_.geometry.cell;
        if (inflow_.area < cell * cell)
            throw UserError(
                fmt::format("found an area of {:.3g} m2; expected a cell ({:.6g} m2) at least; enlarge it, or "
                            "give a smaller grid.cell",
                            inflow_.area, cell * cell));
        for (Index p = 0; p < seeds.count(); ++p)
            inflow_.patches.push_back({{seeds.x[p], seeds.y[p]}, seeds.volume[p] / inflow_.area});
    }

    /// A line that is closed, or drawn to and fro, is no area.
    void require_area(const Polygons& outline) const {
        double area = 0.0, reach = 0.0;
        const Rings rings = rings_of(outline, {bed_.geometry.x0, bed_.geometry.y0});
        for (const auto& ring : rings) {
            area += ring_area(ring);
            for (const Vec2& corner : ring) reach = std::max(reach, (corner - ring.front()).squaredNorm());
        }
        constexpr double round_off = 1e-9;
        if (std::abs(area) > round_off * reach) return;
        if (std::any_of(rings.begin(), rings.end(), crosses_itself))
            throw UserError(
                "found an outline that crosses itself, whose parts cancel out; expected one that goes round the area "
                "once; put its corners in their order");
        throw UserError(
            "found an outline without area, such as a line; expected the outline of an area; draw it around what "
            "flows, or give it as inflow.line");
    }

    /// Between the outer nodes.
    void require_within(const Polygons& outline) const {
        const GridGeometry& g = bed_.geometry;
        const double x1 = g.x(g.nx - 1), y1 = g.y(g.ny - 1), slack = 1e-9 * (std::abs(x1) + std::abs(y1) + 1.0);
        Index corners = 0;
        for (const Polygon& polygon : outline.parts)
            for (const auto& ring : polygon.rings)
                for (const Vec2& at : ring) {
                    ++corners;
                    if (at.x() >= g.x0 - slack && at.y() >= g.y0 - slack && at.x() <= x1 + slack &&
                        at.y() <= y1 + slack)
                        continue;
                    throw UserError(fmt::format(
                        "found {:.10g}, {:.10g} outside of the terrain; expected all of the area within x "
                        "{:.10g} to {:.10g}, y {:.10g} to {:.10g}; move it inwards, or widen terrain.window",
                        at.x(), at.y(), g.x0, x1, g.y0, y1));
                }
        if (corners == 0)
            throw UserError(outline.source +
                            ": found no polygon; expected the outline of an area; export it as polygons");
    }

    /// Of all depth that comes. The last row is half of one: no crumb is left over by rounding.
    double layer_of(double depth) const {
        const double layers = std::max(kFewestLayers, std::ceil(depth / (kLayer * bed_.geometry.cell)));
        return depth / (layers - 0.5);
    }

    bool given(const char* name) const { return case_.given(prefix_ + name); }

    void require_ground() const {
        const GridGeometry& g = bed_.geometry;
        const double width = inflow_.width();
        if (width < g.cell)
            throw UserError(
                fmt::format("found a line of {:.3g} m; expected a cell ({:.6g} m) at least; lengthen it, or give a "
                            "smaller grid.cell",
                            width, g.cell));
        for (std::size_t k = 0; k + 1 < inflow_.line.size(); ++k) {
            const Vec2 piece = inflow_.line[k + 1] - inflow_.line[k];
            const auto parts = static_cast<Index>(std::ceil(2.0 * piece.norm() / g.cell));
            for (Index part = 0; part <= parts; ++part) {
                const Vec2 at = inflow_.line[k] + static_cast<double>(part) / static_cast<double>(parts) * piece;
                const Index i = node_of(at.x(), g.x0, g.nx), j = node_of(at.y(), g.y0, g.ny);
                for (Index dj = -reach_; dj <= reach_; ++dj)
                    for (Index di = -reach_; di <= reach_; ++di) require_node(i + di, j + dj, at);
            }
        }
    }

    /// The nearest node. Cells of water reach as far as the pixels: what ends on their border is within.
    Index node_of(double at, double start, Index count) const {
        constexpr double kSlack = 1e-9;
        const double cells = (at - start) / bed_.geometry.cell;
        const bool on_border = cells + 0.5 > -kSlack && cells + 0.5 < static_cast<double>(count) + kSlack;
        const auto nearest = static_cast<Index>(std::lround(cells));
        return water_ && on_border ? std::clamp<Index>(nearest, 0, count - 1) : nearest;
    }

    void require_node(Index i, Index j, const Vec2& at) const {
        const GridGeometry& g = bed_.geometry;
        const bool inside = i >= 0 && j >= 0 && i < g.nx && j < g.ny;
        if (inside && !std::isnan(bed_.at(i, j))) return;
        const std::string found = fmt::format("found {:.10g}, {:.10g} {}; expected ", at.x(), at.y(),
                                              inside ? "beside nodata" : "outside of the terrain, or at its edge");
        throw UserError(found +
                        (water_ ? "a line on the terrain" : fmt::format("ground {} cells around the line", reach_)) +
                        "; move it inwards");
    }

    /// Down the slope, or to the side where `towards` lies.
    void choose_side() {
        const double rise = rise_across(inflow_.line, bed_);
        if (given("towards")) {
            const auto& xy = case_.numbers(prefix_ + "towards");
            const Vec2 a = inflow_.line.front(), along = inflow_.line.back() - a, to = Vec2(xy[0], xy[1]) - a;
            const double left = along.x() * to.y() - along.y() * to.x();
            if (std::abs(left) <= 1e-9 * along.norm() * (to.norm() + along.norm()))
                throw UserError(
                    "found towards on the line itself; expected a point on the side that the flow goes to; move it");
            inflow_.to_right = left < 0.0;
        } else {
            require_one_slope(rise);
            inflow_.to_right = rise < 0.0;
        }
        inflow_.slope = inflow_.to_right ? -rise : rise;
    }

    /// Not flat, and not across a ridge or a valley's floor where half goes the other way.
    void require_one_slope(double rise) const {
        constexpr double kFlat = 1e-6;
        if (std::abs(rise) <= kFlat) throw UserError(why_no_side());
        double up = 0.0, all = 0.0;
        for (std::size_t k = 0; k + 1 < inflow_.line.size(); ++k) {
            const Vec2 piece = inflow_.line[k + 1] - inflow_.line[k];
            const auto parts = static_cast<Index>(std::ceil(2.0 * piece.norm() / bed_.geometry.cell));
            for (Index part = 0; part < parts; ++part) {
                const Vec2 a = inflow_.line[k] + static_cast<double>(part) / static_cast<double>(parts) * piece;
                const Vec2 b = inflow_.line[k] + static_cast<double>(part + 1) / static_cast<double>(parts) * piece;
                const double length = (b - a).norm();
                all += length;
                if (rise_across({a, b}, bed_) * rise < 0.0) up += length;
            }
        }
        if (up > 0.25 * all)
            throw UserError(
                fmt::format("found {:.0f} % of the line on ground that slopes the other way; expected a line across "
                            "the flow, not across a ridge; move it, or give towards = [x, y], a point on the side "
                            "that the flow goes to",
                            100.0 * up / all));
    }

    /// Mean slopes of the ground over a line: across it, of both senses; along it; from it to both sides.
    struct Slopes {
        double across = 0.0, along = 0.0, off = 0.0;  ///< [1]
    };
    Slopes slopes_at(const Vec2& at, const Vec2& way) const {
        constexpr double kOff = 2.0;  // cells
        const GridGeometry& g = bed_.geometry;
        const auto node = [&](const Vec2& place) {
            return std::pair{node_of(place.x(), g.x0, g.nx), node_of(place.y(), g.y0, g.ny)};
        };
        const auto [i, j] = node(at);
        const Vec2 right(way.y(), -way.x()), slope = node_gradient(bed_, i, j);
        Slopes here{std::abs(slope.dot(right)), std::abs(slope.dot(way)), 0.0};
        for (const double side : {-kOff, kOff}) {
            const auto [a, b] = node(at + side * g.cell * right);
            if (a < 0 || b < 0 || a >= g.nx || b >= g.ny || std::isnan(bed_.at(a, b))) continue;
            here.off += (bed_.at(a, b) - bed_.at(i, j)) / (2.0 * kOff * g.cell);
        }
        return here;
    }
    Slopes slopes() const {
        Slopes sum;
        const double width = inflow_.width();
        for (std::size_t k = 0; k + 1 < inflow_.line.size(); ++k) {
            const Vec2 piece = inflow_.line[k + 1] - inflow_.line[k];
            const auto parts = static_cast<Index>(std::ceil(2.0 * piece.norm() / bed_.geometry.cell));
            const double share = piece.norm() / width / static_cast<double>(parts);
            for (Index part = 0; part < parts; ++part) {
                const double at = (static_cast<double>(part) + 0.5) / static_cast<double>(parts);
                const Slopes here = slopes_at(inflow_.line[k] + at * piece, piece.normalized());
                sum.across += share * here.across, sum.along += share * here.along, sum.off += share * here.off;
            }
        }
        return sum;
    }

    /// Why the ground across the line does not slope on the whole.
    std::string why_no_side() const {
        constexpr double kEven = 1e-6;
        const Slopes mean = slopes();
        const auto degrees = [](double slope) { return std::atan(std::abs(slope)) * constants::kRadian; };
        const char* const way_out = "give towards = [x, y], a point on the side that the flow goes to";
        if (mean.across > kEven)
            return fmt::format(
                "found ground that slopes to one side of the line as much as to the other, by {:.3g} degrees; expected "
                "a line across the flow, not across a ridge; move it, or {}",
                degrees(mean.across), way_out);
        if (mean.along > kEven)
            return fmt::format(
                "found a line that runs down the slope of {:.3g} degrees; expected one across the flow; turn it, or {}",
                degrees(mean.along), way_out);
        if (std::abs(mean.off) > kEven)
            return fmt::format(
                "found a line along {} by {:.3g} degrees; expected one across the flow; move it, or {}",
                mean.off < 0.0 ? "a ridge, which falls to both sides" : "a valley's floor, which rises to both sides",
                degrees(mean.off), way_out);
        return fmt::format("found flat ground under the line; expected a slope, which tells where the flow goes; {}",
                           way_out);
    }

    Hydrograph hydrograph() const {
        if (given("table")) return read_hydrograph(case_.path(prefix_ + "table"));
        const double volume = case_.number(prefix_ + "volume"), peak = highest_discharge(volume);
        if (!given("rise")) return triangle(volume, peak, case_.number(prefix_ + "at"));
        const double rise = case_.number(prefix_ + "rise"), whole = 2.0 * volume / peak;
        if (!(rise < whole))
            throw UserError(
                fmt::format("found a rise of {:g} s; expected less than the {:.6g} s that a triangle of {:g} m3 "
                            "with {:.6g} m3/s takes; give a shorter rise, or another volume or peak",
                            rise, whole, volume, peak));
        return triangle(volume, peak, case_.number(prefix_ + "at"), rise);
    }

    double highest_discharge(double volume) const {
        const std::string key = prefix_ + "peak";
        if (!given("peak")) return peak_discharge(peak_formulas().front(), volume);
        return case_.is_text(key) ? peak_discharge(case_.word(key), volume) : case_.number(key);
    }

    void require_room(const Hydrograph& table) const {
        const GridGeometry& g = scene_.wider ? scene_.wider->grid : bed_.geometry;
        const double most = kDeepest * g.cell * g.cell * static_cast<double>(g.size());
        // A river's table may go on for days.
        const double comes = given("table") ? volume_until(table, scene_.end) : table.volume();
        if (comes > most)
            throw UserError(fmt::format(
                "found {:.4g} m3{}, more than {:.0f} m of depth on all of the terrain; expected less; check "
                "the units",
                comes, given("table") ? " by time.end" : "", kDeepest));
        require_time(table);
    }

    void require_time(const Hydrograph& table) const {
        const bool own = given("table");
        const char* const what = own ? "a table that" : "that the triangle of volume";
        if (table.time.front() >= scene_.end)
            throw UserError(fmt::format(
                "found {} begins at {:.6g} s; expected a time before time.end = {:.6g} s; {}", what, table.time.front(),
                scene_.end, own ? "shift the table, or run longer" : "give a smaller at, or a later time.end"));
        if (table.time.back() > scene_.end)
            scene_.log.push_back(
                fmt::format("inflow {}: found {} goes on to {:.6g} s; expected time.end = {:.6g} s or less; what comes "
                            "later does not come in; {}",
                            inflow_.name, what, table.time.back(), scene_.end,
                            own ? "run longer, or cut the table" : "give a later time.end, or a smaller at"));
    }

    void set_speed(const Hydrograph& table) {
        const std::string key = prefix_ + "velocity";
        const double cosine = 1.0 / std::sqrt(1.0 + inflow_.slope * inflow_.slope);
        if (!case_.is_text(key)) {
            inflow_.speed.assign(table.time.size(), cosine * case_.number(key));
        } else if (case_.word(key) == "column") {
            if (table.velocity.empty())
                throw UserError(
                    "found velocity = \"column\" and a table without one; expected a column velocity [m/s]; add it, "
                    "or give velocity = \"normal\"");
            for (const double velocity : table.velocity) inflow_.speed.push_back(cosine * velocity);
        } else {
            refine();
            for (const double discharge : inflow_.discharge) inflow_.speed.push_back(cosine * normal_speed(discharge));
        }
    }

    /// Between two rows the speed of uniform flow is not linear.
    void refine() {
        const auto rows = static_cast<Index>(inflow_.time.size());
        const Index parts = std::clamp<Index>(kMostParts / rows, 1, kParts);
        std::vector<double> time{inflow_.time.front()}, discharge{inflow_.discharge.front()};
        for (std::size_t n = 0; n + 1 < inflow_.time.size(); ++n) {
            const double dq = inflow_.discharge[n + 1] - inflow_.discharge[n],
                         dt = inflow_.time[n + 1] - inflow_.time[n];
            for (Index part = 1; dq != 0.0 && part < parts; ++part) {
                const double share = static_cast<double>(part) / static_cast<double>(parts);
                time.push_back(inflow_.time[n] + share * dt), discharge.push_back(inflow_.discharge[n] + share * dq);
            }
            time.push_back(inflow_.time[n + 1]), discharge.push_back(inflow_.discharge[n + 1]);
        }
        inflow_.time = std::move(time), inflow_.discharge = std::move(discharge);
    }

    /// What holds the flow at an even speed. Of water it is its own friction, not the bed law of the grains in it.
    /// Darcy and Weisbach's is Voellmy's drag alone, with xi = 8 g / f.
    BedLaw law() const {
        if (!water_) return bed_law_at(scene_, inflow_.middle());
        const WaterFriction of = water_friction_at(scene_, inflow_.middle(), water_friction(case_));
        if (of.law == WaterFriction::Law::manning) return bed::Manning{of.coefficient};
        if (of.law == WaterFriction::Law::none) return bed::None{};
        return bed::Voellmy{0.0, 8.0 * scene_.gravity / of.coefficient};
    }

    /// Along the bed [m/s].
    double normal_speed(double discharge) const {
        const char* const way_out = "give velocity = a number [m/s]";
        const double degrees = std::atan(inflow_.slope) * constants::kRadian;
        if (!(discharge > 0.0)) return 0.0;
        if (!(inflow_.slope > 0.0))
            throw UserError(
                fmt::format("found velocity = \"normal\" on ground that rises by {:.3g} degrees; expected a slope "
                            "that the flow goes down; {}{}",
                            -degrees, way_out, given("towards") ? ", or correct towards" : ""));
        const bed::NormalFlow flow =
            bed::normal_flow(law(), discharge / inflow_.width(), {inflow_.slope, scene_.gravity, scene_.density});
        if (flow.speed == 0.0)
            throw UserError(
                fmt::format("found velocity = \"normal\" where the material stops on the slope of {:.3g} degrees; "
                            "expected one that it flows down; {}",
                            degrees, way_out));
        if (std::isinf(flow.speed))
            throw UserError(
                fmt::format("found velocity = \"normal\" with a {} by which the flow gets faster for ever on "
                            "{:.3g} degrees; expected one with drag, such as {}; {}",
                            water_ ? "water.friction" : "bed law", degrees,
                            water_ ? "\"manning\" or \"darcy_weisbach\"" : "\"voellmy\" or \"manning\"", way_out));
        return flow.speed;
    }

    const CaseFile& case_;
    std::string prefix_;
    const GisReader& reader_;
    Scene& scene_;
    const Raster& bed_;
    bool water_;
    Index reach_;
    Inflow inflow_;
};

}  // namespace

Polygons read_outline(const CaseFile& file, const std::string& key, const GisReader& reader, const std::string& crs_wkt,
                      std::vector<std::string>& log) {
    if (file.is_text(key)) return reader.read_polygons(file.path(key), crs_wkt, log);
    Polygons drawn;
    drawn.parts.push_back({{file.points(key)}});
    drawn.source = key;
    return drawn;
}

void read_inflows(const CaseFile& file, const GisReader& reader, Scene& scene, Problems& problems) {
    for (Index i = 0; i < file.count("inflow"); ++i) {
        std::optional<Inflow> inflow = InflowReader(file, i, reader, scene).read(problems);
        if (!inflow) continue;
        scene.log.push_back(inflow_sentence(inflow->name, facts_of(*inflow, scene.gravity)));
        const std::string velocity = fmt::format("inflow.{}.velocity", i);
        if (file.given(velocity) && !inflow->speed.empty())
            remark_on(scene.log, Remark::release_speed, file.place(velocity),
                      {*std::max_element(inflow->speed.begin(), inflow->speed.end())});
        scene.inflows.push_back(std::move(*inflow));
    }
}

}  // namespace frana
