#include "particles/lattice.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "terrain/bed_points.h"

namespace frana {

namespace {

struct Patch {
    Index column = 0;
    double volume = 0.0, area = 0.0;
};

/// The patches that hold material, row by row; row j is [start[j], start[j + 1]).
struct Patches {
    Index first_row = 0;
    std::vector<std::size_t> start;
    std::vector<Patch> all;
    OutlineFaults faults;
    Index rows() const { return static_cast<Index>(start.size()) - 1; }
};

Patches collect(const Material& material, const Lattice& lattice) {
    Patches patches;
    patches.faults = material.integrate(lattice, material.box(), [&](const PatchRow& row) {
        if (patches.start.empty()) patches.first_row = row.row;
        while (patches.first_row + static_cast<Index>(patches.start.size()) <= row.row)
            patches.start.push_back(patches.all.size());
        for (Index k = 0; k < row.count; ++k)
            if (row.area[k] > 0.0) patches.all.push_back({row.first_column + k, row.volume[k], row.area[k]});
    });
    patches.start.push_back(patches.all.size());
    return patches;
}

/// The fullest of the eight neighbours that is no dust itself, or nothing.
Patch* fullest_neighbour(Patches& patches, Index row, Index column, double dust) {
    Patch* fullest = nullptr;
    for (Index j = std::max<Index>(row - 1, 0); j <= std::min(row + 1, patches.rows() - 1); ++j) {
        const auto begin = patches.all.begin() + patches.start[j], end = patches.all.begin() + patches.start[j + 1];
        auto it = std::lower_bound(begin, end, column - 1,
                                   [](const Patch& patch, Index wanted) { return patch.column < wanted; });
        for (; it != end && it->column <= column + 1; ++it)
            if (it->area >= dust && (!fullest || it->volume > fullest->volume)) fullest = &*it;
    }
    return fullest;
}

/// Passes on the volume of hardly covered patches, which are left with area zero. Sums stay the same.
void give_away_dust(Patches& patches, double dust) {
    for (Index j = 0; j < patches.rows(); ++j)
        for (std::size_t k = patches.start[j]; k < patches.start[j + 1]; ++k) {
            Patch& patch = patches.all[k];
            if (patch.area >= dust) continue;
            Patch* heir = fullest_neighbour(patches, j, patch.column, dust);
            if (!heir) continue;
            heir->volume += patch.volume;
            heir->area += patch.area;
            patch.volume = patch.area = 0.0;
        }
}

/// Where the particle of a patch stands: on the lattice point. Where that is no ground of the domain, it stands in the
/// patch's part within it, or a quarter. NaN when nothing has ground.
class Standing {
public:
    Standing(const Raster& bed, const Lattice& lattice)
        : bed_(bed),
          lattice_(lattice),
          holes_(std::any_of(bed.values.begin(), bed.values.end(), [](double z) { return std::isnan(z); })) {}

    Vec2 of(Index i, Index j) const {
        const GridGeometry& g = bed_.geometry;
        const double half = 0.5 * lattice_.spacing;
        const double x = inside(lattice_.x(i), half, static_cast<double>(g.nx - 1) * g.cell) + g.x0;
        const double y = inside(lattice_.y(j), half, static_cast<double>(g.ny - 1) * g.cell) + g.y0;
        if (!holes_ || std::isfinite(bed_elevation(bed_, x, y))) return {x, y};
        for (const auto& [sx, sy] : {std::array{-1, -1}, std::array{1, -1}, std::array{-1, 1}, std::array{1, 1}}) {
            Vec2 quarter(x + 0.5 * half * sx, y + 0.5 * half * sy);
            if (std::isfinite(bed_elevation(bed_, quarter.x(), quarter.y()))) return quarter;
        }
        return {Raster::nodata, Raster::nodata};
    }

private:
    static double inside(double centre, double half, double length) {
        if (centre >= 0.0 && centre <= length) return centre;
        const double middle = 0.5 * (std::max(centre - half, 0.0) + std::min(centre + half, length));
        return std::clamp(middle, 0.0, length);  // of water a patch may lie in the pixels beyond
    }
    const Raster& bed_;
    const Lattice& lattice_;
    bool holes_;
};

[[noreturn]] void complain_nodata(const Material& material, const Raster& bed, const Lattice& lattice, Index i,
                                  Index j) {
    const GridGeometry& g = bed.geometry;
    throw UserError(
        fmt::format("{}: material lies on nodata of the elevation model {} near pixel column {}, row {} (x = "
                    "{:.2f}, y = {:.2f}); "
                    "fill the gap (gdal_fillnodata.py) or move the release",
                    material.name(), bed.source, std::lround(lattice.x(i) / g.cell),
                    g.ny - 1 - std::lround(lattice.y(j) / g.cell), g.x0 + lattice.x(i), g.y0 + lattice.y(j)));
}

struct Trial {
    Lattice lattice;
    Index count = 0;
    double miss(Index wanted) const {
        return std::abs(static_cast<double>(count - wanted)) / static_cast<double>(wanted);
    }
};

Trial trial_of(const std::vector<Material>& materials, const Lattice& lattice) {
    Trial trial{lattice, 0};
    const double dust = kDustFraction * lattice.spacing * lattice.spacing;
    for (const Material& material : materials)
        material.integrate(lattice, material.box(), [&](const PatchRow& row) {
            trial.count += std::count_if(row.area, row.area + row.count, [&](double a) { return a >= dust; });
        });
    return trial;
}

/// The lattice nearest to `spacing` whose lines fall on the grid's: k per cell edge, or edges of k cells.
Lattice fitting(double spacing, double cell) {
    const double per_edge = cell / spacing;
    return {per_edge >= 1.0 ? cell / std::round(per_edge) : cell * std::round(1.0 / per_edge), 0.0, 0.0};
}

/// Follows count ~ spacing^-2, bracketed, for one phase of the lattice (in spacings).
Trial seek(const std::vector<Material>& materials, double spacing, const Vec2& phase, Index wanted, double enough) {
    Trial best;
    double low = 0.0, high = std::numeric_limits<double>::infinity();
    for (int round = 0; round < 16; ++round) {
        const Trial trial = trial_of(materials, {spacing, -phase.x() * spacing, -phase.y() * spacing});
        if (round == 0 || trial.miss(wanted) < best.miss(wanted)) best = trial;
        if (best.miss(wanted) <= enough) break;
        (trial.count > wanted ? low : high) = spacing;
        const double ratio =
            std::sqrt(static_cast<double>(std::max<Index>(trial.count, 1)) / static_cast<double>(wanted));
        spacing *= std::clamp(ratio, 0.5, 2.0);
        if (!(spacing > low && spacing < high)) spacing = std::isinf(high) ? 2.0 * low : 0.5 * (low + high);
    }
    return best;
}

}  // namespace

Lattice lattice_of_count(const std::vector<Material>& materials, double cell, double total_area, Index wanted,
                         std::vector<std::string>& log) {
    const double guess = std::sqrt(total_area / static_cast<double>(wanted));
    const auto said = [&](const Trial& trial, const char* kind) {
        log.push_back(fmt::format("particles: {} asked, {} placed on {} lattice of {:.6g} m", wanted, trial.count, kind,
                                  trial.lattice.spacing));
        return trial.lattice;
    };
    Trial fits = trial_of(materials, fitting(guess, cell));
    if (fits.miss(wanted) <= 0.02) return said(fits, "a grid-aligned");

    const double enough = 2e-3;
    Trial best;
    for (const Vec2& phase : {Vec2(0.0, 0.0), Vec2(0.0, 0.5), Vec2(0.25, 0.75), Vec2(0.125, 0.625)}) {
        const Trial trial = seek(materials, guess, phase, wanted, enough);
        if (best.count == 0 || trial.miss(wanted) < best.miss(wanted)) best = trial;
        if (best.miss(wanted) <= enough) break;
    }
    const Lattice near = fitting(best.lattice.spacing, cell);
    if (near.spacing != fits.lattice.spacing) fits = trial_of(materials, near);
    if (fits.miss(wanted) <= 0.02) return said(fits, "a grid-aligned");
    return said(best, "a free");
}

OutlineFaults place_on_lattice(const Material& material, const Lattice& lattice, const Raster& bed, Seeds& seeds) {
    Patches patches = collect(material, lattice);
    give_away_dust(patches, kDustFraction * lattice.spacing * lattice.spacing);
    const std::size_t most = seeds.x.size() + patches.all.size();
    for (auto* column : {&seeds.x, &seeds.y, &seeds.volume, &seeds.depth, &seeds.size}) column->reserve(most);
    const Standing standing(bed, lattice);
    for (Index j = 0; j < patches.rows(); ++j)
        for (std::size_t k = patches.start[j]; k < patches.start[j + 1]; ++k) {
            const Patch& patch = patches.all[k];
            if (!(patch.area > 0.0)) continue;
            const Vec2 at = standing.of(patch.column, patches.first_row + j);
            if (std::isnan(at.x())) complain_nodata(material, bed, lattice, patch.column, patches.first_row + j);
            seeds.x.push_back(at.x());
            seeds.y.push_back(at.y());
            seeds.volume.push_back(patch.volume);
            seeds.depth.push_back(patch.volume / patch.area);
            seeds.size.push_back(lattice.spacing);
        }
    return patches.faults;
}

}  // namespace frana
