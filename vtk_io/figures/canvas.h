#pragma once
// A sheet in pixels, origin at the lower left, on which figures are drawn. They are images, filled shapes and strokes
// in the order of the calls, and all texts on top.
#include <string>
#include <variant>
#include <vector>

#include "base/types.h"
#include "vtk_io/figures/pixels.h"

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

/// Stores what is drawn until it is painted. Painting is cairo's, without a renderer; canvases of several threads paint at
/// the same time.
class Canvas {
public:
    /// The image with its lower left corner at (x, y).
    void image(Pixels pixels, int x, int y);
    /// Neighbours of one colour leave no seam between them, if they are filled one after the other.
    void fill(const std::vector<Vec2>& convex, const Colour& colour);
    /// Fills the pixels whose centres it holds.
    void fill(const Rectangle& rectangle, const Colour& colour);
    /// A single horizontal or vertical piece is moved by at most half a pixel to fill whole pixels. So is `frame`.
    void stroke(const std::vector<Vec2>& line, const Pen& pen);
    void frame(const Rectangle& rectangle, const Pen& pen);
    void text(const std::string& text, const Vec2& at, const TextStyle& style);

    /// Everything drawn so far onto the picture.
    void paint(Pixels& picture) const;

private:
    struct Image {
        Pixels pixels;
        int x, y;
    };
    struct Fill {
        std::vector<std::vector<Vec2>> polygons;
        Colour colour;
    };
    struct Box {
        Rectangle rectangle;
        Colour colour;
    };
    struct Stroke {
        std::vector<Vec2> line;
        Pen pen;
    };
    struct Text {
        std::string text;
        Vec2 at;
        TextStyle style;
    };
    class Painter;
    std::vector<std::variant<Image, Fill, Box, Stroke>> shapes_;
    std::vector<Text> texts_;
};

/// Why no picture is drawn in this process; empty when they are: FRANA_NO_RENDER=1 in the environment switches them off.
std::string no_picture_reason();

}  // namespace frana
