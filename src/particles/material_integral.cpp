// The integral of a release over the patches of a lattice.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/compensated_sum.h"
#include "particles/material.h"

namespace frana {

namespace {

/// Lines start + k step strictly between low and high, and both of these.
void add_lines(std::vector<double>& lines, double start, double step, double low, double high) {
    for (double k = std::floor((low - start) / step) + 1.0;; k += 1.0) {
        const double line = start + k * step;
        if (!(line < high)) return;
        if (line > low) lines.push_back(line);
    }
}

/// Ascending, without lines that differ by round-off of their own computation only.
void tidy(std::vector<double>& lines) {
    std::sort(lines.begin(), lines.end());
    const double extent = std::max(std::abs(lines.front()), std::abs(lines.back()));
    const double same = 16.0 * std::numeric_limits<double>::epsilon() * extent;
    const double last = lines.back();
    lines.erase(std::unique(lines.begin(), lines.end(), [&](double a, double b) { return b - a <= same; }),
                lines.end());
    lines.back() = last;
}

/// Not narrower than the round-off of its own corners.
bool wide_enough(const Box& box) {
    const double extent = std::max({std::abs(box.x0), std::abs(box.y0), std::abs(box.x1), std::abs(box.y1)});
    const double least = 32.0 * std::numeric_limits<double>::epsilon() * extent;
    return box.x1 - box.x0 > least && box.y1 - box.y0 > least;
}

}  // namespace

/// The common refinement of lattice and pixels within a box. Each fine column lies in one patch column and
/// one pixel column, likewise the rows. Without a lattice every fine cell is its own patch.
struct Material::FineLines {
    std::vector<double> x, y;
    std::vector<Index> patch_column, patch_row;  ///< columns counted from first_column
    std::vector<Index> pixel_column, pixel_row;
    Index first_column = 0, columns = 0;
};

Material::FineLines Material::fine_lines(const Lattice* lattice, const Box& within) const {
    FineLines fine;
    const auto lines = [&](std::vector<double>& all, double low, double high, double patch0, double pixel0) {
        all = {low, high};
        if (lattice) add_lines(all, patch0, lattice->spacing, low, high);
        if (release_.depth_field) add_lines(all, pixel0, pixel_, low, high);
        tidy(all);
    };
    lines(fine.x, within.x0, within.x1, lattice ? lattice->x0 : 0.0, pixel_x0_);
    lines(fine.y, within.y0, within.y1, lattice ? lattice->y0 : 0.0, pixel_y0_);
    const auto number = [](const std::vector<double>& all, double start, double step, std::vector<Index>& numbers) {
        numbers.resize(all.size() - 1);
        for (std::size_t k = 0; k + 1 < all.size(); ++k)
            numbers[k] = static_cast<Index>(std::floor((0.5 * (all[k] + all[k + 1]) - start) / step));
    };
    if (lattice) {
        number(fine.x, lattice->x0, lattice->spacing, fine.patch_column);
        number(fine.y, lattice->y0, lattice->spacing, fine.patch_row);
    } else {
        fine.patch_column.resize(fine.x.size() - 1);
        fine.patch_row.resize(fine.y.size() - 1);
        std::iota(fine.patch_column.begin(), fine.patch_column.end(), Index{0});
        std::iota(fine.patch_row.begin(), fine.patch_row.end(), Index{0});
    }
    if (release_.depth_field) {
        number(fine.x, pixel_x0_, pixel_, fine.pixel_column);
        number(fine.y, pixel_y0_, pixel_, fine.pixel_row);
        const GridGeometry& pixels = release_.depth_field->geometry;
        for (Index& k : fine.pixel_column) k = std::clamp<Index>(k, 0, pixels.nx - 1);
        for (Index& k : fine.pixel_row) k = std::clamp<Index>(k, 0, pixels.ny - 1);
    }
    fine.first_column = fine.patch_column.front();
    for (Index& k : fine.patch_column) k -= fine.first_column;
    fine.columns = fine.patch_column.back() + 1;
    return fine;
}

OutlineFaults Material::integrate_fine(const FineLines& fine, const VisitPatchRow& visit) const {
    const Index fine_columns = static_cast<Index>(fine.x.size()) - 1;
    const Index fine_rows = static_cast<Index>(fine.y.size()) - 1;
    std::vector<double> covered(fine_columns), volume(fine.columns, 0.0), area(fine.columns, 0.0);
    std::optional<OutlineArea> outline;
    if (!rings_.empty()) outline.emplace(rings_, fine.x, fine.y);
    Index low = fine.columns, high = -1;  // patch columns that hold something

    for (Index j = 0; j < fine_rows; ++j) {
        std::pair<Index, Index> range{0, fine_columns};
        const double height = fine.y[j + 1] - fine.y[j];
        if (outline)
            range = outline->row(j, covered);
        else
            for (Index i = 0; i < fine_columns; ++i) covered[i] = (fine.x[i + 1] - fine.x[i]) * height;
        if (range.first < range.second) {
            low = std::min(low, fine.patch_column[range.first]);
            high = std::max(high, fine.patch_column[range.second - 1]);
        }
        const double* pixels = nullptr;
        if (release_.depth_field)
            pixels = release_.depth_field->values.data() + fine.pixel_row[j] * release_.depth_field->geometry.nx;
        for (Index i = range.first; i < range.second; ++i) {
            const double depth = pixels ? pixels[fine.pixel_column[i]] : release_.depth;
            if (!(depth > 0.0)) continue;
            area[fine.patch_column[i]] += covered[i];
            volume[fine.patch_column[i]] += covered[i] * depth;
        }
        const bool row_ends = j + 1 == fine_rows || fine.patch_row[j + 1] != fine.patch_row[j];
        if (!row_ends || high < low) continue;
        visit({fine.patch_row[j], fine.first_column + low, high - low + 1, &volume[low], &area[low]});
        std::fill(volume.begin() + low, volume.begin() + high + 1, 0.0);
        std::fill(area.begin() + low, area.begin() + high + 1, 0.0);
        low = fine.columns;
        high = -1;
    }
    return outline ? outline->faults() : OutlineFaults{};
}

OutlineFaults Material::integrate(const Lattice& lattice, const Box& within, const VisitPatchRow& visit) const {
    const Box box = within.common(unclipped_box_);
    if (!wide_enough(box)) return {};
    return integrate_fine(fine_lines(&lattice, box), visit);
}

MaterialTotals Material::totals(const Box& within) const {
    const Box box = within.common(unclipped_box_);
    if (!wide_enough(box)) return {};
    CompensatedSum volume, area;
    integrate_fine(fine_lines(nullptr, box), [&](const PatchRow& row) {
        for (Index k = 0; k < row.count; ++k) {
            volume.add(row.volume[k]);
            area.add(row.area[k]);
        }
    });
    return {volume.value(), area.value()};
}

}  // namespace frana
