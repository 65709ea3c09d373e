#include "vtk_io/figures/map_figure_layout.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace frana {

double text_unit(int width, int height) {
    const double area = static_cast<double>(width) * height / (1400.0 * 1200.0);
    return std::clamp(21.0 * std::sqrt(area), 11.0, 60.0);
}

Pen line_pen(MapLine kind, double unit) {
    Pen pen{colours::black, 0.12 * unit, {0.55 * unit, 0.3 * unit}};
    if (kind == MapLine::section) pen.dash = {0.9 * unit, 0.25 * unit, 0.15 * unit, 0.25 * unit};
    if (kind == MapLine::inflow) pen.dash = {0.22 * unit, 0.18 * unit}, pen.width = 0.2 * unit;
    return pen;
}

const char* line_name(MapLine kind) {
    return kind == MapLine::profile   ? "profile"
           : kind == MapLine::section ? "section"
           : kind == MapLine::inflow  ? "inflow"
                                      : "runout path";
}

Captions make_captions(const std::string& title, const std::string& footer, double unit, double width) {
    Captions captions;
    captions.title_style = {1.25 * unit, Across::left, Upward::top, 0.0, true, false, {}};
    captions.footer_style = {0.85 * unit, Across::left, Upward::bottom, 0.0, false, false, colours::note};
    captions.title = wrapped(title, captions.title_style, width - 1.6 * unit);
    captions.footer = wrapped(footer, captions.footer_style, width - 1.6 * unit);
    return captions;
}

void draw_captions(Canvas& canvas, const Captions& captions, int width, int height) {
    TextStyle title = captions.title_style;
    title.across = Across::centre;
    double y = height - 0.5 * title.size;
    for (const auto& line : captions.title) {
        canvas.text(line, {0.5 * width, y}, title);
        y -= 1.3 * title.size;
    }
    const TextStyle& footer = captions.footer_style;
    y = 0.6 * footer.size + captions.footer_height();
    for (const auto& line : captions.footer) {
        y -= 1.35 * footer.size;
        canvas.text(line, {footer.size, y}, footer);
    }
}

Rows in_rows(const std::vector<double>& widths, double gap, double width) {
    Rows rows;
    double x = 0.0;
    for (const double item : widths) {
        if (x > 0.0 && x + item > width) {
            x = 0.0;
            ++rows.count;
        }
        rows.places.emplace_back(x, rows.count - 1);
        x += item + gap;
    }
    return rows;
}

GridGeometry MapLayout::pixel_grid() const {
    GridGeometry grid;
    grid.nx = std::lround(frame.width());
    grid.ny = std::lround(frame.height());
    grid.cell = metres_per_pixel;
    grid.x0 = x0 + 0.5 * metres_per_pixel;
    grid.y0 = y0 + 0.5 * metres_per_pixel;
    return grid;
}

namespace {

/// One axis of a view: a stretch [low, high] of at least `length`, moved inside [least, most] where it fits.
void stretch(double& low, double& high, double length, double least, double most) {
    const double grow = std::max(length - (high - low), 0.0);
    low -= 0.5 * grow;
    high += 0.5 * grow;
    if (high - low >= most - least) {
        const double middle = 0.5 * (least + most), half = 0.5 * (high - low);
        low = middle - half;
        high = middle + half;
    } else {
        const double shift = std::max(least - low, 0.0) - std::max(high - most, 0.0);
        low += shift;
        high += shift;
    }
}

/// What has to be in view, before the shape of the frame is known.
std::array<double, 4> wanted_view(const MapFigure& figure) {
    const auto all = figure.bed.geometry.pixel_extent();
    if (figure.focus) return *figure.focus;
    auto covered = covered_extent(figure.bed.geometry, figure.outlined(), figure.shown_above);
    if (!covered) return all;
    if (figure.survey && !figure.survey->parts.empty()) covered = united(*covered, extent_of(*figure.survey));
    std::array<double, 4> view = *covered;
    // Two outlines are compared where they are, however little of the terrain that is.
    const double least = figure.shows_overlay() ? 0.0 : 0.3;
    const double margin = 0.1 * std::max(view[2] - view[0], view[3] - view[1]);
    for (std::size_t k = 0; k < 2; ++k) {
        const double whole = all[k + 2] - all[k];
        view[k] = std::max(view[k] - margin, all[k]);
        view[k + 2] = std::min(view[k + 2] + margin, all[k + 2]);
        if (view[k] >= view[k + 2]) view[k] = all[k], view[k + 2] = all[k + 2];
        stretch(view[k], view[k + 2], least * whole, all[k], all[k + 2]);
    }
    return view;
}

/// The view brought to the shape of the room for it, as far as there is terrain. It is never a mere sliver.
std::array<double, 4> shaped(std::array<double, 4> view, const std::array<double, 4>& all, double shape) {
    const double w = view[2] - view[0], h = view[3] - view[1];
    if (w < shape * h)
        stretch(view[0], view[2], std::max(w, std::min(shape * h, all[2] - all[0])), all[0], all[2]);
    else
        stretch(view[1], view[3], std::max(h, std::min(w / shape, all[3] - all[1])), all[1], all[3]);
    const double least = 0.14 * std::max((view[2] - view[0]) / shape, view[3] - view[1]);
    stretch(view[0], view[2], least, all[0], all[2]);
    stretch(view[1], view[3], least, all[1], all[3]);
    return view;
}

double contour_interval(const MapFigure& figure, const std::array<double, 4>& view) {
    double low = 1e300, high = -1e300;
    const GridGeometry& g = figure.bed.geometry;
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) {
            const double z = figure.bed.at(i, j);
            const bool seen = g.x(i) >= view[0] && g.x(i) <= view[2] && g.y(j) >= view[1] && g.y(j) <= view[3];
            if (!seen || std::isnan(z)) continue;
            low = std::min(low, z);
            high = std::max(high, z);
        }
    const double relief = high - low;
    const double flat = 1e-3 * std::max(view[2] - view[0], view[3] - view[1]);
    return relief > flat ? round_up_125(relief / 25.0) : 0.0;
}

LegendEntry entry(LegendEntry::Kind kind, const Colour& colour, double width, const std::string& text) {
    LegendEntry made;
    made.kind = kind;
    made.pen.colour = colour;
    made.pen.width = width;
    made.text = text;
    return made;
}

std::vector<LegendEntry> make_legend(const MapFigure& figure, const MapLayout& layout) {
    using Kind = LegendEntry::Kind;
    const double u = layout.unit;
    std::vector<LegendEntry> legend;
    if (figure.shows_overlay()) {
        legend.push_back(entry(Kind::area, colours::hit, 0.0, "both"));
        legend.push_back(entry(Kind::area, colours::beyond, 0.0, "simulated only"));
        legend.push_back(entry(Kind::area, colours::missed, 0.0, "surveyed only"));
    }
    for (const MapClass& one : figure.classes) legend.push_back(entry(Kind::area, one.colour, 0.0, one.name));
    const auto [name, unit] = name_and_unit(figure.outline_field.empty() ? figure.field_label : figure.outline_label);
    if (figure.classes.empty())
        legend.push_back(entry(Kind::line, colours::black, 0.1 * u,
                               fmt::format("{} {:g}{}{}", name, figure.shown_above, unit.empty() ? "" : " ", unit)));
    if (figure.survey)
        legend.push_back(entry(Kind::cased_line, colours::survey, figure.survey_pen() * u, "surveyed outline"));
    if (!figure.barriers.empty())
        legend.push_back(entry(Kind::cased_line, colours::barrier, kBarrierPen * u, "barrier"));
    for (const MapLine kind : {MapLine::profile, MapLine::section, MapLine::inflow, MapLine::path}) {
        const auto is_one = [&](const NamedLine& line) { return line.kind == kind; };
        if (std::none_of(figure.lines.begin(), figure.lines.end(), is_one)) continue;
        legend.push_back(entry(Kind::cased_line, colours::black, 0.0, line_name(kind)));
        legend.back().pen = line_pen(kind, u);
    }
    if (!figure.gauges.empty()) legend.push_back(entry(Kind::point, colours::black, 1.0, "gauge"));
    if (layout.contour_interval > 0.0)
        legend.push_back(entry(Kind::line, colours::contour, 0.07 * u,
                               fmt::format("contours every {}", length_text(layout.contour_interval))));
    return legend;
}

}  // namespace

std::string beyond_text(const ColourRange& range) {
    if (!range.more_above || !(range.most > range.high)) return "";
    return range.most >= 1000.0 ? fmt::format("to {:.0f}", range.most) : fmt::format("to {:.3g}", range.most);
}

namespace {

double widest(const std::vector<std::string>& labels, const TextStyle& style) {
    double width = 0.0;
    for (const auto& label : labels) width = std::max(width, text_size(label, style).x());
    return width;
}

Ticks colour_ticks(const ColourRange& range) { return ticks_between(range.low, range.high, 9); }

struct Margins {
    double left, right, bottom, top;
};

Margins margins_of(const MapLayout& layout, bool colour_bar) {
    const double u = layout.unit;
    const TextStyle plain = layout.text(Across::left, Upward::bottom);
    const double strip = layout.row_height() * layout.strip.count;
    return {3.4 * u + widest(layout.y_ticks.labels, plain),
            colour_bar ? 4.9 * u + std::max(widest(colour_ticks(layout.colours).labels, plain),
                                            text_size(beyond_text(layout.colours), plain).x() - 2.6 * u)
                       : 2.0 * u,
            4.1 * u + strip + layout.captions.footer_height(), 1.3 * u + layout.captions.title_height()};
}

void set_ticks(MapLayout& layout) {
    const double u = layout.unit, m = layout.metres_per_pixel;
    const double x1 = layout.x0 + layout.frame.width() * m, y1 = layout.y0 + layout.frame.height() * m;
    const int rows = static_cast<int>(layout.frame.height() / (4.0 * u));
    layout.y_ticks = ticks_between(layout.y0, y1, std::clamp(rows, 2, 9));
    for (int most = 9; most >= 2; --most) {
        layout.x_ticks = ticks_between(layout.x0, x1, most);
        const double room = layout.x_ticks.at.size() > 1 ? (layout.x_ticks.at[1] - layout.x_ticks.at[0]) / m : 1e9;
        if (widest(layout.x_ticks.labels, layout.text(Across::centre, Upward::top)) + 1.2 * u < room) break;
    }
}

/// One pass: places the frame in the room that the margins of the pass before leave.
void place(MapLayout& layout, const MapFigure& figure, const std::array<double, 4>& wanted) {
    const auto all = figure.bed.geometry.pixel_extent();
    const double u = layout.unit;
    layout.captions = make_captions(figure.title, figure.footer, u, layout.width);
    const Margins m = margins_of(layout, figure.has_colour_bar());
    const double room_w = std::max(figure.width - m.left - m.right, 8.0 * u);
    const double room_h = std::max(figure.height - m.bottom - m.top, 8.0 * u);
    const auto view = shaped(wanted, all, room_w / room_h);
    layout.metres_per_pixel = std::max((view[2] - view[0]) / room_w, (view[3] - view[1]) / room_h);
    const double frame_w = std::round((view[2] - view[0]) / layout.metres_per_pixel);
    const double frame_h = std::round((view[3] - view[1]) / layout.metres_per_pixel);
    const double least_w = std::max(30.0 * u, 0.5 * figure.width);
    layout.width = figure.width, layout.height = figure.height;
    if (frame_w < 0.9 * room_w)
        layout.width = static_cast<int>(std::max(std::ceil(frame_w + m.left + m.right), least_w));
    if (frame_h < 0.9 * room_h) layout.height = static_cast<int>(std::ceil(frame_h + m.bottom + m.top));
    const double spare_w = std::max(layout.width - m.left - m.right - frame_w, 0.0);
    const double spare_h = std::max(layout.height - m.bottom - m.top - frame_h, 0.0);
    const double left = std::round(m.left + 0.5 * spare_w), bottom = std::round(m.bottom + 0.5 * spare_h);
    layout.frame = {left, bottom, left + frame_w, bottom + frame_h};
    layout.x0 = view[0], layout.y0 = view[1];
    layout.scale_length = round_down_125(std::max(0.25 * frame_w, 5.0 * u) * layout.metres_per_pixel);
    layout.contour_interval = contour_interval(figure, view);
    layout.legend = make_legend(figure, layout);
    layout.strip = figure.explained ? in_rows(strip_widths(layout), 1.4 * u, layout.width - 2.0 * u) : Rows{{}, 0};
    layout.strip_top = bottom - 3.1 * u;
    set_ticks(layout);
}

}  // namespace

std::vector<double> strip_widths(const MapLayout& layout) {
    const double u = layout.unit;
    std::vector<double> widths{layout.scale_length / layout.metres_per_pixel + 6.0 * u};
    for (const auto& entry : layout.legend)
        widths.push_back(2.6 * u + text_size(entry.text, layout.text(Across::left, Upward::middle)).x());
    return widths;
}

MapLayout lay_out(const MapFigure& figure) {
    MapLayout layout;
    layout.width = figure.width;
    layout.height = figure.height;
    layout.unit = text_unit(figure.width, figure.height);
    layout.colours = colours_within(figure.field, figure.outline_field, figure.shown_above, figure.colormap,
                                    figure.range, figure.thick_release ? Top::flow : Top::percentile);
    const auto wanted = wanted_view(figure);
    for (int pass = 0; pass < 4; ++pass) place(layout, figure, wanted);  // margins and labels settle in two
    return layout;
}

}  // namespace frana
