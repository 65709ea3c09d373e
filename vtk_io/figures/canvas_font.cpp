#include "vtk_io/figures/canvas_font.h"

#include <cairo-ft.h>
#include <ft2build.h>
#include FT_FREETYPE_H

#include <array>
#include <cmath>
#include <filesystem>

namespace frana {
namespace {

/// The font's file; empty when it is not there.
std::string font_file(bool bold) {
    const std::string name = bold ? "DejaVuSans-Bold.ttf" : "DejaVuSans.ttf";
    for (const char* folder : {"/usr/share/fonts/truetype/dejavu/", "/usr/share/fonts/dejavu-sans-fonts/",
                               "/usr/share/fonts/TTF/", "/usr/share/fonts/dejavu/"}) {
        std::error_code ignored;
        if (std::filesystem::exists(folder + name, ignored)) return folder + name;
    }
    return "";
}

/// Regular and bold, opened once and held as long as the process: fonts made of them may live as long.
struct Faces {
    std::array<cairo_font_face_t*, 2> faces{};
    bool own = true;

    Faces() {
        FT_Library library = nullptr;
        const bool usable = FT_Init_FreeType(&library) == 0;
        for (const bool bold : {false, true}) {
            FT_Face face = nullptr;
            const std::string file = font_file(bold);
            const bool opened = usable && !file.empty() && FT_New_Face(library, file.c_str(), 0, &face) == 0;
            faces[bold] = opened ? cairo_ft_font_face_create_for_ft_face(face, FT_LOAD_DEFAULT)
                                 : cairo_toy_font_face_create("sans-serif", CAIRO_FONT_SLANT_NORMAL,
                                                              bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
            own = own && opened;
        }
    }
};

const Faces& faces() {
    static const Faces* const all = new Faces;
    return *all;
}

cairo_scaled_font_t* scaled_font(const TextStyle& style) {
    cairo_matrix_t size, upright;
    const double pixels = std::round(style.size);
    cairo_matrix_init_scale(&size, pixels, pixels);
    cairo_matrix_init_identity(&upright);
    const std::unique_ptr<cairo_font_options_t, decltype(&cairo_font_options_destroy)> options(
        cairo_font_options_create(), &cairo_font_options_destroy);
    cairo_font_options_set_antialias(options.get(), CAIRO_ANTIALIAS_GRAY);
    cairo_font_options_set_hint_style(options.get(), CAIRO_HINT_STYLE_SLIGHT);
    cairo_font_options_set_hint_metrics(options.get(), CAIRO_HINT_METRICS_OFF);
    return cairo_scaled_font_create(faces().faces[style.bold ? 1 : 0], &size, &upright, options.get());
}

}  // namespace

CanvasFont::CanvasFont(const TextStyle& style) : font_(scaled_font(style), &cairo_scaled_font_destroy) {}

TextBox CanvasFont::box(const std::string& text) const {
    cairo_text_extents_t drawn{}, tallest{};
    cairo_scaled_font_text_extents(font_.get(), text.c_str(), &drawn);
    cairo_scaled_font_text_extents(font_.get(), "_/7Agfy", &tallest);
    return {drawn.width, -tallest.y_bearing, tallest.height + tallest.y_bearing, drawn.x_bearing};
}

void CanvasFont::show(cairo_t* cairo, const std::string& text, double x, double y) const {
    cairo_matrix_t size;
    cairo_font_options_t* options = cairo_font_options_create();
    cairo_scaled_font_get_font_matrix(font_.get(), &size);
    cairo_scaled_font_get_font_options(font_.get(), options);
    cairo_set_font_face(cairo, cairo_scaled_font_get_font_face(font_.get()));
    cairo_set_font_matrix(cairo, &size);
    cairo_set_font_options(cairo, options);
    cairo_font_options_destroy(options);
    cairo_move_to(cairo, x, y);
    cairo_show_text(cairo, text.c_str());
    cairo_new_path(cairo);
}

bool CanvasFont::has_all_signs() { return faces().own; }

Vec2 text_size(const std::string& text, const TextStyle& style) {
    if (text.empty()) return {0.0, style.size};
    const TextBox box = CanvasFont(style).box(text);
    return {std::ceil(box.width), std::ceil(box.ascent + box.descent)};
}

std::string power_of_ten(int exponent) {
    static const std::array<const char*, 10> digits{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    const std::string plain = std::to_string(exponent);
    if (!CanvasFont::has_all_signs()) return "1e" + plain;
    std::string text = "10";
    for (const char c : plain) text += c == '-' ? "⁻" : digits[static_cast<std::size_t>(c - '0')];
    return text;
}

}  // namespace frana
