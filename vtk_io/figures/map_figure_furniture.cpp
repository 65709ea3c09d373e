#include "vtk_io/figures/map_figure_furniture.h"

#include <algorithm>
#include <cmath>

namespace frana {

void draw_colour_bar(Canvas& canvas, const Rectangle& bar, const ColourRange& range, Colormap map,
                     const std::string& label, double unit) {
    const double tip = 0.8 * bar.width();
    Rectangle body = bar;
    if (range.more_above) body.y1 -= tip;
    if (range.more_below) body.y0 += tip;
    const int w = static_cast<int>(std::lround(body.width())), h = static_cast<int>(std::lround(body.height()));
    Pixels pixels(w, h);
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) pixels.set(x, y, colour_at(map, (y + 0.5) / h));
    canvas.image(pixels, static_cast<int>(std::lround(body.x0)), static_cast<int>(std::lround(body.y0)));
    const double middle = 0.5 * (bar.x0 + bar.x1);
    if (range.more_above) canvas.fill({{body.x0, body.y1}, {body.x1, body.y1}, {middle, bar.y1}}, colour_at(map, 1.0));
    if (range.more_below) canvas.fill({{body.x0, body.y0}, {body.x1, body.y0}, {middle, bar.y0}}, colour_at(map, 0.0));
    std::vector<Vec2> edge{{body.x0, body.y0}};
    if (range.more_below) edge.emplace_back(middle, bar.y0);
    edge.emplace_back(body.x1, body.y0);
    edge.emplace_back(body.x1, body.y1);
    if (range.more_above) edge.emplace_back(middle, bar.y1);
    edge.emplace_back(body.x0, body.y1);
    edge.push_back(edge.front());
    canvas.stroke(edge, {colours::black, 0.08 * unit, {}});

    TextStyle style{unit, Across::left, Upward::middle, 0.0, false, false, {}};
    const int most = static_cast<int>(std::clamp(body.height() / (2.2 * unit), 2.0, 9.0));
    const Ticks ticks = ticks_between(range.low, range.high, most);
    double widest = 0.0;
    for (std::size_t i = 0; i < ticks.at.size(); ++i) {
        const double y = body.y0 + (ticks.at[i] - range.low) / (range.high - range.low) * body.height();
        canvas.stroke({{bar.x1, y}, {bar.x1 + 0.35 * unit, y}}, {colours::black, 0.08 * unit, {}});
        canvas.text(ticks.labels[i], {bar.x1 + 0.6 * unit, y}, style);
        widest = std::max(widest, text_size(ticks.labels[i], style).x());
    }
    style.upward = Upward::bottom;
    style.size = 0.85 * unit;
    canvas.text(beyond_text(range), {bar.x0, bar.y1 + 0.1 * unit}, style);
    style.across = Across::centre;
    style.upward = Upward::top;
    style.angle = 90.0;
    style.size = 1.05 * unit;
    canvas.text(label, {bar.x1 + 1.3 * unit + widest, 0.5 * (bar.y0 + bar.y1)}, style);
}

void stroke_cased(Canvas& canvas, const std::vector<Vec2>& line, const Pen& pen) {
    canvas.stroke(line, {colours::white, 2.2 * pen.width, {}});
    canvas.stroke(line, pen);
}

void draw_gauge(Canvas& canvas, const Vec2& at, double unit) {
    const double r = 0.55 * unit;
    const std::vector<Vec2> corners{{at.x() - r, at.y() + r}, {at.x() + r, at.y() + r}, {at.x(), at.y() - 0.1 * r}};
    canvas.fill(corners, colours::white);
    canvas.stroke({corners[0], corners[1], corners[2], corners[0]}, {colours::black, 0.12 * unit, {}});
}

void draw_legend_entry(Canvas& canvas, const LegendEntry& entry, const Vec2& at, double unit) {
    const double sample = 2.1 * unit;
    const std::vector<Vec2> line{at, {at.x() + sample, at.y()}};
    if (entry.kind == LegendEntry::Kind::line) canvas.stroke(line, entry.pen);
    if (entry.kind == LegendEntry::Kind::cased_line) stroke_cased(canvas, line, entry.pen);
    if (entry.kind == LegendEntry::Kind::area) {
        const Rectangle swatch{at.x(), at.y() - 0.5 * unit, at.x() + sample, at.y() + 0.5 * unit};
        canvas.fill(swatch, entry.pen.colour);
        canvas.frame(swatch, {colours::black, 0.08 * unit, {}});
    }
    if (entry.kind == LegendEntry::Kind::point) draw_gauge(canvas, {at.x() + 0.5 * sample, at.y() - 0.25 * unit}, unit);
    canvas.text(entry.text, {at.x() + 2.6 * unit, at.y()}, {unit, Across::left, Upward::middle, 0.0, false, false, {}});
}

void draw_strip(Canvas& canvas, const MapLayout& layout) {
    const double u = layout.unit;
    for (std::size_t i = 0; i < layout.strip.places.size(); ++i) {
        const auto [x, row] = layout.strip.places[i];
        const Vec2 at(u + x, layout.strip_top - (row + 0.5) * layout.row_height());
        if (i == 0)
            draw_scale(canvas, layout.scale_length, layout.scale_length / layout.metres_per_pixel, at, u);
        else
            draw_legend_entry(canvas, layout.legend[i - 1], {at.x(), at.y() - 0.5 * u}, u);
    }
}

void draw_scale(Canvas& canvas, double metres, double pixels, const Vec2& at, double unit) {
    const double tall = 1.7 * unit, wide = 0.55 * unit;
    const Vec2 tip(at.x() + wide, at.y() + 0.25 * tall), foot(tip.x(), at.y() - 0.5 * tall);
    const Vec2 notch(tip.x(), foot.y() + 0.25 * tall);
    canvas.fill({{tip.x() - wide, foot.y()}, notch, tip}, colours::black);
    canvas.stroke({{tip.x() - wide, foot.y()}, notch, {tip.x() + wide, foot.y()}, tip, {tip.x() - wide, foot.y()}},
                  {colours::black, 0.08 * unit, {}});
    TextStyle style{0.9 * unit, Across::centre, Upward::bottom, 0.0, true, false, {}};
    canvas.text("N", {tip.x(), tip.y() + 0.1 * unit}, style);

    const double x0 = at.x() + 3.0 * unit, thick = 0.4 * unit, y0 = at.y() - 0.75 * unit;
    for (int part = 0; part < 4; ++part)
        canvas.fill(Rectangle{x0 + 0.25 * part * pixels, y0, x0 + 0.25 * (part + 1) * pixels, y0 + thick},
                    part % 2 == 0 ? colours::black : colours::white);
    canvas.frame({x0, y0, x0 + pixels, y0 + thick}, {colours::black, 0.08 * unit, {}});
    style.bold = false;
    const double text_y = y0 + thick + 0.2 * unit;
    canvas.text("0", {x0, text_y}, style);
    if (pixels > 9.0 * unit) {
        std::string half = length_text(0.5 * metres);
        half = metres >= 1000.0 ? with_step(0.5e-3 * metres, 0.5e-3 * round_down_125(metres)) : half;
        canvas.text(half.substr(0, half.find(' ')), {x0 + 0.5 * pixels, text_y}, style);
    }
    canvas.text(length_text(metres), {x0 + pixels, text_y}, style);
}

}  // namespace frana
