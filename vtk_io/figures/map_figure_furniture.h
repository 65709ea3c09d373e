#pragma once
// The parts of a picture that explain it: colour bar, legend, scale bar, north arrow.
#include "vtk_io/figures/map_figure_layout.h"

namespace frana {

/// A vertical colour bar in `bar` [px] with its ticks and label to the right; pointed where values lie
/// beyond.
void draw_colour_bar(Canvas& canvas, const Rectangle& bar, const ColourRange& range, Colormap map,
                     const std::string& label, double unit);
/// One legend entry, its left end at (x, y), y in the middle [px].
void draw_legend_entry(Canvas& canvas, const LegendEntry& entry, const Vec2& at, double unit);
/// Two-tone bar of the given length with a north arrow before it.
void draw_scale(Canvas& canvas, double metres, double pixels, const Vec2& at, double unit);
/// The strip under a map: scale bar and legend, in the layout's rows.
void draw_strip(Canvas& canvas, const MapLayout& layout);
/// A line on a wider white one, to be seen on any ground.
void stroke_cased(Canvas& canvas, const std::vector<Vec2>& line, const Pen& pen);
/// Gauge symbol: a white triangle with a black edge.
void draw_gauge(Canvas& canvas, const Vec2& at, double unit);

}  // namespace frana
