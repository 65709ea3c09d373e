#pragma once
// Pictures of the depth through time, from the frames of a run.
#include <functional>
#include <string>
#include <vector>

#include "run/folder/run_figures.h"

namespace frana {

struct LoadedFrame;

/// Whether material may become bed in the run: then maps and films of the depth show that too.
bool shows_bed(const FigureSource& source);

/// Adds what has become bed to a frame's depth, where it has any: films would show it vanish.
void add_deposit(LoadedFrame& frame);

/// figures/filmstrip_depth.png, the depth at up to six output times side by side. Nothing for a run without frames on
/// the grid.
void add_filmstrip(const FigureSource& source, Gallery& gallery);

/// figures/film_depth.mp4 or .gif (`kind`: "mp4" or "gif"): the depth at every output time. View and range of colours
/// are the same throughout. It takes about eight seconds, with 2 to 25 pictures a second. One warning and no film
/// without the program ffmpeg, frames on the grid, or where pictures are switched off.
void add_film(const FigureSource& source, const std::string& kind, Gallery& gallery);

/// A film of `count` pictures, the k-th drawn by `draw(k, png)`, about eight seconds long. False with a reason when one
/// cannot be drawn or there is no program ffmpeg.
bool make_film(const std::filesystem::path& film, Index count, std::string& why_not,
               const std::function<bool(Index k, const std::filesystem::path& png)>& draw);

/// Digits behind the point that times need, at most three; one for the last, which may be any.
int decimals_of(const std::vector<double>& times);

}  // namespace frana
