#include "compare/expected_width.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "compare/runout.h"
#include "terrain/places.h"

namespace frana {
namespace {

/// Between nodes; nothing without terrain.
std::optional<double> height_at(const Raster& bed, const Vec2& p) {
    const GridGeometry& g = bed.geometry;
    const NodeSquare around(g, p);
    if (!between_nodes(g, p) || !(around.s < 1.0 && around.t < 1.0)) return std::nullopt;
    const double z = around.value(bed);
    return std::isnan(z) ? std::nullopt : std::optional<double>(z);
}

/// The release as a rectangle: sqrt(12) standard deviations long and wide.
struct Rectangle {
    Vec2 middle{0, 0};
    double volume = 0.0;

    explicit Rectangle(const Seeds& release) {
        for (std::size_t p = 0; p < release.x.size(); ++p) {
            middle += release.volume[p] * Vec2(release.x[p], release.y[p]);
            volume += release.volume[p];
        }
        middle /= volume;
    }

    double size_along(const Seeds& release, const Vec2& direction) const {
        double sum = 0.0;
        for (std::size_t p = 0; p < release.x.size(); ++p) {
            const double off = (Vec2(release.x[p], release.y[p]) - middle).dot(direction);
            // A point stands for the material of its own patch, which may fill little of it.
            const double patch = std::min(release.size[p] * release.size[p], release.volume[p] / release.depth[p]);
            sum += release.volume[p] * (off * off + patch / 12.0);
        }
        return std::sqrt(12.0 * sum / volume);
    }
};

Vec2 nearest_seed(const Seeds& release, const Vec2& place) {
    Vec2 best(0, 0);
    double least = INFINITY;
    for (std::size_t p = 0; p < release.x.size(); ++p) {
        const Vec2 here(release.x[p], release.y[p]);
        if ((here - place).norm() < least) least = (here - place).norm(), best = here;
    }
    return best;
}

/// A section across a valley, sampled every `step`; the middle sample is on the path.
class Section {
public:
    Section(const Raster& bed, const Vec2& place, const Vec2& across, double half_width)
        : step_(0.5 * bed.geometry.cell), middle_(static_cast<Index>(std::ceil(half_width / step_))) {
        for (Index k = -middle_; k <= middle_; ++k)
            heights_.push_back(height_at(bed, place + static_cast<double>(k) * step_ * across).value_or(INFINITY));
    }

    /// Width that is covered when the section holds `area`, no more than `widest`.
    double filled(double area, double widest) const {
        Index left = lowest(), right = left;
        double level = height(left), sum = level;
        for (Index count = 1;; ++count) {
            const double width = step_ * static_cast<double>(count);
            const double next = std::min(height(left - 1), height(right + 1));
            level = std::max(level, next);  // up to which these samples are filled before the next one is wet
            if (width >= widest || step_ * (level * static_cast<double>(count) - sum) >= area)
                return std::min(width, widest);
            (height(left - 1) < height(right + 1) ? --left : ++right);
            sum += next;
        }
    }

private:
    double height(Index k) const {
        return k < 0 || k >= static_cast<Index>(heights_.size()) ? INFINITY : heights_[static_cast<std::size_t>(k)];
    }
    /// From the path down, since a smoothed path need not lie in the channel's bottom.
    Index lowest() const {
        Index k = middle_;
        while (height(k - 1) < height(k) || height(k + 1) < height(k)) k += height(k - 1) < height(k + 1) ? -1 : 1;
        return k;
    }

    double step_;
    Index middle_;
    std::vector<double> heights_;
};

/// Direction of the path over about a length from one of its points on.
Vec2 direction_at(const Polyline& path, std::size_t k, double length) {
    std::size_t ahead = k, behind = k;
    while (ahead + 1 < path.size() && (path[ahead] - path[k]).norm() < length) ++ahead;
    while (behind > 0 && ahead == k) --behind;
    const Vec2 way = path[ahead] - path[behind];
    return way.norm() > 0.0 ? Vec2(way.normalized()) : Vec2(1, 0);
}

}  // namespace

ExpectedWidth expected_width(const Raster& bed, const Seeds& release, double friction) {
    ExpectedWidth result;
    if (release.x.empty()) return result;
    const Rectangle rectangle(release);
    const Polyline path = steepest_path(bed, nearest_seed(release, rectangle.middle));
    if (!(length_of(path) > 0.0)) return result;
    const Vec2& start = path.front();
    double area = 0.0;
    for (const double size : release.size) area += size * size;
    const Vec2 down = direction_at(path, 0, std::sqrt(area));
    result.release = rectangle.size_along(release, Vec2(-down.y(), down.x()));
    const double section = rectangle.volume / rectangle.size_along(release, down);

    const double top = height_at(bed, start).value_or(0.0), look_ahead = 10.0 * bed.geometry.cell;
    std::vector<double> widths;
    for (std::size_t k = 0; k < path.size(); k += 2) {
        const double way = (path[k] - start).norm();
        const auto z = height_at(bed, path[k]);
        if (!z || top - *z < friction * way) break;
        const Vec2 along = direction_at(path, k, look_ahead);
        const Section valley(bed, path[k], Vec2(-along.y(), along.x()), result.release);
        widths.push_back(valley.filled(section, result.release));
    }
    if (widths.empty()) return result;
    const auto middle = widths.begin() + static_cast<std::ptrdiff_t>(widths.size() / 2);
    std::nth_element(widths.begin(), middle, widths.end());
    result.width = *middle;
    return result;
}

}  // namespace frana
