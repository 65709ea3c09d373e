#pragma once
// The font of figures: how large a text is, and drawing it.
#include <cairo.h>

#include <memory>
#include <string>

#include "vtk_io/figures/canvas.h"

namespace frana {

/// A text's extent [px]: up and down from its baseline the same for all texts of a font.
struct TextBox {
    double width = 0.0, ascent = 0.0, descent = 0.0;
    double bearing = 0.0;  ///< from where it is started to its first ink
};

/// DejaVu Sans, which has all the signs of units and comes with nearly every desktop. Elsewhere it is what the system
/// has for "sans-serif". Not turned: the surface is.
class CanvasFont {
public:
    explicit CanvasFont(const TextStyle& style);

    TextBox box(const std::string& text) const;
    /// Draws with the first letter's origin at (x, y) in the surface's own coordinates, y downwards.
    void show(cairo_t* cairo, const std::string& text, double x, double y) const;

    /// The font of figures itself is there, not a stand-in.
    static bool has_all_signs();

private:
    std::unique_ptr<cairo_scaled_font_t, decltype(&cairo_scaled_font_destroy)> font_;
};

}  // namespace frana
