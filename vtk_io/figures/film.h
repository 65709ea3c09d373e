#pragma once
// Pictures through time as a film, where the program ffmpeg is found. Debian's VTK 9.1 has no writer of MP4.
#include <filesystem>
#include <string>

#include "base/types.h"

namespace frana {

/// Why no film can be made here: no program ffmpeg in PATH. Empty when one can.
std::string no_film_reason();

/// Pictures of equal size on their way into a film. They lie in a folder next to it that goes with the reel.
class FilmReel {
public:
    /// `film` ends in .mp4 or .gif, which says what it becomes. UserError when the folder cannot be made.
    explicit FilmReel(std::filesystem::path film);
    ~FilmReel();
    FilmReel(const FilmReel&) = delete;
    FilmReel& operator=(const FilmReel&) = delete;

    /// Where the next picture (PNG) belongs.
    std::filesystem::path next();
    /// Makes the film, whole or not at all: MP4 as every player reads it, GIF at most 800 pixels wide. False with
    /// ffmpeg's own words when it fails; UserError when the film cannot be put in its place.
    bool join(double pictures_per_second, std::string& why_not) const;

private:
    std::filesystem::path film_, folder_;
    Index pictures_ = 0;
};

}  // namespace frana
