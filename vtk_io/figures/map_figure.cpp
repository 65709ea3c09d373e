#include "vtk_io/figures/map_figure.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "vtk_io/figures/map_figure_furniture.h"
#include "vtk_io/figures/map_figure_overlay.h"
#include "vtk_io/figures/map_figure_paint.h"
#include "vtk_io/figures/map_figure_picture.h"
#include "vtk_io/figures/png_file.h"
#include "vtk_io/hillshade.h"
#include "vtk_io/level_lines.h"

namespace frana {
namespace {

/// A raster of the picture's pixels, or of every n-th.
GridGeometry coarser(const GridGeometry& pixels, Index n) {
    GridGeometry grid = pixels;
    grid.cell = pixels.cell * static_cast<double>(n);
    grid.nx = (pixels.nx + n - 1) / n + 1;
    grid.ny = (pixels.ny + n - 1) / n + 1;
    grid.x0 = pixels.x0 - 0.5 * pixels.cell;
    grid.y0 = pixels.y0 - 0.5 * pixels.cell;
    return grid;
}

class MapDrawing {
public:
    MapDrawing(const MapFigure& figure, const MapLayout& layout) : figure_(figure), layout_(layout) {}

    void draw() {
        ground();
        contours();
        outline();
        overlays();
        axes();
        explanations();
    }
    Canvas& canvas() { return canvas_; }

private:
    void ground() {
        const GridGeometry pixels = layout_.pixel_grid();
        const Raster field{figure_.bed.geometry, figure_.field, "", ""};
        field_ = resampled(field, pixels, Between::linear);
        double shown_above = figure_.shown_above;
        if (!figure_.outline_field.empty()) {
            const Raster outlined{figure_.bed.geometry, figure_.outline_field, "", ""};
            field_.values =
                inside_outline(field_.values, resampled(outlined, pixels, Between::linear).values, shown_above);
            shown_above = kAll;
        }
        const Raster bed = resampled(figure_.bed, pixels, Between::smooth);
        const Pixels picture =
            figure_.shows_overlay()    ? painted_overlay(bed, *figure_.simulated, all_rings(*figure_.survey))
            : !figure_.classes.empty() ? painted_classes(bed, field, figure_.classes)
                                       : painted(bed, field_, {figure_.colormap, layout_.colours, shown_above, 0.0});
        canvas_.image(picture, static_cast<int>(layout_.frame.x0), static_cast<int>(layout_.frame.y0));
    }

    std::vector<std::vector<Vec2>> on_sheet(const Polyline& line) const {
        std::vector<Vec2> pixels;
        for (const Vec2& point : line) pixels.push_back(layout_.pixel(point));
        return clipped(pixels, layout_.frame);
    }

    void contours() {
        const double interval = layout_.contour_interval;
        if (interval <= 0.0) return;
        const Raster bed = resampled(figure_.bed, coarser(layout_.pixel_grid(), 2), Between::smooth);
        double low = 1e300, high = -1e300;
        for (const double z : bed.values) {
            if (std::isnan(z)) continue;
            low = std::min(low, z);
            high = std::max(high, z);
        }
        constexpr double off_plateaus = 1e-4;  // a flat exactly at a level would give a tangle at round-off
        for (double n = std::ceil(low / interval); n * interval <= high; ++n) {
            const bool index = std::fmod(std::abs(n), 5.0) == 0.0;
            for (const Polyline& line : level_lines(bed, (n + off_plateaus) * interval))
                for (const auto& piece : on_sheet(line)) contour(piece, index, with_step(n * interval, interval));
        }
    }

    void contour(const std::vector<Vec2>& line, bool index, const std::string& label) {
        Pen pen{colours::contour, (index ? 0.085 : 0.05) * layout_.unit, {}};
        pen.colour.a = index ? 200 : 120;
        if (!index) return canvas_.stroke(line, pen);
        TextStyle style{0.75 * layout_.unit, Across::centre, Upward::middle, 0.0, false, false, colours::contour};
        const double width = text_size(label, style).x() + 0.6 * layout_.unit;
        const LabelledLine parts = with_label(line, width, [&](const Vec2& p) { return free_for_label(p, width); });
        for (const auto& piece : parts.pieces) canvas_.stroke(piece, pen);
        if (!parts.labelled) return;
        style.angle = parts.angle;
        style.colour = scaled(colours::contour, 0.6);
        canvas_.text(label, parts.at, style);
        labels_.push_back(around(parts.at, width));
    }

    static Rectangle around(const Vec2& p, double width) {
        return {p.x() - 0.6 * width, p.y() - 0.6 * width, p.x() + 0.6 * width, p.y() + 0.6 * width};
    }

    bool free_for_label(const Vec2& p, double width) const {
        const Rectangle box = around(p, width), f = layout_.frame;
        if (box.x0 < f.x0 || box.y0 < f.y0 || box.x1 > f.x1 || box.y1 > f.y1) return false;
        for (const Rectangle& other : labels_)
            if (box.meets(other)) return false;
        for (const double dx : {0.0, -0.5 * width, 0.5 * width}) {
            const auto i = static_cast<Index>(p.x() - f.x0 + dx), j = static_cast<Index>(p.y() - f.y0);
            if (std::abs(field_.at(std::min(i, field_.geometry.nx - 1), std::min(j, field_.geometry.ny - 1))) >
                figure_.shown_above)
                return false;
        }
        return true;
    }

    void closed_line(Polyline ring, const Pen& pen, bool cased) {
        if (ring.empty()) return;
        ring.push_back(ring.front());
        for (const auto& piece : on_sheet(ring)) cased ? stroke_cased(canvas_, piece, pen) : canvas_.stroke(piece, pen);
    }

    void outline() {
        if (figure_.shows_overlay()) {
            for (const Polyline& ring : *figure_.simulated)
                closed_line(ring, {colours::black, 0.1 * layout_.unit, {}}, false);
            return;
        }
        if (!figure_.classes.empty()) return;  // whose colours end where their pixels do
        Raster field{figure_.bed.geometry, figure_.outlined(), "", ""};
        for (double& value : field.values) value = std::isnan(value) ? 0.0 : std::abs(value);
        const Raster seen = resampled(field, coarser(layout_.pixel_grid(), 1), Between::linear);
        for (const Polyline& line : level_lines(seen, figure_.shown_above))
            for (const auto& piece : on_sheet(line)) canvas_.stroke(piece, {colours::black, 0.1 * layout_.unit, {}});
    }

    void overlays() {
        const double u = layout_.unit;
        if (figure_.survey)
            for (const Polyline& ring : all_rings(*figure_.survey))
                closed_line(ring, {colours::survey, figure_.survey_pen() * u, {}}, true);
        barriers();
        for (const NamedPoint& gauge : figure_.gauges) {
            const Vec2 at = layout_.pixel(gauge.point);
            if (!layout_.frame.holds(at)) continue;
            draw_gauge(canvas_, at, u);
            name(gauge.name, {at.x(), at.y() + 0.3 * u});
        }
        for (const NamedLine& line : figure_.lines) {
            lines_.push_back(on_sheet(line.line));
            for (const auto& piece : lines_.back()) stroke_cased(canvas_, piece, line_pen(line.kind, u));
        }
        for (std::size_t k = 0; k < lines_.size(); ++k)
            if (!lines_[k].empty()) name_line(k);
    }

    /// The place that a share of the line's longest piece is from its start.
    static Vec2 along(const std::vector<std::vector<Vec2>>& pieces, double share) {
        const auto shorter = [](const auto& a, const auto& b) { return length_of(a) < length_of(b); };
        const std::vector<Vec2>& line = *std::max_element(pieces.begin(), pieces.end(), shorter);
        double left = share * length_of(line);
        for (std::size_t k = 0; k + 1 < line.size(); ++k) {
            const Vec2 way = line[k + 1] - line[k];
            if (left < way.norm()) return line[k] + left / way.norm() * way;
            left -= way.norm();
        }
        return line.back();
    }

    static double length_of(const std::vector<Vec2>& line) {
        double length = 0.0;
        for (std::size_t k = 0; k + 1 < line.size(); ++k) length += (line[k + 1] - line[k]).norm();
        return length;
    }

    /// A name that stands closer to a line could be taken for its own.
    Rectangle wider(const Rectangle& box) const {
        const double margin = layout_.unit;
        return {box.x0 - margin, box.y0 - margin, box.x1 + margin, box.y1 + margin};
    }

    bool on_line(const Rectangle& box, std::size_t k) const {
        return std::any_of(lines_[k].begin(), lines_[k].end(),
                           [&](const std::vector<Vec2>& piece) { return !clipped(piece, box).empty(); });
    }

    /// At the line's middle, else at an end or between, close to it and off all other lines. Off the line itself as
    /// well where there is room. Where all is taken it stands by the middle, as near as it can.
    void name_line(std::size_t k) {
        const std::string& text = figure_.lines[k].name;
        constexpr int kClose = 4;  // steps up and down
        for (const bool off_itself : {true, false})
            for (const double share : {0.5, 0.0, 1.0, 0.25, 0.75}) {
                const auto taken = [&](const Rectangle& box) {
                    for (std::size_t other = 0; other < lines_.size(); ++other)
                        if (other == k ? off_itself && on_line(box, k) : on_line(wider(box), other)) return true;
                    return false;
                };
                if (const auto place = free_next_to(text, along(lines_[k], share), kClose, taken))
                    return write(text, *place);
            }
        name(text, along(lines_[k], 0.5));
    }

    /// "houses_7" -> "7": the number of one of several barriers; empty where it is none of them.
    static std::string number_in(const std::string& name) {
        const std::size_t last = name.find_last_not_of("0123456789");
        return last == std::string::npos || name[last] != '_' ? "" : name.substr(last + 1);
    }

    void barriers() {
        std::vector<Named> parts;
        for (const NamedLine& barrier : figure_.barriers) {
            const auto pieces = on_sheet(barrier.line);
            if (pieces.empty()) continue;
            for (const auto& piece : pieces)
                stroke_cased(canvas_, piece, {colours::barrier, kBarrierPen * layout_.unit, {}});
            const Rectangle box = box_of(pieces);
            if (std::max(box.width(), box.height()) < kSmall * layout_.unit) houses_.push_back(box);
            parts.push_back({barrier.name, box});
        }
        const auto again = [](const Named& a, const Named& b) { return a.name == b.name; };  // a hole, or another part
        std::vector<Named> named = parts;
        named.erase(std::unique(named.begin(), named.end(), again), named.end());
        if (named.size() >= kBarriersNumbered) return;
        for (const Named& one : named) {
            const std::string shown = named.size() <= kBarriersNamed ? one.name : number_in(one.name);
            if (shown.empty()) continue;
            if (const auto place = nearest_to_it(shown, one, parts))
                write(shown, *place);
            else
                name(shown, {one.box.x1, 0.5 * (one.box.y0 + one.box.y1)});
        }
    }

    /// What is named, or a part of it, and the box around that [px].
    struct Named {
        std::string name;
        Rectangle box;
    };

    static double distance(const Rectangle& a, const Rectangle& b) {
        return std::hypot(std::max({0.0, a.x0 - b.x1, b.x0 - a.x1}), std::max({0.0, a.y0 - b.y1, b.y0 - a.y1}));
    }

    /// A free box for a barrier's name that is nearer to it than to any other: to its right or left, or above or below.
    std::optional<Rectangle> nearest_to_it(const std::string& text, const Named& one,
                                           const std::vector<Named>& all) const {
        const double u = layout_.unit, half = 0.5 * text_size(text, name_style()).x();
        const Rectangle& box = one.box;
        const double x = 0.5 * (box.x0 + box.x1), y = 0.5 * (box.y0 + box.y1);
        const Rectangle around[] = {next_to(text, {box.x1, y}, true, y), next_to(text, {box.x0, y}, false, y),
                                    Rectangle{x - half, box.y1 + 0.4 * u, x + half, box.y1 + 1.6 * u},
                                    Rectangle{x - half, box.y0 - 1.6 * u, x + half, box.y0 - 0.4 * u}};
        const auto is_its_own = [&](const Rectangle& place) {
            return std::none_of(all.begin(), all.end(), [&](const Named& other) {
                return other.name != one.name && distance(place, other.box) < distance(place, box) + 0.3 * u;
            });
        };
        for (const Rectangle& place : around)
            if (fits(place) && is_its_own(place)) return place;
        return {};
    }

    static Rectangle box_of(const std::vector<std::vector<Vec2>>& pieces) {
        Vec2 low = pieces.front().front(), high = low;
        for (const auto& piece : pieces)
            for (const Vec2& p : piece) low = low.cwiseMin(p), high = high.cwiseMax(p);
        return {low.x(), low.y(), high.x(), high.y()};
    }

    TextStyle name_style() const { return {0.9 * layout_.unit, Across::left, Upward::middle, 0.0, false, true, {}}; }

    /// A name's box beside a point, on its right or left, its middle at a height [px].
    Rectangle next_to(const std::string& text, const Vec2& at, bool right, double y) const {
        const double u = layout_.unit, width = text_size(text, name_style()).x();
        const double x = at.x() + (right ? 0.9 * u : -0.9 * u - width);
        return Rectangle{x, y - 0.6 * u, x + width, y + 0.6 * u};
    }

    bool fits(const Rectangle& r) const {
        const double u = layout_.unit;
        const Rectangle& f = layout_.frame;
        const auto meets = [&](const Rectangle& other) { return r.meets(other); };
        return r.x0 > f.x0 && r.x1 < f.x1 - 0.3 * u && r.y0 >= f.y0 && r.y1 <= f.y1 &&
               std::none_of(names_.begin(), names_.end(), meets) && std::none_of(houses_.begin(), houses_.end(), meets);
    }

    /// A height of the frame that a name there is within [px].
    double level_of(const Vec2& at) const {
        return std::clamp(at.y(), layout_.frame.y0 + layout_.unit, layout_.frame.y1 - layout_.unit);
    }

    /// The nearest free box beside a point, at most so many steps up or down, that is not `taken`.
    template <class Taken>
    std::optional<Rectangle> free_next_to(const std::string& text, const Vec2& at, int farthest,
                                          const Taken& taken) const {
        const double u = layout_.unit, level = level_of(at);
        for (int n = 0; n <= farthest; ++n)
            for (const double y : {level + 0.31 * u * n, level - 0.31 * u * n})
                for (const bool right : {true, false})
                    if (const Rectangle box = next_to(text, at, right, y); fits(box) && !taken(box)) return box;
        return {};
    }

    void write(const std::string& text, const Rectangle& place) {
        names_.push_back(place);
        canvas_.text(text, {place.x0, 0.5 * (place.y0 + place.y1)}, name_style());
    }

    /// A name next to a point: to its right, or where that is taken, as near as there is room.
    void name(const std::string& text, const Vec2& at) {
        constexpr int kFarthest = 30;  // steps up and down
        const double u = layout_.unit, width = text_size(text, name_style()).x();
        const auto free = free_next_to(text, at, kFarthest, [](const Rectangle&) { return false; });
        write(text, free ? *free : next_to(text, at, at.x() + 1.2 * u + width < layout_.frame.x1, level_of(at)));
    }

    void axes() {
        const double u = layout_.unit;
        const Rectangle& f = layout_.frame;
        const Pen pen{colours::black, std::max(1.0, std::round(0.09 * u)), {}};
        canvas_.frame(f, pen);
        TextStyle style = layout_.text(Across::centre, Upward::top);
        for (std::size_t i = 0; i < layout_.x_ticks.at.size(); ++i) {
            const double x = layout_.pixel({layout_.x_ticks.at[i], 0.0}).x();
            canvas_.stroke({{x, f.y0}, {x, f.y0 - 0.4 * u}}, pen);
            canvas_.text(layout_.x_ticks.labels[i], {x, f.y0 - 0.6 * u}, style);
        }
        style = layout_.text(Across::right, Upward::middle);
        double widest = 0.0;
        for (std::size_t i = 0; i < layout_.y_ticks.at.size(); ++i) {
            const double y = layout_.pixel({0.0, layout_.y_ticks.at[i]}).y();
            canvas_.stroke({{f.x0, y}, {f.x0 - 0.4 * u, y}}, pen);
            canvas_.text(layout_.y_ticks.labels[i], {f.x0 - 0.6 * u, y}, style);
            widest = std::max(widest, text_size(layout_.y_ticks.labels[i], style).x());
        }
        const bool projected = !figure_.bed.crs_wkt.empty();
        style = layout_.text(Across::centre, Upward::top);
        canvas_.text(projected ? "easting [m]" : "x [m]", {0.5 * (f.x0 + f.x1), f.y0 - 1.8 * u}, style);
        style.upward = Upward::bottom;
        style.angle = 90.0;
        canvas_.text(projected ? "northing [m]" : "y [m]", {f.x0 - 1.0 * u - widest, 0.5 * (f.y0 + f.y1)}, style);
    }

    void explanations() {
        const double u = layout_.unit;
        const Rectangle& f = layout_.frame;
        if (figure_.has_colour_bar())
            draw_colour_bar(canvas_, {std::round(f.x1 + u), f.y0, std::round(f.x1 + 2.1 * u), f.y1}, layout_.colours,
                            figure_.colormap, figure_.field_label, u);
        draw_strip(canvas_, layout_);
        draw_captions(canvas_, layout_.captions, layout_.width, layout_.height);
    }

    const MapFigure& figure_;
    const MapLayout& layout_;
    Canvas canvas_;
    Raster field_;                         ///< at the pixels of the frame
    std::vector<Rectangle> labels_;        ///< of contours
    static constexpr double kSmall = 3.0;  ///< a barrier that names stay off [units]: a name would hide it
    std::vector<Rectangle> names_;         ///< of barriers, profiles and gauges
    std::vector<Rectangle> houses_;        ///< small barriers
    std::vector<std::vector<std::vector<Vec2>>> lines_;  ///< pieces of each of the figure's lines [px]
    /// Houses of a village would hide what comes to them under names. Of more than so many only the numbers are told.
    static constexpr std::size_t kBarriersNamed = 6;
    static constexpr std::size_t kBarriersNumbered = 30;  ///< from so many on nothing is
};

}  // namespace

Pixels map_picture(const MapFigure& figure) {
    expect(figure.field.size() == figure.bed.values.size(), "the field of a map has one value per node of the bed");
    const MapLayout layout = lay_out(figure);
    MapDrawing drawing(figure, layout);
    drawing.draw();
    Pixels picture(layout.width, layout.height);
    drawing.canvas().paint(picture);
    return picture;
}

bool render_map(const MapFigure& figure, const std::filesystem::path& png, std::string& why_not) {
    why_not = no_picture_reason();
    if (!why_not.empty()) return false;
    write_png(map_picture(figure), png);
    return true;
}

}  // namespace frana
