#include "particles/material.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace frana {

namespace {

constexpr double kFar = 1e300;

/// Pixels that stand a whole number of half cells from the nodes are put there exactly. The difference of two map
/// coordinates of 10^6 m carries errors of 1e-10 m. These would leave a sliver at every lattice line.
double snapped(double offset, double cell) {
    const double step = 0.5 * cell;
    const double whole = std::round(offset / step) * step;
    return std::abs(offset - whole) < 1e-7 * cell ? whole : offset;
}

}  // namespace

Box Box::common(const Box& o) const {
    return {std::max(x0, o.x0), std::max(y0, o.y0), std::min(x1, o.x1), std::min(y1, o.y1)};
}

Material::Material(const Release& release, const GridGeometry& grid, std::string name, Reach reach)
    : release_(release), name_(std::move(name)), reach_(reach) {
    const double rim = reach == Reach::pixels ? 0.5 * grid.cell : 0.0;
    domain_ = {-rim, -rim, static_cast<double>(grid.nx - 1) * grid.cell + rim,
               static_cast<double>(grid.ny - 1) * grid.cell + rim};
    unclipped_box_ = {-kFar, -kFar, kFar, kFar};
    if (release.outline) take_outline(grid);
    if (release.depth_field) take_raster(grid);
    if (!release.depth_field && !(release.depth > 0.0 && std::isfinite(release.depth)))
        throw UserError(fmt::format("{}: depth is {} m; a release needs a depth above zero", name_, release.depth));
    if (!release.outline && !release.depth_field) unclipped_box_ = domain_;
    box_ = unclipped_box_.common(domain_);
}

void Material::take_outline(const GridGeometry& grid) {
    Box around{kFar, kFar, -kFar, -kFar};
    for (const Polygon& part : release_.outline->parts)
        for (const auto& ring : part.rings)
            for (const Vec2& vertex : ring) {
                if (!vertex.allFinite())
                    throw UserError(fmt::format("{}: its outline {} has a vertex that is not a number; repair the file",
                                                name_, release_.outline->source));
                const Vec2 local(vertex.x() - grid.x0, vertex.y() - grid.y0);
                around = {std::min(around.x0, local.x()), std::min(around.y0, local.y()),
                          std::max(around.x1, local.x()), std::max(around.y1, local.y())};
            }
    rings_ = rings_of(*release_.outline, {grid.x0, grid.y0});
    if (rings_.empty())
        throw UserError(fmt::format("{}: its outline {} holds no polygon; give a file with polygons", name_,
                                    release_.outline->source));
    unclipped_box_ = unclipped_box_.common(around);
    sort_edges_into_bands();
}

void Material::take_raster(const GridGeometry& grid) {
    const Raster& raster = *release_.depth_field;
    const GridGeometry& g = raster.geometry;
    pixel_ = g.cell;
    pixel_x0_ = snapped(g.x0 - 0.5 * g.cell - grid.x0, grid.cell);
    pixel_y0_ = snapped(g.y0 - 0.5 * g.cell - grid.y0, grid.cell);
    Index i0 = g.nx, i1 = -1, j0 = g.ny, j1 = -1;
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) {
            if (!(raster.at(i, j) > 0.0)) continue;
            if (std::isinf(raster.at(i, j)))
                throw UserError(fmt::format("{}: pixel ({}, {}) of {} is infinite; mark it as nodata", name_, i,
                                            g.ny - 1 - j, raster.source));
            i0 = std::min(i0, i), i1 = std::max(i1, i);
            j0 = std::min(j0, j), j1 = std::max(j1, j);
        }
    const auto line = [&](double start, Index k) { return start + static_cast<double>(k) * pixel_; };
    unclipped_box_ = unclipped_box_.common(
        {line(pixel_x0_, i0), line(pixel_y0_, j0), line(pixel_x0_, i1 + 1), line(pixel_y0_, j1 + 1)});
}

void Material::sort_edges_into_bands() {
    for (const auto& ring : rings_)
        for (std::size_t k = 0; k < ring.size(); ++k) edges_.push_back({ring[k], ring[(k + 1) % ring.size()]});
    const Index bands = std::min<Index>(4096, static_cast<Index>(edges_.size()));
    double low = kFar, high = -kFar;
    for (const auto& edge : edges_) low = std::min(low, edge[0].y()), high = std::max(high, edge[0].y());
    band_y0_ = low;
    band_height_ = std::max((high - low) / static_cast<double>(bands), 1e-300);
    const auto band_of = [&](double y) {
        return std::clamp<Index>(static_cast<Index>(std::floor((y - band_y0_) / band_height_)), 0, bands - 1);
    };
    const auto each = [&](auto&& visit) {
        for (std::size_t e = 0; e < edges_.size(); ++e) {
            const auto [a, b] = std::minmax(edges_[e][0].y(), edges_[e][1].y());
            for (Index k = band_of(a); k <= band_of(b); ++k) visit(k, e);
        }
    };
    band_start_.assign(bands + 1, 0);
    each([&](Index k, std::size_t) { ++band_start_[k + 1]; });
    for (Index k = 0; k < bands; ++k) band_start_[k + 1] += band_start_[k];
    band_edges_.resize(band_start_.back());
    std::vector<std::size_t> next(band_start_.begin(), band_start_.end() - 1);
    each([&](Index k, std::size_t e) { band_edges_[next[k]++] = e; });
}

bool Material::outline_contains(double x, double y) const {
    const double band = std::floor((y - band_y0_) / band_height_);
    if (!(band >= 0.0 && band < static_cast<double>(band_start_.size() - 1))) return false;
    const auto k = static_cast<std::size_t>(band);
    int winding = 0;
    for (std::size_t n = band_start_[k]; n < band_start_[k + 1]; ++n) {
        const auto& [a, b] = edges_[band_edges_[n]];
        if ((a.y() <= y) == (b.y() <= y)) continue;
        const double crossing = a.x() + (y - a.y()) * (b.x() - a.x()) / (b.y() - a.y());
        if (crossing > x) winding += b.y() > a.y() ? 1 : -1;
    }
    return winding > 0;
}

double Material::depth_in(double x, double y) const {
    if (!release_.depth_field) return release_.depth;
    const Raster& raster = *release_.depth_field;
    const auto i = static_cast<Index>(std::floor((x - pixel_x0_) / pixel_));
    const auto j = static_cast<Index>(std::floor((y - pixel_y0_) / pixel_));
    if (i < 0 || j < 0 || i >= raster.geometry.nx || j >= raster.geometry.ny) return 0.0;
    return raster.at(i, j) > 0.0 ? raster.at(i, j) : 0.0;
}

bool Material::contains(double x, double y) const {
    if (!(x >= box_.x0 && x <= box_.x1 && y >= box_.y0 && y <= box_.y1)) return false;
    return depth_in(x, y) > 0.0 && (rings_.empty() || outline_contains(x, y));
}

}  // namespace frana
