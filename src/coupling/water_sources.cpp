#include "coupling/water_sources.h"

#include <algorithm>
#include <cmath>

namespace frana {
namespace {

/// The node whose cell a place lies in.
std::pair<Index, Index> cell_of(const GridGeometry& g, const Vec2& at) {
    const auto nearest = [&](double x, double x0, Index count) {
        return std::clamp<Index>(static_cast<Index>(std::floor((x - x0) / g.cell + 0.5)), 0, count - 1);
    };
    return {nearest(at.x(), g.x0, g.nx), nearest(at.y(), g.y0, g.ny)};
}

/// Where a piece of a line crosses borders of cells, as shares of its length, with both ends.
std::vector<double> crossings(const GridGeometry& g, const Vec2& from, const Vec2& piece) {
    std::vector<double> at = {0.0, 1.0};
    const auto add = [&](double start, double way, double origin) {
        if (way == 0.0) return;
        const double a = (start - origin) / g.cell + 0.5, b = a + way / g.cell;
        for (double border = std::ceil(std::min(a, b)); border < std::max(a, b); border += 1.0)
            at.push_back(std::clamp((border - a) / (b - a), 0.0, 1.0));
    };
    add(from.x(), piece.x(), g.x0), add(from.y(), piece.y(), g.y0);
    std::sort(at.begin(), at.end());
    return at;
}

void add_line(const GridGeometry& g, const Inflow& inflow, WaterSource& source) {
    const double width = inflow.width();
    for (std::size_t k = 0; k + 1 < inflow.line.size(); ++k) {
        const Vec2 piece = inflow.line[k + 1] - inflow.line[k];
        const double length = piece.norm();
        if (!(length > 0.0)) continue;
        const Vec2 right = Vec2(piece.y(), -piece.x()) / length;
        const std::vector<double> at = crossings(g, inflow.line[k], piece);
        for (std::size_t n = 0; n + 1 < at.size(); ++n) {
            const double share = (at[n + 1] - at[n]) * length / width;
            if (!(share > 0.0)) continue;
            const auto [i, j] = cell_of(g, inflow.line[k] + 0.5 * (at[n] + at[n + 1]) * piece);
            source.places.push_back({i, j, share, inflow.to_right ? right : Vec2(-right)});
        }
    }
}

}  // namespace

std::vector<WaterSource> water_sources(const Scene& scene) {
    const GridGeometry& g = scene.bed.geometry;
    std::vector<WaterSource> sources;
    for (const Inflow& inflow : scene.inflows) {
        WaterSource source{inflow.time, inflow.discharge, inflow.speed, {}};
        add_line(g, inflow, source);
        for (const Inflow::Patch& patch : inflow.patches) {
            const auto [i, j] = cell_of(g, patch.at);
            source.places.push_back({i, j, patch.share, Vec2(0, 0)});
        }
        sources.push_back(std::move(source));
    }
    return sources;
}

}  // namespace frana
