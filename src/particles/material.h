#pragma once
// One release as a depth field on the map, and its integral over the patches of a square lattice.
// All coordinates here are local: metres from node (0, 0), so that large map coordinates cost no digits.
#include <functional>
#include <string>
#include <vector>

#include "particles/release.h"
#include "terrain/outline_area.h"

namespace frana {

/// A rectangle in local coordinates [m].
struct Box {
    double x0 = 0.0, y0 = 0.0, x1 = 0.0, y1 = 0.0;
    bool empty() const { return !(x0 < x1 && y0 < y1); }
    Box common(const Box& o) const;
};

/// Square patches; patch (i, j) is [x0 + i spacing, x0 + (i+1) spacing] x the same in y, its point the
/// centre.
struct Lattice {
    double spacing = 1.0;       ///< [m]
    double x0 = 0.0, y0 = 0.0;  ///< local position of line 0 [m]
    double x(Index i) const { return x0 + (static_cast<double>(i) + 0.5) * spacing; }
    double y(Index j) const { return y0 + (static_cast<double>(j) + 0.5) * spacing; }
    Index column(double at_x) const { return static_cast<Index>(std::floor((at_x - x0) / spacing)); }
    Index row(double at_y) const { return static_cast<Index>(std::floor((at_y - y0) / spacing)); }
};

/// The material in one row of patches: column first_column + k holds volume[k] [m^3] over area[k] [m^2].
struct PatchRow {
    Index row = 0, first_column = 0, count = 0;
    const double* volume = nullptr;
    const double* area = nullptr;
};
using VisitPatchRow = std::function<void(const PatchRow&)>;

/// How far material reaches: particles live between the outer nodes, water in whole pixels.
enum class Reach { nodes, pixels };

struct MaterialTotals {
    double volume = 0.0, area = 0.0;
};

class Material {
public:
    /// Keeps a reference to the release. Throws UserError on a depth that is not a positive number.
    Material(const Release& release, const GridGeometry& grid, std::string name, Reach reach);

    const std::string& name() const { return name_; }
    const Release& release() const { return release_; }
    Reach reach() const { return reach_; }
    /// Where material lies as far as it may reach on the grid, and without that limit.
    const Box& box() const { return box_; }
    const Box& unclipped_box() const { return unclipped_box_; }

    bool contains(double x, double y) const;

    /// Integrates depth over every patch of the lattice within `within`, exactly. Outline and raster are cut at lattice
    /// lines and pixel edges. Calls `visit` for each row of patches with material, southernmost first. Returns what is
    /// wrong with the outline, if anything.
    OutlineFaults integrate(const Lattice& lattice, const Box& within, const VisitPatchRow& visit) const;

    /// Volume and area within `within` from the pixels and the outline alone (no lattice).
    MaterialTotals totals(const Box& within) const;

private:
    struct FineLines;
    double depth_in(double x, double y) const;
    bool outline_contains(double x, double y) const;
    void take_outline(const GridGeometry& grid);
    void take_raster(const GridGeometry& grid);
    void sort_edges_into_bands();
    FineLines fine_lines(const Lattice* lattice, const Box& within) const;
    OutlineFaults integrate_fine(const FineLines& fine, const VisitPatchRow& visit) const;

    const Release& release_;
    std::string name_;
    Reach reach_;
    Box domain_, box_, unclipped_box_;
    Rings rings_;
    double pixel_x0_ = 0.0, pixel_y0_ = 0.0, pixel_ = 0.0;  ///< lower left corner and edge of the pixels [m]

    /// Edges by horizontal band, for contains().
    std::vector<std::array<Vec2, 2>> edges_;
    std::vector<std::size_t> band_start_, band_edges_;
    double band_y0_ = 0.0, band_height_ = 1.0;
};

}  // namespace frana
