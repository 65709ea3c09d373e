#pragma once
// Colours of pictures and styles: perceptual maps for fields, colour-blind safe colours for curves.
#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace frana {

/// One sRGB colour; a = 255 is opaque.
struct Colour {
    std::uint8_t r = 0, g = 0, b = 0, a = 255;
};

/// How a value becomes a colour.
enum class Colormap {
    depth,      ///< viridis (van der Walt & Smith 2015) reversed: small is light, large is dark, also in grey
    speed,      ///< plasma (van der Walt & Smith 2015): slow is dark blue, fast is yellow
    pressure,   ///< Greens (Brewer 2003): nearly white without any, dark green where it is large
    diverging,  ///< cool to warm (Moreland 2009): blue below, grey at the middle, red above; for signed
                ///< fields
};

/// Colour at t in [0, 1] (clamped; NaN counts as 0).
Colour colour_at(Colormap map, double t);

/// The nearest whole number to one that is not negative. It is computed for each pixel, and lround() takes longer.
inline std::size_t nearest_whole(double value) {
    const double above = value + 0.5;
    return static_cast<std::size_t>(above);
}

/// The nearest of a channel's values.
inline std::uint8_t channel_of(double value) {
    return static_cast<std::uint8_t>(nearest_whole(std::clamp(value, 0.0, 255.0)));
}

/// (1 - share) a + share b, channel by channel; alpha of `a`.
inline Colour mixed(const Colour& a, const Colour& b, double share) {
    const double rest = 1.0 - share;
    return {channel_of(rest * a.r + share * b.r), channel_of(rest * a.g + share * b.g),
            channel_of(rest * a.b + share * b.b), a.a};
}

/// Each channel times `factor`, clamped.
inline Colour scaled(const Colour& colour, double factor) {
    return {channel_of(factor * colour.r), channel_of(factor * colour.g), channel_of(factor * colour.b), colour.a};
}

/// Perceived brightness of a colour in [0, 1] (Rec. 709 weights on the sRGB values).
double brightness(const Colour& colour);

/// Colour of the i-th curve, distinguishable for the colour-blind (Okabe & Ito 2008); repeats after six.
Colour curve_colour(std::size_t i);

namespace colours {
inline constexpr Colour black{0, 0, 0};
inline constexpr Colour white{255, 255, 255};
inline constexpr Colour no_data{226, 226, 226};   ///< map where there is no terrain
inline constexpr Colour contour{92, 74, 58};      ///< elevation contours
inline constexpr Colour survey{230, 0, 60};       ///< surveyed outline; drawn on a white casing
inline constexpr Colour hit{0, 158, 115};         ///< simulated and surveyed; with the next two told apart by the
                                                  ///< colour-blind (Okabe & Ito 2008) and in grey
inline constexpr Colour beyond{240, 180, 40};     ///< simulated only
inline constexpr Colour missed{0, 62, 130};       ///< surveyed only
inline constexpr Colour grid{218, 218, 218};      ///< grid lines of charts
inline constexpr Colour note{70, 70, 70};         ///< footers
inline constexpr Colour barrier{98, 28, 122};     ///< on maps; drawn on a white casing
inline constexpr Colour unloaded{238, 238, 232};  ///< barrier in a run without loads
inline constexpr Colour ground{205, 195, 182};    ///< filled terrain in charts
}  // namespace colours

}  // namespace frana
