#include "vtk_io/figures/chart_figure.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "base/error.h"
#include "vtk_io/figures/chart_figure_ticks.h"
#include "vtk_io/figures/map_figure_furniture.h"
#include "vtk_io/figures/png_file.h"

namespace frana {
namespace {

using Range = std::pair<double, double>;

/// A stretch of numbers, plain or logarithmic, laid on a stretch of pixels.
struct Axis {
    double low = 0.0, high = 1.0;
    bool log = false;
    bool decades = false;  ///< the ticks are powers of ten
    double factor = 1.0;   ///< numbers are shown divided by this power of ten
    Ticks ticks;

    double share(double value) const {
        if (log) return std::log(value / low) / std::log(high / low);
        return (value - low) / (high - low);
    }
};

/// Range of the values that can be shown; nothing when there are none.
std::optional<Range> range_of(const std::vector<const std::vector<double>*>& columns, bool log) {
    Range range{1e300, -1e300};
    for (const auto* column : columns)
        for (const double value : *column) {
            if (!std::isfinite(value) || (log && value <= 0.0)) continue;
            range = {std::min(range.first, value), std::max(range.second, value)};
        }
    if (range.first > range.second) return std::nullopt;
    return range;
}

/// The range opened to something drawable.
Axis axis_over(std::optional<Range> data, const std::optional<Range>& given, bool log, double margin) {
    Axis axis;
    axis.log = log;
    Range range = given ? *given : data ? *data : (log ? Range{1.0, 10.0} : Range{0.0, 1.0});
    if (log && range.first <= 0.0) range.first = std::min(1e-3 * std::abs(range.second), 1.0);
    if (range.second <= range.first) {
        const double half = 0.1 * std::abs(range.first);
        range = log                  ? Range{range.first / 2.0, range.first * 2.0}
                : range.first == 0.0 ? Range{0.0, 1.0}
                                     : Range{range.first - half, range.first + half};
    }
    if (!given && margin > 0.0) {
        if (log) {
            const double more = std::pow(range.second / range.first, margin);
            range = {range.first / more, range.second * more};
        } else {
            const double more = margin * (range.second - range.first);
            const bool from_zero = range.first >= 0.0 && range.first < 0.35 * range.second;
            const bool to_zero = range.second <= 0.0 && range.second > 0.35 * range.first;
            range = {from_zero ? 0.0 : range.first - more, to_zero ? 0.0 : range.second + more};
        }
    }
    axis.low = range.first;
    axis.high = range.second;
    return axis;
}

void set_ticks(Axis& axis, int most) {
    if (axis.log) {
        axis.ticks = log_ticks(axis.low, axis.high, most);
        axis.decades = axis.ticks.at.size() >= 2;
        if (axis.decades) return;
        axis.ticks = ticks_between(axis.low, axis.high, most);
        return;
    }
    const double largest = std::max(std::abs(axis.low), std::abs(axis.high));
    const double exponent = 3.0 * std::floor(std::log10(largest) / 3.0 + 1e-9);
    if (largest >= 1e5 || largest < 1e-2) axis.factor = std::pow(10.0, exponent);
    axis.ticks = ticks_between(axis.low / axis.factor, axis.high / axis.factor, most);
    for (double& at : axis.ticks.at) at *= axis.factor;
}

/// "energy [J]" with factor 1e6 -> "energy [10⁶ J]".
std::string scaled_label(const std::string& label, double factor) {
    if (factor == 1.0) return label;
    const auto [name, unit] = name_and_unit(label);
    const std::string power = power_of_ten(static_cast<int>(std::lround(std::log10(factor))));
    return fmt::format("{} [{}{}{}]", name, power, unit.empty() || unit == "1" ? "" : " ", unit == "1" ? "" : unit);
}

/// Where a logarithmic axis with decades has its small ticks.
std::vector<double> small_ticks(const Axis& axis) {
    std::vector<double> at;
    if (!axis.decades || axis.high / axis.low > 1e7) return at;
    for (double power = std::pow(10.0, std::floor(std::log10(axis.low))); power < axis.high; power *= 10.0)
        for (int k = 2; k <= 9; ++k)
            if (k * power > axis.low && k * power < axis.high) at.push_back(k * power);
    return at;
}

/// A disc that marks a point.
void draw_mark(Canvas& canvas, const Vec2& at, double unit, const Colour& colour) {
    std::vector<Vec2> disc;
    for (int k = 0; k < 16; ++k) {
        const double turn = 2.0 * constants::kPi * k / 16.0;
        disc.push_back(at + 0.3 * unit * Vec2(std::cos(turn), std::sin(turn)));
    }
    canvas.fill(disc, colour);
}

/// The style of the i-th line.
Pen curve_pen(std::size_t i, double unit) {
    Pen pen;
    pen.colour = curve_colour(i);
    pen.width = 0.13 * unit;
    const std::vector<std::vector<double>> patterns{{},          {0.7, 0.3}, {0.15, 0.22}, {0.8, 0.25, 0.15, 0.25},
                                                    {1.3, 0.35}, {0.35, 0.2}};
    for (const double part : patterns[i % patterns.size()]) pen.dash.push_back(part * unit);
    return pen;
}

class ChartDrawing {
public:
    explicit ChartDrawing(const ChartFigure& figure)
        : figure_(figure),
          unit_(text_unit(figure.width, figure.height)),
          captions_(make_captions(figure.title, figure.footer, unit_, figure.width)) {}

    void draw() {
        set_axes();
        double shares = 0.0;
        for (const auto& panel : figure_.panels) shares += panel.share;
        const double top = figure_.height - captions_.title_height() - 1.0 * unit_;
        const double bottom = captions_.footer_height() + 4.6 * unit_;
        double y = top;
        for (std::size_t i = 0; i < figure_.panels.size(); ++i) {
            const double height = (top - bottom) * figure_.panels[i].share / shares;
            const double legend = draw_legend(figure_.panels[i], y);
            const bool last = i + 1 == figure_.panels.size();
            const Rectangle frame{left_, std::round(y - height + (last ? 0.0 : 0.8 * unit_)),
                                  figure_.width - 1.6 * unit_, std::round(y - legend)};
            draw_panel(figure_.panels[i], y_axes_[i], frame, last);
            y -= height;
        }
        draw_captions(canvas_, captions_, figure_.width, figure_.height);
    }
    const Canvas& canvas() const { return canvas_; }

private:
    void set_axes();
    double draw_legend(const ChartPanel& panel, double top);
    void draw_panel(const ChartPanel& panel, const Axis& y_axis, const Rectangle& frame, bool last);
    void draw_grid(const Axis& y_axis, const Rectangle& frame);
    void draw_labels(const ChartPanel& panel, const Axis& y_axis, const Rectangle& frame, bool last);
    void fill_below(const Curve& curve, const Axis& y_axis, const Rectangle& frame, const Colour& colour);
    std::vector<std::vector<Vec2>> pieces(const Curve& curve, const Axis& y_axis, const Rectangle& frame) const;

    /// Number of a curve among the lines of its panel: the ground has no colour of its own.
    static std::size_t number(const ChartPanel& panel, std::size_t curve) {
        std::size_t n = 0;
        for (std::size_t i = 0; i < curve; ++i) n += panel.curves[i].kind != Curve::Kind::ground;
        return n;
    }
    LegendEntry look(const ChartPanel& panel, std::size_t curve) const {
        LegendEntry entry;
        entry.text = panel.curves[curve].name;
        entry.pen = curve_pen(number(panel, curve), unit_);
        if (panel.curves[curve].kind == Curve::Kind::ground) {
            entry.pen.colour = colours::black;
            entry.pen.width = 0.1 * unit_;
            entry.pen.dash.clear();
        }
        return entry;
    }

    const ChartFigure& figure_;
    double unit_;
    Captions captions_;
    Canvas canvas_;
    Axis x_axis_;
    std::vector<Axis> y_axes_;
    double left_ = 0.0, label_width_ = 0.0;
};

void ChartDrawing::set_axes() {
    std::vector<const std::vector<double>*> all_x;
    for (const auto& panel : figure_.panels) {
        std::vector<const std::vector<double>*> all_y;
        bool ground = false;
        for (const auto& curve : panel.curves) {
            all_x.push_back(&curve.x);
            all_y.push_back(&curve.y);
            ground = ground || curve.kind == Curve::Kind::ground;
        }
        const auto range = range_of(all_y, panel.log_y);
        y_axes_.push_back(axis_over(range, panel.y_range, panel.log_y, 0.06));
        Axis& axis = y_axes_.back();
        if (ground && range && !panel.y_range && axis.low == 0.0)  // elevations do not start at zero
            axis.low = range->first - 0.06 * (range->second - range->first);
        double shares = 0.0;
        for (const auto& other : figure_.panels) shares += other.share;
        const double height = 0.8 * figure_.height * panel.share / shares;
        set_ticks(axis, static_cast<int>(std::clamp(height / (3.2 * unit_), 2.0, 7.0)));
        for (const auto& label : axis.ticks.labels)
            label_width_ = std::max(label_width_, text_size(label, {unit_, {}, {}, 0, false, false, {}}).x());
    }
    bool marks = false;  // a disc needs room beyond its point
    for (const auto& panel : figure_.panels)
        for (const auto& curve : panel.curves) marks = marks || curve.marks;
    x_axis_ = axis_over(range_of(all_x, figure_.log_x), figure_.x_range, figure_.log_x, marks ? 0.04 : 0.0);
    set_ticks(x_axis_, static_cast<int>(std::clamp(figure_.width / (7.0 * unit_), 2.0, 9.0)));
    left_ = std::round(label_width_ + 3.6 * unit_);
}

/// One row or more above the panel; returns the height used.
double ChartDrawing::draw_legend(const ChartPanel& panel, double top) {
    const double row = 1.6 * unit_;
    std::vector<LegendEntry> entries;
    std::vector<double> widths;
    for (std::size_t i = 0; i < panel.curves.size(); ++i) {
        if (panel.curves[i].name.empty()) continue;
        entries.push_back(look(panel, i));
        const TextStyle style{unit_, Across::left, Upward::middle, 0.0, false, false, {}};
        widths.push_back(2.6 * unit_ + text_size(entries.back().text, style).x());
    }
    if (entries.empty()) return 0.5 * unit_;
    std::vector<bool> marked;
    for (const Curve& curve : panel.curves)
        if (!curve.name.empty()) marked.push_back(curve.marks);
    const Rows rows = in_rows(widths, 1.6 * unit_, figure_.width - 1.6 * unit_ - left_);
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const Vec2 at(left_ + rows.places[i].first, top - row * (rows.places[i].second + 0.5));
        draw_legend_entry(canvas_, entries[i], at, unit_);
        if (marked[i]) draw_mark(canvas_, at + Vec2(1.05 * unit_, 0.0), unit_, entries[i].pen.colour);
    }
    return row * rows.count + 0.2 * unit_;
}

void ChartDrawing::draw_grid(const Axis& y_axis, const Rectangle& frame) {
    const Pen pen{colours::grid, std::max(1.0, 0.05 * unit_), {}};
    for (const double at : x_axis_.ticks.at) {
        const double x = frame.x0 + x_axis_.share(at) * frame.width();
        canvas_.stroke({{x, frame.y0}, {x, frame.y1}}, pen);
    }
    for (const double at : y_axis.ticks.at) {
        const double y = frame.y0 + y_axis.share(at) * frame.height();
        canvas_.stroke({{frame.x0, y}, {frame.x1, y}}, pen);
    }
}

void ChartDrawing::draw_labels(const ChartPanel& panel, const Axis& y_axis, const Rectangle& frame, bool last) {
    const Pen pen{colours::black, std::max(1.0, std::round(0.09 * unit_)), {}};
    canvas_.frame(frame, pen);
    TextStyle style{unit_, Across::centre, Upward::top, 0.0, false, false, {}};
    for (std::size_t i = 0; i < x_axis_.ticks.at.size(); ++i) {
        const double x = frame.x0 + x_axis_.share(x_axis_.ticks.at[i]) * frame.width();
        canvas_.stroke({{x, frame.y0}, {x, frame.y0 - 0.4 * unit_}}, pen);
        if (last) canvas_.text(x_axis_.ticks.labels[i], {x, frame.y0 - 0.6 * unit_}, style);
    }
    for (const double at : small_ticks(x_axis_)) {
        const double x = frame.x0 + x_axis_.share(at) * frame.width();
        canvas_.stroke({{x, frame.y0}, {x, frame.y0 - 0.2 * unit_}}, pen);
    }
    for (const double at : small_ticks(y_axis)) {
        const double y = frame.y0 + y_axis.share(at) * frame.height();
        canvas_.stroke({{frame.x0, y}, {frame.x0 - 0.2 * unit_, y}}, pen);
    }
    const double middle = 0.5 * (frame.x0 + frame.x1);
    if (last) canvas_.text(scaled_label(figure_.x_label, x_axis_.factor), {middle, frame.y0 - 2.0 * unit_}, style);
    style.across = Across::right;
    style.upward = Upward::middle;
    for (std::size_t i = 0; i < y_axis.ticks.at.size(); ++i) {
        const double y = frame.y0 + y_axis.share(y_axis.ticks.at[i]) * frame.height();
        canvas_.stroke({{frame.x0, y}, {frame.x0 - 0.4 * unit_, y}}, pen);
        canvas_.text(y_axis.ticks.labels[i], {frame.x0 - 0.6 * unit_, y}, style);
    }
    style = {unit_, Across::centre, Upward::bottom, 90.0, false, false, {}};
    canvas_.text(scaled_label(panel.y_label, y_axis.factor),
                 {frame.x0 - label_width_ - 1.1 * unit_, 0.5 * (frame.y0 + frame.y1)}, style);
}

/// The curve in pixels, broken at what cannot be shown and thinned below a third of a pixel.
std::vector<std::vector<Vec2>> ChartDrawing::pieces(const Curve& curve, const Axis& y_axis,
                                                    const Rectangle& frame) const {
    std::vector<std::vector<Vec2>> result(1);
    const std::size_t count = std::min(curve.x.size(), curve.y.size());
    for (std::size_t i = 0; i < count; ++i) {
        const double x = x_axis_.share(curve.x[i]), y = y_axis.share(curve.y[i]);
        if (!std::isfinite(x) || !std::isfinite(y)) {
            if (!result.back().empty()) result.emplace_back();
            continue;
        }
        const Vec2 p(frame.x0 + x * frame.width(), frame.y0 + y * frame.height());
        if (result.back().empty() || i + 1 == count || (p - result.back().back()).norm() > 0.3)
            result.back().push_back(p);
    }
    return result;
}

void ChartDrawing::fill_below(const Curve& curve, const Axis& y_axis, const Rectangle& frame, const Colour& colour) {
    for (const auto& line : pieces(curve, y_axis, frame))
        for (const auto& part : clipped(line, {frame.x0, -1e6, frame.x1, 1e6}))
            for (std::size_t i = 1; i < part.size(); ++i) {
                Vec2 a = part[i - 1], b = part[i];
                a.y() = std::clamp(a.y(), frame.y0, frame.y1);
                b.y() = std::clamp(b.y(), frame.y0, frame.y1);
                canvas_.fill({{a.x(), frame.y0}, {b.x(), frame.y0}, b, a}, colour);
            }
}

void ChartDrawing::draw_panel(const ChartPanel& panel, const Axis& y_axis, const Rectangle& frame, bool last) {
    draw_grid(y_axis, frame);
    for (std::size_t i = 0; i < panel.curves.size(); ++i)
        if (panel.curves[i].kind == Curve::Kind::water)
            fill_below(panel.curves[i], y_axis, frame, mixed(colours::white, look(panel, i).pen.colour, 0.3));
    for (const auto& curve : panel.curves)
        if (curve.kind == Curve::Kind::ground) fill_below(curve, y_axis, frame, colours::ground);
    for (std::size_t i = 0; i < panel.curves.size(); ++i)
        for (const auto& line : pieces(panel.curves[i], y_axis, frame)) {
            for (const auto& part : clipped(line, frame)) canvas_.stroke(part, look(panel, i).pen);
            if (!panel.curves[i].marks) continue;
            for (const Vec2& at : line)
                if (frame.holds(at)) draw_mark(canvas_, at, unit_, look(panel, i).pen.colour);
        }
    draw_labels(panel, y_axis, frame, last);
}

}  // namespace

bool render_chart(const ChartFigure& figure, const std::filesystem::path& png, std::string& why_not) {
    expect(!figure.panels.empty(), "a chart has at least one panel");
    why_not = no_picture_reason();
    if (!why_not.empty()) return false;
    ChartDrawing drawing(figure);
    drawing.draw();
    Pixels picture(figure.width, figure.height);
    drawing.canvas().paint(picture);
    write_png(picture, png);
    return true;
}

}  // namespace frana
