// Made-up ground with the figures of Fois et al. (2024), section 4.3. The elevation model of the paper is not
// public. Friction at the bed is 34 degrees, the slope only 28: a slab would stand. What moves is the front. So the bed
// is 31.5 degrees steep under it (25 under the rest, 28 in the mean). The mass is deepest near it.
#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "terrain_scenes.h"

namespace frana {
namespace {

constexpr double kWidth = 1500.0, kHeight = 1350.0, kCell = 2.0;  // [m]; the slope falls to the south
constexpr double kMiddle = 675.0;                                 // x of the mass's axis: the paper's profile line [m]
constexpr double kToe = 520.0;                                    // y of the mass's lower end [m]
constexpr double kLength = 400.0;                                 // of the mass along the slope, on the map [m]
constexpr double kVolume = 1.2e6;                                 // [m^3]
constexpr double kDepth = 38.0;                                   // [m]
constexpr double kShape = 1.7;                                    // depth = kDepth (1 - r^kShape)
constexpr double kDeepest = 0.15;                                 // where it is deepest, in lengths from the toe
constexpr double kFloor = 480.0;                                  // elevation of the valley floor [m]
constexpr double kFloorEdge = 440.0;                              // y where the slope meets the floor, +- 40 m
constexpr double kRiver = 365.0;                                  // y of the river's axis at kMiddle [m]

/// Slope along the fall line [1].
double slope_at(double y) {
    const double s = (y - kToe) / kLength;
    const double front = std::tan(31.5 * constants::kDegree), back = std::tan(25.0 * constants::kDegree);
    const double slope = front + (back - front) * smooth_step((s - 0.2) / 0.4) - 0.25 * smooth_step((s - 1.4) / 0.6);
    return 0.01 + (slope - 0.01) * smooth_step((y - (kFloorEdge - 40.0)) / 80.0);
}

/// Elevation above the south edge along the fall line, at any y of the domain.
class FallLine {
public:
    FallLine() {
        for (int k = 0; k * kCell < kHeight + 100.0; ++k) z_.push_back(z_.back() + kCell * slope_at((k + 0.5) * kCell));
    }
    double at(double y) const {
        const double place = std::max(0.0, y / kCell);
        const auto k = static_cast<std::size_t>(place);
        return z_[k] + (place - static_cast<double>(k)) * (z_[k + 1] - z_[k]);
    }

private:
    std::vector<double> z_{0.0};
};

/// A river bed 4 m deep that winds over the floor, and the foot of the opposite side.
double valley_floor(double x, double y) {
    const double axis = kRiver + 18.0 * std::sin((x - kMiddle) / 160.0);
    const double from_axis = (y - axis) / 22.0;
    const double other_side = std::max(0.0, 230.0 + 20.0 * std::sin(x / 190.0) - y);
    return 0.0016 * other_side * other_side - 4.0 * std::exp(-std::pow(from_axis, 4));
}

/// A hollow along the mass's axis and a scarp of 14 m around its head. The slope around it has spurs and swells.
double slope_relief(double x, double y) {
    const double across = x - kMiddle;
    const double flank = smooth_step((std::abs(across) - 120.0) / 250.0);
    const double hollow = 24.0 * (1.0 - std::exp(-across * across / (2.0 * 300.0 * 300.0)));
    const double head = kToe + 1.03 * kLength - across * across / 400.0;  // an arc around the upper end
    const double scarp = 14.0 * smooth_step((y - head) / 18.0) * std::exp(-std::pow(across / 180.0, 4));
    const double swell = std::sin(x / 23.0) * std::sin(y / 31.0 + 0.7) + 0.6 * std::sin(x / 13.0 + y / 37.0);
    const double spurs = 7.0 * std::sin(x / 62.0 + 0.4 * std::sin(y / 120.0));
    return hollow + scarp + (0.15 + flank) * swell + flank * spurs;
}

double ground(const FallLine& line, double x, double y) {
    const double flank = smooth_step((std::abs(x - kMiddle) - 150.0) / 300.0);
    const double shifted = y + 22.0 * flank * std::sin(x / 95.0);  // the slope's foot is no straight line
    const double on_slope = smooth_step((shifted - kFloorEdge) / 90.0);
    return kFloor + line.at(shifted) + valley_floor(x, y) + on_slope * slope_relief(x, y);
}

/// Depth of the standing mass, up to the factor that makes the volume right.
double mass_shape(double x, double y) {
    // Width such that the integral over the ellipse, kDepth * area * kShape/(kShape + 2), is the volume.
    const double width = 4.0 * kVolume * (kShape + 2.0) / (kDepth * kShape * constants::kPi * kLength);
    const double s = (y - kToe) / kLength;
    const double along = s < kDeepest ? 1.0 - s / kDeepest : (s - kDeepest) / (1.0 - kDeepest);
    const double across = (x - kMiddle) / (0.5 * width);
    const double r = std::sqrt(along * along + across * across);
    return r < 1.0 ? kDepth * (1.0 - std::pow(r, kShape)) : 0.0;
}

/// Half the width of the made-up survey at y [m]. It is the standing mass with the adjacent ground down to where it is
/// deepest. Then comes a lobe that spreads on the valley floor and closes at `toe`.
double surveyed_half_width(double y, double crown, double toe) {
    const double widest = kToe + kDeepest * kLength;
    const double flank = 112.0;  // [m]; the mass itself has 109.5
    if (y >= widest) return flank * std::sqrt(1.0 - std::pow((y - widest) / (crown - widest), 2));
    const double closing = 60.0;  // the length of the lobe's round end [m]
    const double end = std::max(0.0, (toe + closing - y) / closing);
    return (flank + 18.0 * smooth_step((widest - y) / 80.0)) * std::sqrt(std::max(0.0, 1.0 - end * end));
}

/// An outline as somebody might have mapped it after the event. It is drawn from what the paper prints and never from a run.
/// It goes from the headscarp's crown down to a toe 500 m below the mass's upper end, on x = kMiddle. (Section 4.3:
/// "nearly 500 m".) Its edges waver by 5 m, as a hand's do, and the lobe leans downstream.
std::vector<Vec2> survey_outline() {
    const double crown = kToe + 1.03 * kLength, toe = kToe + kLength - 500.0;
    const int steps = 64;
    std::vector<Vec2> east, west;
    for (int k = 0; k <= steps; ++k) {
        // close steps at both ends, where the outline turns
        const double y = 0.5 * (crown + toe + (crown - toe) * std::cos(180.0 * constants::kDegree * k / steps));
        const double half = surveyed_half_width(y, crown, toe);
        const double axis = kMiddle + 12.0 * smooth_step((kToe + 20.0 - y) / 100.0);
        const double wavers = 5.0 * smooth_step(half / 60.0);
        east.emplace_back(axis + half + wavers * std::sin(y / 19.0), y);
        west.emplace_back(axis - half + wavers * std::sin(y / 27.0 + 1.1), y);
    }
    east.insert(east.end(), west.rbegin() + 1, west.rend() - 1);  // both ends are single corners
    return east;
}

}  // namespace

MadeScene bindo() {
    const FallLine line;
    const auto bed = [&line](double x, double y) { return ground(line, x, y); };
    Raster depth = on_nodes(kWidth, kHeight, kCell, mass_shape);
    double volume = 0.0;
    for (const double h : depth.values) volume += h * kCell * kCell;
    for (double& h : depth.values) h *= kVolume / volume;
    return {{{"dem.tif", on_nodes(kWidth, kHeight, kCell, bed)}, {"depth.tif", std::move(depth)}},
            {{"survey.geojson", survey_outline()}}};
}

}  // namespace frana
