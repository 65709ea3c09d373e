#pragma once
// A sheet in pixels, origin at the lower left, on which figures are drawn: images, filled shapes and strokes
// in the order of the calls, all texts on top.
#include <memory>
#include <string>
#include <vector>

#include "base/types.h"
#include "vtk_io/figures/colour.h"

class vtkRenderer;

namespace frana {

struct Pen {
    Colour colour;
    double width = 1.0;        ///< [px]
    std::vector<double> dash;  ///< lengths drawn and left out in turn [px]; empty: drawn through
};

enum class Across { left, centre, right };
enum class Upward { bottom, middle, top };

struct TextStyle {
    double size = 20.0;  ///< [px]
    Across across = Across::left;
    Upward upward = Upward::bottom;
    double angle = 0.0;  ///< counter-clockwise [degrees]
    bool bold = false;
    bool boxed = false;  ///< on a translucent white box
    Colour colour{};
};

struct Rectangle {
    double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    double width() const { return x1 - x0; }
    double height() const { return y1 - y0; }
    bool holds(const Vec2& p) const { return p.x() >= x0 && p.x() <= x1 && p.y() >= y0 && p.y() <= y1; }
    bool meets(const Rectangle& o) const { return x0 < o.x1 && o.x0 < x1 && y0 < o.y1 && o.y0 < y1; }
};

/// Width and height [px] of a text as drawn (not turned).
Vec2 text_size(const std::string& text, const TextStyle& style);

/// "10⁶", or "1e6" when the font in use may lack the signs.
std::string power_of_ten(int exponent);

/// Words put on lines no wider than `width` [px]; a word longer than a line stays whole.
std::vector<std::string> wrapped(const std::string& text, const TextStyle& style, double width);

/// The parts of a polyline inside a rectangle.
std::vector<std::vector<Vec2>> clipped(const std::vector<Vec2>& line, const Rectangle& window);

class Canvas {
public:
    Canvas();
    ~Canvas();
    /// The image with its lower left corner at (x, y).
    void image(const Pixels& pixels, int x, int y);
    void fill(const std::vector<Vec2>& convex, const Colour& colour);
    void fill(const Rectangle& rectangle, const Colour& colour);
    /// A single horizontal or vertical piece is moved by at most half a pixel to fill whole pixels; so is
    /// `frame`.
    void stroke(const std::vector<Vec2>& line, const Pen& pen);
    void frame(const Rectangle& rectangle, const Pen& pen);
    void text(const std::string& text, const Vec2& at, const TextStyle& style);
    /// Hands everything drawn so far to the renderer.
    void show(vtkRenderer* renderer) const;

private:
    struct Sheet;
    std::unique_ptr<Sheet> sheet_;
};

}  // namespace frana
