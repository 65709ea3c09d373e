#include "vtk_io/figures/figure_3d.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "vtk_io/figures/colours_3d.h"
#include "vtk_io/figures/map_figure_perspective.h"

namespace frana {
namespace {

bool holds(const std::array<double, 4>& box, const Vec3& p) {
    return p.x() >= box[0] && p.x() <= box[2] && p.y() >= box[1] && p.y() <= box[3];
}

/// What has to be seen.
struct Subjects {
    std::vector<Vec3> points, barriers;
};

/// Some of the points, and the upper edges of the barriers' sides.
Subjects subjects_of(const Figure3d& figure) {
    constexpr std::size_t kMost = 400;
    Subjects subjects;
    const auto& box = figure.view.box;
    for (const BarrierSolid& barrier : figure.moment.barriers)
        for (const auto& piece : barrier.pieces)
            if (piece.normal.z() < 0.5 && holds(box, piece.corners.back()))
                subjects.barriers.push_back(piece.corners.back());
    std::vector<Vec3> all;
    for (const auto& piece : figure.moment.material)
        if (!piece.is_particle && holds(box, piece.place)) all.push_back(piece.place + Vec3(0, 0, piece.size));
    for (std::size_t k = 0; k < all.size(); k += all.size() / kMost + 1) subjects.points.push_back(all[k]);
    return subjects;
}

/// Share of the places that the ground does not hide from an eye far away against the direction of view.
double share_in_sight(const Figure3d& figure, const std::vector<Vec3>& places, double azimuth, double down) {
    if (places.empty()) return 1.0;
    const Vec3 back(-std::sin(azimuth) * std::cos(down), -std::cos(azimuth) * std::cos(down), std::sin(down));
    const double step = figure.bed.geometry.cell;
    int seen = 0;
    for (const Vec3& place : places) {
        bool free = true;
        for (Vec3 p = place + step * back; free && holds(figure.view.box, p); p += step * back)
            free = !(elevation_at(figure.bed, p.head<2>()) > p.z());
        seen += free;
    }
    return seen / static_cast<double>(places.size());
}

}  // namespace

ViewAngles3d best_view(const Figure3d& figure) {
    struct Choice {
        double turn, weight;  ///< from the flow's direction [degrees]
    };
    constexpr Choice turns[] = {{-52, 1.0},   {52, 0.97},  {-128, 0.8}, {128, 0.8},
                                {-152, 0.75}, {152, 0.75}, {0, 0.6},    {180, 0.6}};
    constexpr Choice downs[] = {{24, 1.0}, {36, 0.85}, {52, 0.7}};
    const double flow = std::atan2(figure.view.flow.x(), figure.view.flow.y());
    const Subjects subjects = subjects_of(figure);
    ViewAngles3d best;
    double best_score = -1.0;
    for (const Choice& turn : turns)
        for (const Choice& down : downs) {
            const ViewAngles3d look{flow + turn.turn * constants::kDegree, down.turn * constants::kDegree};
            const double points = share_in_sight(figure, subjects.points, look.azimuth, look.down),
                         barriers = share_in_sight(figure, subjects.barriers, look.azimuth, look.down);
            const double score = turn.weight * down.weight * points * barriers;
            if (score > best_score + 1e-9) best_score = score, best = look;
        }
    return best;
}

namespace {

/// Sides a little darker than tops, and each direction differently.
double light_on(const Vec3& normal, double azimuth) {
    const Vec2 lamp(std::sin(azimuth + 2.2), std::cos(azimuth + 2.2));  // behind the eye, to its right
    return 0.86 + 0.14 * normal.z() + 0.1 * lamp.dot(normal.head<2>());
}

/// The sides that the load acts on, seen along it.
Objects3d::Inset struck_face(const BarrierSolid& barrier, const Colours3d& colours, const std::string& caption) {
    Objects3d::Inset inset;
    const Vec2 ahead = barrier.load.head<2>().normalized(), right(ahead.y(), -ahead.x());
    constexpr double kFacing = -0.3;  // sides more than about 70 degrees askew show nothing
    for (const auto& piece : barrier.pieces) {
        if (piece.normal.head<2>().dot(ahead) > kFacing) continue;
        Objects3d::Inset::Area area{{}, colours.of_pressure(piece.pressure)};
        for (const Vec3& p : piece.corners) area.corners.emplace_back(right.dot(p.head<2>()), p.z());
        inset.areas.push_back(area);
    }
    inset.caption = caption;
    return inset;
}

Objects3d objects_of(const Figure3d& figure, double azimuth) {
    Objects3d objects;
    const Colours3d colours(figure.view);
    constexpr double kTouching =
        0.62;  // radius over size: neighbours overlap a little, so that no ground shines through
    for (const auto& piece : figure.moment.material)
        if (holds(figure.view.box, piece.place))
            objects.balls.push_back(
                {piece.place, static_cast<float>(kTouching * piece.size), colours.of_speed(piece.speed)});
    for (const BarrierSolid& barrier : figure.moment.barriers) {
        for (const auto& piece : barrier.pieces)
            if (holds(figure.view.box, piece.corners.front()))
                objects.facets.push_back(
                    {piece.corners, scaled(colours.of_pressure(piece.pressure), light_on(piece.normal, azimuth))});
        for (const auto& edge : barrier.edges)
            if (holds(figure.view.box, edge.front()) && holds(figure.view.box, edge.back()))
                objects.edges.push_back(edge);
    }
    if (const BarrierSolid* barrier = figure.moment.most_loaded())
        objects.inset = struck_face(*barrier, colours, figure.struck);
    objects.bars = colours.bars();
    return objects;
}

}  // namespace

Colours3d::Colours3d(const View3d& view) : view_(view), kilo_(view.pressure >= 2000.0) {}

Colour Colours3d::of_speed(double speed) const { return colour_at(Colormap::speed, speed / view_.fastest); }

Colour Colours3d::of_pressure(double pressure) const {
    return view_.pressure > 0.0 ? colour_at(Colormap::pressure, pressure / view_.pressure) : colours::unloaded;
}

std::vector<ColourBar> Colours3d::bars() const {
    std::vector<ColourBar> bars{{Colormap::speed, {0.0, view_.fastest, false, true}, "speed [m/s]"}};
    if (view_.pressure > 0.0)
        bars.push_back({Colormap::pressure,
                        {0.0, kilo_ ? 1e-3 * view_.pressure : view_.pressure, false, false},
                        kilo_ ? "pressure [kPa]" : "pressure [Pa]"});
    return bars;
}

bool render_3d(const Figure3d& figure, const std::filesystem::path& png, std::string& why_not) {
    const ViewAngles3d look = figure.look ? *figure.look : best_view(figure);
    PerspectiveFigure view;
    view.bed = figure.bed;
    view.field.assign(figure.bed.values.size(), 0.0);
    view.title = figure.title;
    view.footer = figure.footer;
    view.focus = figure.view.box;
    view.look_azimuth_deg = look.azimuth / constants::kDegree;
    view.look_down_deg = look.down / constants::kDegree;
    view.width = figure.width;
    view.height = figure.height;
    view.objects = objects_of(figure, look.azimuth);
    view.objects.room = figure.room;
    return render_perspective(view, png, why_not);
}

}  // namespace frana
