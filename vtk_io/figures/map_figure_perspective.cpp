#include "vtk_io/figures/map_figure_perspective.h"

#include <fmt/core.h>
#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkRenderer.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "base/error.h"
#include "vtk_io/figures/actors_3d.h"
#include "vtk_io/figures/map_figure_block.h"
#include "vtk_io/figures/map_figure_furniture.h"
#include "vtk_io/figures/map_figure_overlay.h"
#include "vtk_io/figures/map_figure_paint.h"
#include "vtk_io/figures/map_figure_piece.h"
#include "vtk_io/figures/offscreen.h"
#include "vtk_io/figures/png_file.h"
#include "vtk_io/hillshade.h"
#include "vtk_io/level_lines.h"

namespace frana {
namespace {

using Vec3 = Eigen::Vector3d;

Eigen::Vector4d with_one(const Vec3& p) { return {p.x(), p.y(), p.z(), 1.0}; }

/// Few drops that are thrown up need not be in view.
double height_of_most(const std::vector<Objects3d::Ball>& balls) {
    if (balls.empty()) return 0.0;
    std::vector<double> heights;
    heights.reserve(balls.size());
    for (const auto& ball : balls) heights.push_back(ball.centre.z());
    const auto at = heights.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(heights.size() - 1));
    std::nth_element(heights.begin(), at, heights.end());
    return *at;
}

class BlockDrawing {
public:
    explicit BlockDrawing(const PerspectiveFigure& figure)
        : figure_(figure),
          unit_(text_unit(figure.width, figure.height)),
          colours_(colours_within(figure.field, figure.outline_field, figure.shown_above, figure.colormap, figure.range,
                                  figure.thick_release ? Top::flow : Top::percentile)),
          captions_(make_captions(figure.title, figure.footer, unit_, figure.width)) {
        const MapBox box = block_of(figure);
        origin_ = {0.5 * (box[0] + box[2]), 0.5 * (box[1] + box[3])};
        build(box);
    }

    void scene(vtkRenderer* renderer);
    void explanations(Canvas& canvas) const;

private:
    void build(const MapBox& box);
    void lines(vtkRenderer* renderer) const;
    void cased(vtkRenderer* renderer, const std::vector<Polyline>& lines, double lift, const Colour& colour,
               double pen) const;
    std::vector<Polyline> survey_rings() const;
    void aim(vtkRenderer* renderer);
    void aim_from_eye(vtkRenderer* renderer);
    void keep_projection(vtkCamera* camera);
    std::vector<Vec3> silhouette() const;
    Vec2 most_of_inset() const { return {0.5 * figure_.width, 0.16 * figure_.height}; }
    double aspect_of_room() const { return room_.width() / room_.height(); }
    Vec2 on_picture(const Vec3& point) const;
    void edge_length(Canvas& canvas, const Vec3& a, const Vec3& b, double metres) const;

    const PerspectiveFigure& figure_;
    double unit_;
    ColourRange colours_;
    Captions captions_;
    Vec2 origin_{0, 0};
    Raster surface_, outlined_;  ///< on the mesh: the ground with the flow, and the field that is outlined
    Pixels skin_;
    double foot_ = 0.0, azimuth_ = 0.0;
    Vec3 eye_{0, 0, 0};
    Vec3 target_{0, 0, 0};  ///< seen in the middle
    Rectangle room_;        ///< of the picture, for the block [px]
    Eigen::Matrix4d to_unit_square_ = Eigen::Matrix4d::Identity();
};

void BlockDrawing::build(const MapBox& box) {
    const double longest = std::max(box[2] - box[0], box[3] - box[1]);
    const double cells = longest / figure_.bed.geometry.cell;
    const Raster field{figure_.bed.geometry, figure_.field, "", ""};
    const auto raised = [&](const GridGeometry& grid, Raster& field_there) {
        Raster ground = resampled(figure_.bed, grid, Between::smooth);
        field_there = resampled(field, grid, Between::linear);
        if (!figure_.raised) return ground;
        for (std::size_t i = 0; i < ground.values.size(); ++i)
            if (field_there.values[i] > figure_.shown_above) ground.values[i] += field_there.values[i];
        return ground;
    };
    surface_ = raised(block_grid(box, std::clamp(4.0 * cells, 60.0, 500.0)), outlined_);
    Raster field_fine;
    const double texels = std::min(1500.0, 1.1 * figure_.width);  // no finer than the picture can show
    const Raster fine = raised(block_grid(box, texels), field_fine);
    double shown_above = figure_.shown_above;
    if (!figure_.outline_field.empty()) {
        const Raster outlined{figure_.bed.geometry, figure_.outline_field, "", ""};
        outlined_ = resampled(outlined, surface_.geometry, Between::linear);
        field_fine.values =
            inside_outline(field_fine.values, resampled(outlined, fine.geometry, Between::linear).values, shown_above);
        shown_above = kAll;
    }
    double low = 1e300;
    for (const double z : surface_.values)
        if (!std::isnan(z)) low = std::min(low, z);
    foot_ = (low < 1e300 ? low : 0.0) - 0.05 * longest;
    const double up = uphill_azimuth(surface_, outlined_, figure_.shown_above);
    azimuth_ =
        figure_.look_azimuth_deg ? *figure_.look_azimuth_deg * constants::kDegree : up + 25.0 * constants::kDegree;
    if (const auto& eye = figure_.eye)
        azimuth_ = std::atan2(eye->target[0] - eye->position[0], eye->target[1] - eye->position[1]);
    const double from_the_left = azimuth_ - 30.0 * constants::kDegree;  // the eye expects light from the upper left
    skin_ = painted(fine, field_fine, {figure_.colormap, colours_, shown_above, from_the_left});
    const double left = 1.5 * unit_, right = 9.0 * unit_;
    const double inset =
        height_of_inset(figure_.objects.inset, most_of_inset(), unit_);  // nothing may lie over the block
    room_ = {left, captions_.footer_height() + 2.5 * unit_, figure_.width - right,
             figure_.height - captions_.title_height() - 1.2 * unit_ - inset};
}

void BlockDrawing::lines(vtkRenderer* renderer) const {
    const GridGeometry& g = surface_.geometry;
    const double lift = 0.0015 * g.cell * static_cast<double>(std::max(g.nx, g.ny));
    Raster shown = outlined_;
    for (double& value : shown.values) value = std::isnan(value) ? 0.0 : std::abs(value);
    renderer->AddActor(
        draped_actor(level_lines(shown, figure_.shown_above), surface_, lift, origin_, colours::black, 0.1 * unit_));
    double low = 1e300, high = -1e300;
    for (const double z : surface_.values)
        if (!std::isnan(z)) low = std::min(low, z), high = std::max(high, z);
    const bool relief = high - low > 1e-6 * g.cell;  // resampling leaves level ground level to round-off only
    const double interval = relief ? round_up_125((high - low) / 25.0) : 0.0;
    std::vector<Polyline> contours;
    for (double n = std::ceil(low / interval); interval > 0.0 && n * interval <= high; ++n)
        for (const auto& line : level_lines(surface_, (n + 1e-4) * interval)) contours.push_back(line);
    Colour faint = colours::contour;
    faint.a = 110;
    renderer->AddActor(draped_actor(contours, surface_, lift, origin_, faint, 1.0));
    const double x1 = g.x_max(), y1 = g.y_max();
    renderer->AddActor(draped_actor({{{g.x0, g.y0}, {x1, g.y0}, {x1, y1}, {g.x0, y1}, {g.x0, g.y0}}}, surface_, 0.0,
                                    origin_, colours::note, 1.5));
    cased(renderer, survey_rings(), lift, colours::survey, 0.16);
    std::vector<Polyline> barriers;
    for (const NamedLine& barrier : figure_.barriers) barriers.push_back(barrier.line);
    cased(renderer, barriers, lift, colours::barrier, kBarrierPen);
}

/// Lines on wider white ones; `pen` in sizes of ordinary text.
void BlockDrawing::cased(vtkRenderer* renderer, const std::vector<Polyline>& lines, double lift, const Colour& colour,
                         double pen) const {
    if (lines.empty()) return;
    renderer->AddActor(draped_actor(lines, surface_, lift, origin_, colours::white, 2.0 * pen * unit_));
    renderer->AddActor(draped_actor(lines, surface_, 1.6 * lift, origin_, colour, pen * unit_));
}

/// Each ends where it begins.
std::vector<Polyline> BlockDrawing::survey_rings() const {
    std::vector<Polyline> rings;
    if (figure_.survey) rings = all_rings(*figure_.survey);
    for (Polyline& ring : rings)
        if (!ring.empty()) ring.push_back(ring.front());
    return rings;
}

std::vector<Vec3> BlockDrawing::silhouette() const {
    std::vector<Vec3> points;
    const GridGeometry& g = surface_.geometry;
    const Index stride = std::max<Index>(1, std::max(g.nx, g.ny) / 60);
    for (Index j = 0; j < g.ny; j += stride)
        for (Index i = 0; i < g.nx; i += stride)
            if (!std::isnan(surface_.at(i, j)))
                points.emplace_back(g.x(i) - origin_.x(), g.y(j) - origin_.y(), surface_.at(i, j));
    for (const double x : {g.x0, g.x_max()})
        for (const double y : {g.y0, g.y_max()}) points.emplace_back(x - origin_.x(), y - origin_.y(), foot_);
    const Vec3 origin(origin_.x(), origin_.y(), 0.0);
    for (const Vec3& place : figure_.objects.room) points.emplace_back(place - origin);
    const double highest = height_of_most(figure_.objects.balls);
    for (const auto& ball : figure_.objects.balls)
        if (figure_.objects.room.empty() && ball.centre.z() <= highest) points.emplace_back(ball.centre - origin);
    for (const auto& facet : figure_.objects.facets)
        for (const Vec3& corner : facet.corners) points.emplace_back(corner - origin);
    return points;
}

void BlockDrawing::keep_projection(vtkCamera* camera) {
    const double* m = camera->GetCompositeProjectionTransformMatrix(aspect_of_room(), -1.0, 1.0)->GetData();
    to_unit_square_ = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(m);
}

/// The camera at the figure's eye.
void BlockDrawing::aim_from_eye(vtkRenderer* renderer) {
    const auto relative = [&](const std::array<double, 3>& p) {
        return Vec3(p[0] - origin_.x(), p[1] - origin_.y(), p[2]);
    };
    eye_ = relative(figure_.eye->position);
    target_ = relative(figure_.eye->target);
    double farthest = (target_ - eye_).norm();
    for (const Vec3& p : silhouette()) farthest = std::max(farthest, (p - eye_).norm());
    vtkCamera* camera = renderer->GetActiveCamera();
    camera->SetViewAngle(figure_.eye->view_angle_deg);
    camera->SetPosition(eye_.x(), eye_.y(), eye_.z());
    camera->SetFocalPoint(target_.x(), target_.y(), target_.z());
    const bool straight_down = (target_ - eye_).head<2>().norm() < 1e-6 * (target_ - eye_).norm();
    straight_down ? camera->SetViewUp(0.0, 1.0, 0.0) : camera->SetViewUp(0.0, 0.0, 1.0);
    camera->SetClippingRange(1e-3 * farthest, 1.1 * farthest);
    keep_projection(camera);
}

/// Moves the camera back and sideways until the block just fills its room.
void BlockDrawing::aim(vtkRenderer* renderer) {
    const GridGeometry& g = surface_.geometry;
    const double down = figure_.look_down_deg * constants::kDegree;
    const Vec3 ahead(std::sin(azimuth_) * std::cos(down), std::cos(azimuth_) * std::cos(down), -std::sin(down));
    const Vec3 right(std::cos(azimuth_), -std::sin(azimuth_), 0.0);
    const Vec3 up = right.cross(ahead);
    const double size = g.cell * static_cast<double>(g.nx + g.ny);
    const double aspect = aspect_of_room();
    const auto points = silhouette();
    Vec3 target(0.0, 0.0, foot_);
    double distance = 3.0 * size;
    vtkCamera* camera = renderer->GetActiveCamera();
    camera->SetViewAngle(24.0);
    const double half = std::tan(12.0 * constants::kDegree);
    for (int pass = 0; pass < 12; ++pass) {
        eye_ = target - distance * ahead;
        camera->SetFocalPoint(target.x(), target.y(), target.z());
        camera->SetPosition(eye_.x(), eye_.y(), eye_.z());
        camera->SetViewUp(0.0, 0.0, 1.0);
        camera->SetClippingRange(0.05 * distance, distance + 4.0 * size);
        keep_projection(camera);
        Vec2 low(1e9, 1e9), high(-1e9, -1e9);
        for (const Vec3& p : points) {
            const Eigen::Vector4d q = to_unit_square_ * with_one(p);
            const Vec2 seen = q.head<2>() / q.w();
            low = low.cwiseMin(seen);
            high = high.cwiseMax(seen);
        }
        const Vec2 middle = 0.5 * (low + high);
        target += distance * half * (middle.x() * aspect * right + middle.y() * up);
        distance *= std::clamp(0.5 * (high - low).maxCoeff() / 0.97, 0.5, 2.0);
    }
}

void BlockDrawing::scene(vtkRenderer* renderer) {
    renderer->SetViewport(room_.x0 / figure_.width, room_.y0 / figure_.height, room_.x1 / figure_.width,
                          room_.y1 / figure_.height);
    renderer->AddActor(skin_actor(surface_, skin_, origin_));
    renderer->AddActor(wall_actor(surface_, foot_, origin_));
    lines(renderer);
    const Objects3d& objects = figure_.objects;
    if (!objects.facets.empty()) renderer->AddActor(facets_actor(objects.facets, origin_));
    if (!objects.edges.empty()) renderer->AddActor(edges_actor(objects.edges, origin_, 0.1 * unit_));
    if (!objects.balls.empty()) renderer->AddActor(balls_actor(objects.balls, origin_));
    figure_.eye ? aim_from_eye(renderer) : aim(renderer);
}

Vec2 BlockDrawing::on_picture(const Vec3& point) const {
    const Eigen::Vector4d q = to_unit_square_ * with_one(point);
    return {room_.x0 + 0.5 * (1.0 + q.x() / q.w()) * room_.width(),
            room_.y0 + 0.5 * (1.0 + q.y() / q.w()) * room_.height()};
}

/// The length of a bottom edge written along it, below.
void BlockDrawing::edge_length(Canvas& canvas, const Vec3& a, const Vec3& b, double metres) const {
    Vec2 from = on_picture(a), to = on_picture(b);
    if (from.x() > to.x()) std::swap(from, to);
    const Vec2 along = (to - from).normalized();
    if ((to - from).norm() < 5.0 * unit_) return;
    TextStyle style{0.9 * unit_, Across::centre, Upward::top, 0.0, false, false, colours::note};
    style.angle = std::atan2(along.y(), along.x()) / constants::kDegree;
    const std::string text =
        metres >= 1000.0 ? fmt::format("{:.2g} km", 1e-3 * metres) : fmt::format("{:.3g} m", metres);
    canvas.text(text, 0.5 * (from + to) + 0.4 * unit_ * Vec2(along.y(), -along.x()), style);
}

void BlockDrawing::explanations(Canvas& canvas) const {
    const double u = unit_, w = figure_.width, h = figure_.height;
    const double tall = std::min(0.5 * room_.height(), 24.0 * u);
    const double middle = 0.5 * (room_.y0 + room_.y1);
    std::vector<ColourBar> bars = figure_.objects.bars;
    if (bars.empty()) bars.push_back({figure_.colormap, colours_, figure_.field_label});
    const double gap = 1.5 * u, each = (tall + gap) / static_cast<double>(bars.size()) - gap;
    for (std::size_t n = 0; n < bars.size(); ++n) {  // one above the other
        const double top = middle + 0.5 * tall - static_cast<double>(n) * (each + gap);
        draw_colour_bar(canvas,
                        {std::round(w - 7.0 * u), std::round(top - each), std::round(w - 5.9 * u), std::round(top)},
                        bars[n].range, bars[n].colormap, bars[n].label, u);
    }
    const Vec2 corner(1.5 * u, h - captions_.title_height() - 1.7 * u);
    draw_inset(canvas, figure_.objects.inset, corner, most_of_inset(), u);
    double x_of_entry = u;
    const auto explain = [&](const Colour& colour, double pen, const std::string& text) {
        LegendEntry entry;
        entry.kind = LegendEntry::Kind::cased_line;
        entry.pen.colour = colour;
        entry.pen.width = pen * u;
        entry.text = text;
        draw_legend_entry(canvas, entry, {x_of_entry, captions_.footer_height() + 1.6 * u}, u);
        x_of_entry += 4.0 * u + text_size(text, {u, Across::left, Upward::middle, 0.0, false, false, {}}).x();
    };
    if (figure_.survey) explain(colours::survey, 0.16, "surveyed outline");
    if (!figure_.barriers.empty()) explain(colours::barrier, kBarrierPen, "barrier");
    const GridGeometry& g = surface_.geometry;
    const double x = 0.5 * g.cell * static_cast<double>(g.nx - 1), y = 0.5 * g.cell * static_cast<double>(g.ny - 1);
    const std::vector<double> sides = figure_.eye ? std::vector<double>{} : std::vector<double>{-1.0, 1.0};
    for (const double side : sides) {  // walls that face the eye; from a place of its own it may not see their feet
        if (side * eye_.y() > y) edge_length(canvas, {-x, side * y, foot_}, {x, side * y, foot_}, 2.0 * x);
        if (side * eye_.x() > x) edge_length(canvas, {side * x, -y, foot_}, {side * x, y, foot_}, 2.0 * y);
    }

    const Vec3 centre = figure_.eye ? target_ : Vec3(0.0, 0.0, foot_);
    const Vec2 north = on_picture(centre + Vec3(0, 0.1 * (x + y), 0)) - on_picture(centre);
    const Vec2 along = north.norm() > 0.0 ? Vec2(north.normalized()) : Vec2(0, 1), across(-along.y(), along.x());
    const Vec2 at(w - 5.0 * u, std::max(middle - 0.5 * tall - 5.0 * u, 3.5 * u));
    const Vec2 tip = at + 1.2 * u * along, foot = at - 0.9 * u * along, notch = at - 0.45 * u * along;
    const Vec2 left = foot + 0.6 * u * across, right = foot - 0.6 * u * across;
    canvas.fill({left, notch, tip}, colours::black);
    canvas.stroke({left, notch, right, tip, left}, {colours::black, 0.08 * u, {}});
    canvas.text("N", tip + 0.7 * u * along, {0.9 * u, Across::centre, Upward::middle, 0.0, true, false, {}});
    draw_captions(canvas, captions_, static_cast<int>(w), static_cast<int>(h));
}

}  // namespace

bool render_perspective(const PerspectiveFigure& figure, const std::filesystem::path& png, std::string& why_not) {
    expect(figure.field.size() == figure.bed.values.size(), "the field of a view has one value per node of the bed");
    why_not = no_renderer_reason();
    if (!why_not.empty()) return false;
    BlockDrawing drawing(figure);
    auto window = Offscreen::open(figure.width, figure.height, why_not);
    if (!window) return false;
    vtkNew<vtkRenderer> paper, block;
    drawing.scene(block);
    window->add(paper, 0);  // a viewport leaves what is outside it black
    block->UseFXAAOn();     // a tenth of what multisampling costs without a graphics card
    window->add(block, 1);
    Pixels picture;
    if (!window->grab(picture, why_not)) return false;
    window.reset();  // others may draw
    Canvas canvas;
    drawing.explanations(canvas);
    canvas.paint(picture);
    write_png(picture, png);
    return true;
}

}  // namespace frana
