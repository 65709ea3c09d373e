// The vertical section of a moment in 3D.
#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "vtk_io/figures/colours_3d.h"
#include "vtk_io/figures/figure_3d.h"
#include "vtk_io/figures/map_figure_furniture.h"
#include "vtk_io/figures/mesh_3d.h"
#include "vtk_io/figures/png_file.h"

namespace frana {
namespace {

/// The plane, and what of the map it shows.
struct Plane {
    Vec2 from{0, 0}, along{1, 0};  ///< where it enters the view; unit vector
    double length = 0.0;           ///< within the view [m]
    double distance(const Vec2& p) const { return along.dot(p - from); }
    double off_plane(const Vec2& p) const { return along.x() * (p - from).y() - along.y() * (p - from).x(); }
    Vec2 at(double s) const { return from + s * along; }
};

/// The part of the line through `view.through` along the flow inside the box that is seen and the terrain.
Plane plane_of(const Figure3d& figure) {
    const GridGeometry& g = figure.bed.geometry;
    const auto& box = figure.view.box;
    const Rectangle window{std::max(box[0], g.x0), std::max(box[1], g.y0), std::min(box[2], g.x_max()),
                           std::min(box[3], g.y_max())};
    const Vec2 reach = 2.0 * (std::abs(window.width()) + std::abs(window.height())) * figure.view.flow;
    const auto parts = clipped({figure.view.through - reach, figure.view.through + reach}, window);
    if (parts.empty()) return {};
    return {parts[0].front(), figure.view.flow, (parts[0].back() - parts[0].front()).norm()};
}

class SectionDrawing {
public:
    explicit SectionDrawing(const Figure3d& figure)
        : figure_(figure),
          colours_(figure.view),
          plane_(plane_of(figure)),
          unit_(text_unit(figure.width, std::min(figure.height, figure.width * 3 / 4))),
          captions_(make_captions(figure.title, figure.footer, unit_, figure.width)) {
        if (plane_.length <= 0.0) return;
        choose_material();
        for (const BarrierSolid& barrier : figure_.moment.barriers)
            if (barrier.mesh) mesh_cuts_.push_back(cut_of(barrier, plane_.from, plane_.along));
        lay_out();
    }
    bool nothing_to_show() const { return plane_.length <= 0.0 || near_.empty(); }
    int height() const { return height_; }

    void draw(Canvas& canvas) const {
        canvas.fill(frame_, colours::white);
        grid(canvas);
        barriers(canvas);
        meshes(canvas);
        ground(canvas);
        material(canvas);
        mask_and_axes(canvas);
        bars(canvas);
        draw_captions(canvas, captions_, figure_.width, height_);
    }

private:
    using Piece = Moment3d::Piece;

    /// Farthest from the plane first, so that the nearest lie on top.
    void choose_material() {
        for (const Piece& piece : figure_.moment.material) {
            const Vec2 p = piece.place.head<2>();
            const double reach = piece.is_particle ? 0.5 * piece.size : 2.0 * figure_.moment.typical_size;
            const double s = plane_.distance(p);
            if (std::abs(plane_.off_plane(p)) <= reach && s >= 0.0 && s <= plane_.length) near_.push_back(&piece);
        }
        std::stable_sort(near_.begin(), near_.end(), [&](const Piece* a, const Piece* b) {
            return std::abs(plane_.off_plane(a->place.head<2>())) > std::abs(plane_.off_plane(b->place.head<2>()));
        });
    }

    void lay_out() {
        low_ = 1e300, high_ = -1e300;
        const auto hold = [&](double z) {
            if (std::isfinite(z)) low_ = std::min(low_, z), high_ = std::max(high_, z);
        };
        for (double s = 0.0; s <= plane_.length; s += plane_.length / 400.0)
            hold(elevation_at(figure_.bed, plane_.at(s)));
        for (const Piece* piece : near_) hold(piece->place.z() + 0.6 * piece->size);
        for (const BarrierSolid& barrier : figure_.moment.barriers)
            for (const Stretch& part : cut(barrier)) hold(part.top);
        for (const MeshCut& mesh : mesh_cuts_) hold(top_of(mesh));  // its foot may be deep in the ground
        const double rim = 0.03 * plane_.length;
        low_ -= rim, high_ += rim;
        const double left = 6.0 * unit_, right = 9.0 * unit_, foot = captions_.footer_height() + 4.6 * unit_,
                     head = captions_.title_height() + 1.2 * unit_;
        const double wide = figure_.width - left - right, most = figure_.height - foot - head;
        scale_ = std::min(wide / plane_.length, most / (high_ - low_));
        const double tall = std::max(scale_ * (high_ - low_), std::min(most, 14.0 * unit_));
        high_ = low_ + tall / scale_;
        const double x0 = left + 0.5 * (wide - scale_ * plane_.length);
        frame_ = {std::round(x0), std::round(foot), std::round(x0 + scale_ * plane_.length), std::round(foot + tall)};
        height_ = static_cast<int>(std::lround(frame_.y1 + head));
    }

    Vec2 pixel(double s, double z) const { return {frame_.x0 + scale_ * s, frame_.y0 + scale_ * (z - low_)}; }

    /// Where the plane is in a barrier.
    struct Stretch {
        double from, to, top;  ///< [m]; the elevation of the top is that of the middle
        bool first, last;      ///< of a piece of the barrier
    };
    std::vector<Stretch> cut(const BarrierSolid& barrier) const {
        std::vector<double> crossings;
        for (const Polyline& ring : barrier.rings)
            for (std::size_t k = 0; k < ring.size(); ++k) {
                const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
                const double u = plane_.off_plane(a), v = plane_.off_plane(b);
                if ((u > 0.0) != (v > 0.0)) crossings.push_back(plane_.distance(a + (b - a) * (u / (u - v))));
            }
        std::sort(crossings.begin(), crossings.end());
        std::vector<Stretch> parts;
        constexpr int kParts = 24;  // for a top that follows the ground
        for (std::size_t k = 0; k + 1 < crossings.size(); k += 2)
            for (int n = 0; n < kParts; ++n) {
                const double step = (crossings[k + 1] - crossings[k]) / kParts, from = crossings[k] + n * step;
                parts.push_back(
                    {from, from + step, top_of(barrier, plane_.at(from + 0.5 * step)), n == 0, n == kParts - 1});
            }
        return parts;
    }
    /// Elevation of the top there: of the nearest corner of the top's pieces.
    static double top_of(const BarrierSolid& barrier, const Vec2& p) {
        double nearest = 1e300, top = -1e300, highest = -1e300;
        for (const auto& piece : barrier.pieces)
            for (const Vec3& corner : piece.corners) {
                const double far = (corner.head<2>() - p).norm();
                highest = std::max(highest, corner.z());
                if (piece.normal.z() > 0.5 && far < nearest) nearest = far, top = corner.z();
            }
        return nearest < 1e300 ? top : highest;  // a top too narrow to have pieces
    }

    /// In view; minus infinity where nothing of it is [m].
    double top_of(const MeshCut& mesh) const {
        double top = -INFINITY;
        for (const auto& outline : mesh.outlines)
            for (const Vec2& p : outline)
                if (p.x() >= 0.0 && p.x() <= plane_.length) top = std::max(top, p.y());
        return top;
    }

    void grid(Canvas& canvas) const {
        for (const double s : ticks(true).at)
            canvas.stroke({pixel(s, low_), pixel(s, high_)}, {colours::grid, 1.0, {}});
        for (const double z : ticks(false).at)
            canvas.stroke({pixel(0.0, z), pixel(plane_.length, z)}, {colours::grid, 1.0, {}});
    }
    Ticks ticks(bool across) const {
        const double room = across ? frame_.width() / (5.0 * unit_) : frame_.height() / (2.5 * unit_);
        const int most = static_cast<int>(std::clamp(room, 2.0, 12.0));
        return across ? ticks_between(0.0, plane_.length, most) : ticks_between(low_, high_, most);
    }

    /// Filled and outlined; on the sides that the plane meets a strip in the colour of the pressure there.
    void barriers(Canvas& canvas) const {
        const double strip = 0.5 * unit_;
        for (const BarrierSolid& barrier : figure_.moment.barriers) {
            for (const Stretch& part : cut(barrier)) {
                const Vec2 a = pixel(part.from, low_), b = pixel(part.to, part.top);
                canvas.fill(Rectangle{a.x(), a.y(), b.x(), b.y()}, colours::unloaded);
            }
            for (const auto& piece : barrier.pieces) {
                if (piece.normal.z() > 0.5 || piece.pressure <= 0.0) continue;
                const Vec3 &a = piece.corners[0], &b = piece.corners[1], &top = piece.corners[2];
                const double u = plane_.off_plane(a.head<2>()), v = plane_.off_plane(b.head<2>());
                if ((u > 0.0) == (v > 0.0)) continue;
                const double s = plane_.distance(a.head<2>() + (b - a).head<2>() * (u / (u - v)));
                const double inward = plane_.along.dot(piece.normal.head<2>()) > 0.0 ? -strip : strip;
                const Vec2 p = pixel(s, a.z()), q = pixel(s, top.z());
                canvas.fill(Rectangle{std::min(p.x(), p.x() + inward), p.y(), std::max(p.x(), p.x() + inward), q.y()},
                            colours_.of_pressure(piece.pressure));
            }
            for (const Stretch& part : cut(barrier)) {
                const Vec2 a = pixel(part.from, low_), b = pixel(part.to, part.top);
                std::vector<Vec2> edge{{a.x(), b.y()}, b};
                if (part.first) edge.insert(edge.begin(), a);
                if (part.last) edge.push_back({b.x(), a.y()});
                canvas.stroke(edge, {colours::black, 0.1 * unit_, {}});
            }
        }
    }

    /// The same of barriers that are meshes.
    void meshes(Canvas& canvas) const {
        const auto pixels = [&](std::vector<Vec2> places) {
            for (Vec2& p : places) p = pixel(p.x(), p.y());
            return places;
        };
        for (const MeshCut& mesh : mesh_cuts_) {
            for (const auto& area : mesh.areas) canvas.fill(pixels(area), colours::unloaded);
            for (const MeshCut::Strip& strip : mesh.strips) {
                const Vec2 wide = 0.5 * unit_ / scale_ * strip.inward;
                canvas.fill(pixels({strip.from, strip.to, strip.to + wide, strip.from + wide}),
                            colours_.of_pressure(strip.pressure));
            }
            for (const auto& outline : mesh.outlines) canvas.stroke(pixels(outline), {colours::black, 0.1 * unit_, {}});
        }
    }

    void ground(Canvas& canvas) const {
        std::vector<Vec2> line;
        const double step = std::max(2.0 / scale_, plane_.length / 2000.0);
        const auto n = static_cast<int>(std::ceil(plane_.length / step));
        for (int k = 0; k <= n; ++k) {
            const double s = plane_.length * k / n, z = elevation_at(figure_.bed, plane_.at(s));
            if (std::isfinite(z)) line.push_back(pixel(s, z));
        }
        for (std::size_t k = 1; k < line.size(); ++k)
            canvas.fill({{line[k - 1].x(), frame_.y0}, {line[k].x(), frame_.y0}, line[k], line[k - 1]},
                        colours::ground);
        canvas.stroke(line, {colours::black, 0.1 * unit_, {}});
    }

    void material(Canvas& canvas) const {
        constexpr int kCorners = 8;
        for (const Piece* piece : near_) {
            const double s = plane_.distance(piece->place.head<2>());
            const Colour colour = colours_.of_speed(piece->speed);
            if (piece->is_particle) {
                const Vec2 a = pixel(s - 0.5 * piece->size, piece->ground),
                           b = pixel(s + 0.5 * piece->size, piece->place.z());
                canvas.fill(Rectangle{a.x(), a.y(), b.x(), b.y()}, colour);
                continue;
            }
            const Vec2 centre = pixel(s, piece->place.z());
            const double radius = std::max(0.5 * piece->size * scale_, 0.8);
            std::vector<Vec2> disc;
            for (int k = 0; k < kCorners; ++k) {
                const double turn = 2.0 * constants::kPi * (k + 0.5) / kCorners;
                disc.emplace_back(centre + radius * Vec2(std::cos(turn), std::sin(turn)));
            }
            canvas.fill(disc, colour);
        }
    }

    /// What reached over the frame goes, and the axes come.
    void mask_and_axes(Canvas& canvas) const {
        const double w = figure_.width, h = height_, u = unit_;
        for (const Rectangle& beyond : {Rectangle{0, 0, frame_.x0, h}, Rectangle{frame_.x1, 0, w, h},
                                        Rectangle{0, 0, w, frame_.y0}, Rectangle{0, frame_.y1, w, h}})
            canvas.fill(beyond, colours::white);
        canvas.frame(frame_, {colours::black, 0.1 * u, {}});
        const Ticks across = ticks(true), upward = ticks(false);
        double widest = 0.0;
        for (std::size_t k = 0; k < across.at.size(); ++k) {
            const double x = pixel(across.at[k], low_).x();
            canvas.stroke({{x, frame_.y0 - 0.4 * u}, {x, frame_.y0}}, {colours::black, 0.08 * u, {}});
            canvas.text(across.labels[k], {x, frame_.y0 - 0.6 * u},
                        {u, Across::centre, Upward::top, 0.0, false, false, {}});
        }
        for (std::size_t k = 0; k < upward.at.size(); ++k) {
            const double y = pixel(0.0, upward.at[k]).y();
            const TextStyle style{u, Across::right, Upward::middle, 0.0, false, false, {}};
            canvas.stroke({{frame_.x0 - 0.4 * u, y}, {frame_.x0, y}}, {colours::black, 0.08 * u, {}});
            canvas.text(upward.labels[k], {frame_.x0 - 0.6 * u, y}, style);
            widest = std::max(widest, text_size(upward.labels[k], style).x());
        }
        canvas.text("distance along the flow [m]", {0.5 * (frame_.x0 + frame_.x1), frame_.y0 - 2.2 * u},
                    {1.05 * u, Across::centre, Upward::top, 0.0, false, false, {}});
        canvas.text("elevation [m]", {frame_.x0 - 1.2 * u - widest, 0.5 * (frame_.y0 + frame_.y1)},
                    {1.05 * u, Across::centre, Upward::bottom, 90.0, false, false, {}});
    }

    void bars(Canvas& canvas) const {
        const std::vector<ColourBar> bars = colours_.bars();
        const double gap = 1.5 * unit_, x = std::round(frame_.x1 + 1.8 * unit_);
        const double each = std::min((frame_.height() + gap) / static_cast<double>(bars.size()) - gap, 16.0 * unit_);
        for (std::size_t n = 0; n < bars.size(); ++n) {
            const double top = frame_.y1 - static_cast<double>(n) * (each + gap);
            draw_colour_bar(canvas, {x, std::round(top - each), x + std::round(1.1 * unit_), std::round(top)},
                            bars[n].range, bars[n].colormap, bars[n].label, unit_);
        }
    }

    const Figure3d& figure_;
    Colours3d colours_;
    Plane plane_;
    double unit_;
    Captions captions_;
    std::vector<const Piece*> near_;
    std::vector<MeshCut> mesh_cuts_;               ///< of the barriers that are meshes
    double low_ = 0.0, high_ = 1.0, scale_ = 1.0;  ///< elevations in view [m]; [px/m]
    Rectangle frame_;
    int height_ = 1;
};

}  // namespace

bool render_section(const Figure3d& figure, const std::filesystem::path& png, std::string& why_not) {
    why_not = no_picture_reason();
    if (!why_not.empty()) return false;
    const SectionDrawing drawing(figure);
    if (drawing.nothing_to_show()) return why_not = "no point is near the section", false;
    Canvas canvas;
    drawing.draw(canvas);
    Pixels picture(figure.width, drawing.height());
    canvas.paint(picture);
    write_png(picture, png);
    return true;
}

}  // namespace frana
