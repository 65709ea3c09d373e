#include <algorithm>

#include "vtk_io/figures/objects_3d.h"

namespace frana {

void draw_inset(Canvas& canvas, const Objects3d::Inset& inset, const Vec2& corner, const Vec2& most, double unit) {
    if (inset.areas.empty()) return;
    Vec2 low = inset.areas.front().corners.front(), high = low;
    for (const auto& area : inset.areas)
        for (const Vec2& p : area.corners) low = low.cwiseMin(p), high = high.cwiseMax(p);
    const Vec2 size = (high - low).cwiseMax(1e-9);
    const double scale = std::min(most.x() / size.x(), most.y() / size.y());
    const Vec2 at(corner.x(), corner.y() - scale * size.y());  // lower left
    const TextStyle style{0.9 * unit, Across::left, Upward::top, 0.0, false, false, colours::note};
    const double wide = std::max(scale * size.x(), text_size(inset.caption, style).x());
    canvas.fill(Rectangle{corner.x() - 0.5 * unit, at.y() - 1.9 * unit, corner.x() + wide + 0.5 * unit,
                          corner.y() + 0.5 * unit},
                colours::white);
    for (const auto& area : inset.areas) {
        std::vector<Vec2> corners;
        for (const Vec2& p : area.corners) corners.emplace_back(at + scale * (p - low));
        canvas.fill(corners, area.colour);
    }
    canvas.frame({at.x(), at.y(), at.x() + scale * size.x(), corner.y()}, {colours::black, 0.08 * unit, {}});
    canvas.text(inset.caption, {at.x(), at.y() - 0.5 * unit}, style);
}

}  // namespace frana
