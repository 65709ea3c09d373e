#include <algorithm>

#include "vtk_io/figures/objects_3d.h"

namespace frana {
namespace {

/// Where an inset's areas lie in their own plane, and how large they are drawn.
struct Fit {
    Vec2 low, size;  ///< [m]
    double scale;    ///< [px/m]
};

Fit fit_of(const Objects3d::Inset& inset, const Vec2& most) {
    Vec2 low = inset.areas.front().corners.front(), high = low;
    for (const auto& area : inset.areas)
        for (const Vec2& p : area.corners) low = low.cwiseMin(p), high = high.cwiseMax(p);
    const Vec2 size = (high - low).cwiseMax(1e-9);
    return {low, size, std::min(most.x() / size.x(), most.y() / size.y())};
}

constexpr double kCaption = 1.9;  // its line and the gap above it [units of text]

}  // namespace

double height_of_inset(const Objects3d::Inset& inset, const Vec2& most, double unit) {
    if (inset.areas.empty()) return 0.0;
    const Fit fit = fit_of(inset, most);
    return fit.scale * fit.size.y() + kCaption * unit;
}

void draw_inset(Canvas& canvas, const Objects3d::Inset& inset, const Vec2& corner, const Vec2& most, double unit) {
    if (inset.areas.empty()) return;
    const Fit fit = fit_of(inset, most);
    const Vec2 at(corner.x(), corner.y() - fit.scale * fit.size.y());  // lower left
    for (const auto& area : inset.areas) {
        std::vector<Vec2> corners;
        for (const Vec2& p : area.corners) corners.emplace_back(at + fit.scale * (p - fit.low));
        canvas.fill(corners, area.colour);
    }
    canvas.frame({at.x(), at.y(), at.x() + fit.scale * fit.size.x(), corner.y()}, {colours::black, 0.08 * unit, {}});
    canvas.text(inset.caption, {at.x(), at.y() - 0.5 * unit},
                {0.9 * unit, Across::left, Upward::top, 0.0, false, false, colours::note});
}

}  // namespace frana
