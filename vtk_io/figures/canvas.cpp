#include "vtk_io/figures/canvas.h"

#include <cairo.h>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <utility>

#include "base/constants.h"
#include "base/error.h"
#include "vtk_io/figures/canvas_font.h"

namespace frana {
namespace {

bool same(const Colour& a, const Colour& b) { return a.r == b.r && a.g == b.g && a.b == b.b && a.a == b.a; }

std::vector<Vec2> without_repeats(const std::vector<Vec2>& line) {
    std::vector<Vec2> result;
    for (const Vec2& point : line)
        if (result.empty() || (point - result.back()).norm() > 1e-6) result.push_back(point);
    return result;
}

/// Where a horizontal or vertical stroke has to lie to fill whole pixels.
double snapped(double at, double width) {
    const bool odd = std::lround(width) % 2 == 1;
    return odd ? std::floor(at) + 0.5 : std::round(at);
}

/// Share of the segment a-b inside the window (Liang & Barsky 1984); false when none.
bool inside_part(const Vec2& a, const Vec2& b, const Rectangle& window, double& from, double& to) {
    from = 0.0;
    to = 1.0;
    const Vec2 d = b - a;
    const std::array<double, 4> p{-d.x(), d.x(), -d.y(), d.y()};
    const std::array<double, 4> q{a.x() - window.x0, window.x1 - a.x(), a.y() - window.y0, window.y1 - a.y()};
    for (std::size_t k = 0; k < 4; ++k) {
        if (p[k] == 0.0 && q[k] < 0.0) return false;
        if (p[k] < 0.0) from = std::max(from, q[k] / p[k]);
        if (p[k] > 0.0) to = std::min(to, q[k] / p[k]);
    }
    return from < to;
}

}  // namespace

std::vector<std::string> wrapped(const std::string& text, const TextStyle& style, double width) {
    std::vector<std::string> lines;
    std::size_t at = 0;
    while (at < text.size()) {
        const std::size_t end = std::min(text.find_first_of(" \n", at), text.size());
        const std::string word = text.substr(at, end - at);
        const bool fits =
            !lines.empty() && text[at - 1] != '\n' && text_size(lines.back() + " " + word, style).x() <= width;
        if (fits)
            lines.back() += " " + word;
        else
            lines.push_back(word);
        at = end + 1;
    }
    return lines;
}

std::vector<std::vector<Vec2>> clipped(const std::vector<Vec2>& line, const Rectangle& window) {
    std::vector<std::vector<Vec2>> pieces;
    bool open = false;
    for (std::size_t i = 1; i < line.size(); ++i) {
        double from = 0.0, to = 1.0;
        if (!inside_part(line[i - 1], line[i], window, from, to)) {
            open = false;
            continue;
        }
        const Vec2 d = line[i] - line[i - 1];
        if (!open || from > 0.0) pieces.push_back({line[i - 1] + from * d});
        pieces.back().push_back(line[i - 1] + to * d);
        open = to >= 1.0;
    }
    return pieces;
}

std::string no_picture_reason() {
    const char* off = std::getenv("FRANA_NO_RENDER");
    return off && *off && std::string(off) != "0" ? "FRANA_NO_RENDER is set" : "";
}

void Canvas::image(Pixels pixels, int x, int y) { shapes_.emplace_back(Image{std::move(pixels), x, y}); }

void Canvas::fill(const std::vector<Vec2>& convex, const Colour& colour) {
    Fill* last = shapes_.empty() ? nullptr : std::get_if<Fill>(&shapes_.back());
    if (last == nullptr || !same(last->colour, colour)) {
        shapes_.emplace_back(Fill{{}, colour});
        last = std::get_if<Fill>(&shapes_.back());
    }
    last->polygons.push_back(convex);
}

void Canvas::fill(const Rectangle& rectangle, const Colour& colour) { shapes_.emplace_back(Box{rectangle, colour}); }

void Canvas::stroke(const std::vector<Vec2>& line, const Pen& pen) {
    std::vector<Vec2> points = without_repeats(line);
    if (points.size() < 2) return;
    Pen drawn = pen;
    const Vec2 along = (points[1] - points[0]).cwiseAbs();
    if (points.size() == 2 && along.minCoeff() == 0.0 && pen.dash.empty()) {
        drawn.width = std::max(1.0, std::round(pen.width));
        const int across = along.x() == 0.0 ? 0 : 1;
        points[0][across] = points[1][across] = snapped(points[0][across], drawn.width);
    }
    shapes_.emplace_back(Stroke{std::move(points), std::move(drawn)});
}

void Canvas::frame(const Rectangle& r, const Pen& pen) {
    Pen whole = pen;
    whole.width = std::max(1.0, std::round(pen.width));
    const double x0 = snapped(r.x0, whole.width), x1 = snapped(r.x1, whole.width);
    const double y0 = snapped(r.y0, whole.width), y1 = snapped(r.y1, whole.width);
    stroke({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}, {x0, y0}}, whole);
}

void Canvas::text(const std::string& text, const Vec2& at, const TextStyle& style) {
    if (!text.empty()) texts_.push_back({text, {std::round(at.x()), std::round(at.y())}, style});
}

/// Puts shapes and texts on a cairo surface, whose origin is at the upper left.
class Canvas::Painter {
public:
    explicit Painter(const Pixels& picture)
        : width_(picture.width),
          height_(picture.height),
          surface_(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width_, height_), &cairo_surface_destroy),
          cairo_(cairo_create(surface_.get()), &cairo_destroy) {
        expect(cairo_status(cairo_.get()) == CAIRO_STATUS_SUCCESS, "a picture of a size that cairo can draw");
        (*this)(Image{picture, 0, 0});
        cairo_set_line_join(cairo_.get(), CAIRO_LINE_JOIN_MITER);
        cairo_set_miter_limit(cairo_.get(), 2.0);
    }

    void operator()(const Image& image) {
        cairo_surface_flush(surface_.get());
        const Pixels& from = image.pixels;
        const int first = std::max(0, -image.x), last = std::min(from.width, width_ - image.x);
        for (int row = std::max(0, -image.y); row < std::min(from.height, height_ - image.y); ++row) {
            unsigned char* const onto = row_of(row + image.y);
            for (int column = first; column < last; ++column) {
                const Colour c = from.at(column, row);
                const std::uint32_t packed = std::uint32_t{c.r} << 16 | std::uint32_t{c.g} << 8 | std::uint32_t{c.b};
                std::memcpy(onto + kBytes * (column + image.x), &packed, sizeof packed);
            }
        }
        cairo_surface_mark_dirty(surface_.get());
    }

    void operator()(const Fill& fill) {
        source(fill.colour);
        for (const std::vector<Vec2>& polygon : fill.polygons) path(polygon, true);
        cairo_fill(cairo_.get());
    }

    void operator()(const Box& box) {
        const Rectangle& r = box.rectangle;
        source(box.colour);
        path({{r.x0, r.y0}, {r.x1, r.y0}, {r.x1, r.y1}, {r.x0, r.y1}}, true);
        cairo_set_antialias(cairo_.get(), CAIRO_ANTIALIAS_NONE);
        cairo_fill(cairo_.get());
        cairo_set_antialias(cairo_.get(), CAIRO_ANTIALIAS_DEFAULT);
    }

    void operator()(const Stroke& stroke) {
        source(stroke.pen.colour);
        const bool closed = stroke.line.size() > 3 && (stroke.line.front() - stroke.line.back()).norm() < 1e-9;
        path(stroke.line, closed);
        cairo_set_line_width(cairo_.get(), stroke.pen.width);
        const std::vector<double>& dash = stroke.pen.dash;
        cairo_set_dash(cairo_.get(), dash.data(), static_cast<int>(dash.size()), 0.0);
        cairo_stroke(cairo_.get());
    }

    void write(const Text& text) {
        const CanvasFont font(text.style);
        const TextBox box = font.box(text.text);
        const double shift_x[] = {0.0, -0.5 * box.width, -box.width};
        const double shift_y[] = {box.descent, 0.5 * (box.descent - box.ascent), -box.ascent};  // of the baseline
        cairo_t* cairo = cairo_.get();
        cairo_save(cairo);
        cairo_translate(cairo, text.at.x(), height_ - text.at.y());
        cairo_rotate(cairo, -text.style.angle * constants::kPi / 180.0);
        double x = shift_x[static_cast<int>(text.style.across)], y = -shift_y[static_cast<int>(text.style.upward)];
        if (text.style.angle == 0.0) x = std::round(x), y = std::round(y);
        if (text.style.boxed) {
            cairo_set_source_rgba(cairo, 1.0, 1.0, 1.0, 0.8);
            cairo_rectangle(cairo, x - 1.0, y - box.ascent - 1.0, box.width + 2.0, box.ascent + box.descent + 2.0);
            cairo_fill(cairo);
        }
        source(text.style.colour);
        font.show(cairo, text.text, x - box.bearing, y);
        cairo_restore(cairo);
    }

    /// After an error cairo draws nothing more.
    void check() const {
        const cairo_status_t status = cairo_status(cairo_.get());
        if (status != CAIRO_STATUS_SUCCESS)
            throw UserError(fmt::format("the picture cannot be painted: {}", cairo_status_to_string(status)));
    }

    void take(Pixels& picture) {
        cairo_surface_flush(surface_.get());
        for (int row = 0; row < height_; ++row) {
            const unsigned char* const from = row_of(row);
            for (int column = 0; column < width_; ++column) {
                std::uint32_t packed = 0;
                std::memcpy(&packed, from + kBytes * column, sizeof packed);
                picture.set(column, row,
                            {static_cast<std::uint8_t>(packed >> 16), static_cast<std::uint8_t>(packed >> 8),
                             static_cast<std::uint8_t>(packed)});
            }
        }
    }

private:
    static constexpr std::ptrdiff_t kBytes = 4;  // of a pixel of the surface

    /// The surface's pixels of a row; row 0 is the lowest one.
    unsigned char* row_of(int y) {
        unsigned char* const bytes = cairo_image_surface_get_data(surface_.get());
        return bytes + (height_ - 1 - y) * std::ptrdiff_t{cairo_image_surface_get_stride(surface_.get())};
    }
    void source(const Colour& c) {
        cairo_set_source_rgba(cairo_.get(), c.r / 255.0, c.g / 255.0, c.b / 255.0, c.a / 255.0);
    }
    void path(const std::vector<Vec2>& line, bool closed) {
        for (std::size_t i = 0; i < line.size(); ++i) {
            const double x = line[i].x(), y = height_ - line[i].y();
            i == 0 ? cairo_move_to(cairo_.get(), x, y) : cairo_line_to(cairo_.get(), x, y);
        }
        if (closed) cairo_close_path(cairo_.get());
    }

    int width_, height_;
    std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> surface_;
    std::unique_ptr<cairo_t, decltype(&cairo_destroy)> cairo_;
};

void Canvas::paint(Pixels& picture) const {
    Painter painter(picture);
    for (const auto& shape : shapes_) std::visit(painter, shape);
    for (const Text& text : texts_) painter.write(text);
    painter.check();
    painter.take(picture);
}

}  // namespace frana
