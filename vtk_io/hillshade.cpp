#include "vtk_io/hillshade.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/constants.h"

namespace frana {
namespace {

/// Means over blocks of k x k nodes, of the valid ones; the last blocks may be smaller.
Raster block_means(const Raster& raster, Index k) {
    const GridGeometry& fine = raster.geometry;
    GridGeometry coarse = fine;
    coarse.cell = fine.cell * static_cast<double>(k);
    coarse.nx = (fine.nx + k - 1) / k;
    coarse.ny = (fine.ny + k - 1) / k;
    coarse.x0 = fine.x0 + 0.5 * static_cast<double>(k - 1) * fine.cell;
    coarse.y0 = fine.y0 + 0.5 * static_cast<double>(k - 1) * fine.cell;
    Raster result = Raster::filled(coarse, Raster::nodata);
    for (Index j = 0; j < coarse.ny; ++j)
        for (Index i = 0; i < coarse.nx; ++i) {
            double sum = 0.0;
            Index count = 0;
            for (Index v = j * k; v < std::min((j + 1) * k, fine.ny); ++v)
                for (Index u = i * k; u < std::min((i + 1) * k, fine.nx); ++u) {
                    const double value = raster.at(u, v);
                    if (std::isnan(value)) continue;
                    sum += value;
                    ++count;
                }
            if (2 * count >= k * k || (count > 0 && (i + 1 == coarse.nx || j + 1 == coarse.ny)))
                result.at(i, j) = sum / static_cast<double>(count);
        }
    return result;
}

/// Four nodes along one axis and their weights; `nearest` < 0 outside the outer pixels.
struct Stencil {
    std::array<Index, 4> node{};
    std::array<double, 4> weight{};
    Index nearest = -1;
};

/// Nodes beyond the edge continue the last slope: their weights go to the two outermost nodes.
void fold_ghosts(Stencil& s, Index base, Index count) {
    for (Index k = 0; k < 4; ++k) {
        const Index node = base + k - 1;
        const Index beyond = node < 0 ? -node : node >= count ? node - count + 1 : 0;
        if (beyond == 0) continue;
        const Index last = node < 0 ? 0 : count - 1, inner = node < 0 ? 1 : count - 2;
        const double weight = s.weight[static_cast<std::size_t>(k)];
        s.weight[static_cast<std::size_t>(k)] = 0.0;
        s.weight[static_cast<std::size_t>(last - base + 1)] += weight * static_cast<double>(1 + beyond);
        s.weight[static_cast<std::size_t>(inner - base + 1)] -= weight * static_cast<double>(beyond);
    }
}

Stencil stencil_at(double place, Index count, Between between) {
    Stencil s;
    const double last = static_cast<double>(count - 1);
    if (place < -0.5 - 1e-9 || place > last + 0.5 + 1e-9) return s;
    const bool smooth = between == Between::smooth && count > 1;
    const double p = smooth ? place : std::clamp(place, 0.0, last);
    const auto base = static_cast<Index>(std::floor(p));
    const double t = p - static_cast<double>(base);
    for (Index k = 0; k < 4; ++k) s.node[static_cast<std::size_t>(k)] = std::clamp<Index>(base + k - 1, 0, count - 1);
    if (smooth) {
        s.weight = {(1.0 - t) * (1.0 - t) * (1.0 - t) / 6.0, (4.0 + t * t * (-6.0 + 3.0 * t)) / 6.0,
                    (1.0 + t * (3.0 + t * (3.0 - 3.0 * t))) / 6.0, t * t * t / 6.0};
        fold_ghosts(s, base, count);
    } else {
        s.weight = {0.0, 1.0 - t, t, 0.0};
    }
    s.nearest = std::clamp<Index>(std::lround(p), 0, count - 1);
    return s;
}

/// Four rows of the raster brought to one, at the nodes from `first` to `last`.
void sum_rows(const Raster& raster, const Stencil& y, Index first, Index last, std::vector<double>& row) {
    std::array<const double*, 4> rows{};
    for (std::size_t b = 0; b < 4; ++b) rows[b] = raster.values.data() + y.node[b] * raster.geometry.nx;
    for (Index i = first; i <= last; ++i)
        row[static_cast<std::size_t>(i)] =
            y.weight[0] * rows[0][i] + y.weight[1] * rows[1][i] + y.weight[2] * rows[2][i] + y.weight[3] * rows[3][i];
}

double weighted(const std::vector<double>& row, const Stencil& x) {
    double sum = 0.0;
    for (std::size_t a = 0; a < 4; ++a) sum += x.weight[a] * row[static_cast<std::size_t>(x.node[a])];
    return sum;
}

/// Positive weights only, over the valid nodes.
double weighted_valid(const Raster& raster, const Stencil& x, const Stencil& y) {
    double sum = 0.0, weights = 0.0;
    for (std::size_t b = 1; b < 3; ++b)
        for (std::size_t a = 1; a < 3; ++a) {
            const double value = raster.at(x.node[a], y.node[b]);
            const double weight = std::max(x.weight[a], 0.0) * std::max(y.weight[b], 0.0);
            if (std::isnan(value)) continue;
            sum += weight * value;
            weights += weight;
        }
    return weights > 0.0 ? sum / weights : Raster::nodata;
}

}  // namespace

Raster resampled(const Raster& raster, const GridGeometry& target, Between between) {
    const double ratio = target.cell / raster.geometry.cell;
    if (ratio > 1.5) return resampled(block_means(raster, std::lround(ratio)), target, between);
    const GridGeometry& from = raster.geometry;
    Raster result = Raster::filled(target, Raster::nodata);
    result.crs_wkt = raster.crs_wkt;
    std::vector<Stencil> columns;
    Index first = from.nx, last = -1;
    for (Index i = 0; i < target.nx; ++i) {
        columns.push_back(stencil_at((target.x(i) - from.x0) / from.cell, from.nx, between));
        if (columns.back().nearest < 0) continue;
        first = std::min(first, columns.back().node.front());
        last = std::max(last, columns.back().node.back());
    }
    std::vector<double> summed(static_cast<std::size_t>(from.nx));
    for (Index j = 0; j < target.ny; ++j) {
        const Stencil row = stencil_at((target.y(j) - from.y0) / from.cell, from.ny, between);
        if (row.nearest < 0) continue;
        sum_rows(raster, row, first, last, summed);
        for (Index i = 0; i < target.nx; ++i) {
            const Stencil& column = columns[static_cast<std::size_t>(i)];
            if (column.nearest < 0 || std::isnan(raster.at(column.nearest, row.nearest))) continue;
            const double value = weighted(summed, column);
            result.at(i, j) = std::isnan(value) ? weighted_valid(raster, column, row) : value;
        }
    }
    return result;
}

namespace {

/// Slope along one axis from the valid ones of two neighbours [1].
double slope(double before, double here, double after, double cell) {
    const bool b = !std::isnan(before), a = !std::isnan(after);
    if (a && b) return 0.5 * (after - before) / cell;
    if (a) return (after - here) / cell;
    return b ? (here - before) / cell : 0.0;
}

Vec2 gradient(const Raster& bed, Index i, Index j) {
    const GridGeometry& g = bed.geometry;
    const auto value = [&](Index u, Index v) {
        return u < 0 || v < 0 || u >= g.nx || v >= g.ny ? Raster::nodata : bed.at(u, v);
    };
    const double here = bed.at(i, j);
    return {slope(value(i - 1, j), here, value(i + 1, j), g.cell),
            slope(value(i, j - 1), here, value(i, j + 1), g.cell)};
}

}  // namespace

std::vector<float> hillshade(const Raster& bed, double exaggeration, double turn) {
    struct Lamp {
        double azimuth, weight;
    };
    constexpr std::array<Lamp, 4> lamps{{{315.0, 0.5}, {270.0, 0.2}, {360.0, 0.2}, {225.0, 0.1}}};
    const double height = std::sqrt(0.5);  // sine and cosine of 45 degrees
    const GridGeometry& g = bed.geometry;
    std::vector<float> shade(static_cast<std::size_t>(g.size()), std::nanf(""));
    std::array<Vec2, 4> light;
    for (std::size_t k = 0; k < 4; ++k) {
        const double azimuth = lamps[k].azimuth * constants::kDegree + turn;
        light[k] = height * Vec2(std::sin(azimuth), std::cos(azimuth));
    }
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) {
            if (std::isnan(bed.at(i, j))) continue;
            const Vec2 s = exaggeration * gradient(bed, i, j);
            double sum = 0.0;
            for (std::size_t k = 0; k < 4; ++k) sum += lamps[k].weight * std::max(0.0, height - s.dot(light[k]));
            const double length = std::sqrt(1.0 + s.squaredNorm());
            shade[static_cast<std::size_t>(j * g.nx + i)] = static_cast<float>(std::min(sum / length, 1.0));
        }
    return shade;
}

double shading_exaggeration(const Raster& bed) {
    double sum = 0.0;
    Index count = 0;
    for (Index j = 0; j < bed.geometry.ny; j += 3)
        for (Index i = 0; i < bed.geometry.nx; i += 3) {
            if (std::isnan(bed.at(i, j))) continue;
            sum += gradient(bed, i, j).norm();
            ++count;
        }
    if (count == 0 || sum <= 0.0) return 1.0;
    return std::clamp(0.6 * static_cast<double>(count) / sum, 1.0, 5.0);
}

ReliefGrey::ReliefGrey(const std::vector<float>& shade) {
    std::vector<float> some;
    for (std::size_t i = 0; i < shade.size(); i += 7)
        if (!std::isnan(shade[i])) some.push_back(shade[i]);
    double gamma = 1.0;
    const auto fill = [&] {
        for (std::size_t k = 0; k < levels_.size(); ++k)
            levels_[k] = 0.42 + 0.56 * std::pow(static_cast<double>(k) / (kLevels - 1), gamma);
    };
    if (some.empty()) {
        fill();
        return;
    }
    const auto percentile = [&](double share) {
        const auto place = some.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(some.size() - 1));
        std::nth_element(some.begin(), place, some.end());
        return static_cast<double>(*place);
    };
    const double low = percentile(0.01), high = percentile(0.99);
    span_ = std::max(high - low, 0.35);
    low_ = low - 0.7 * (span_ - (high - low));  // an even slope comes out light
    const double middle = std::clamp((percentile(0.5) - low_) / span_, 0.05, 0.95);
    gamma = std::clamp(std::log(0.68) / std::log(middle), 0.6, 1.7);
    fill();
}

}  // namespace frana
