#pragma once
// Exact area of polygons in every cell of a rectilinear grid, row by row.
#include <utility>
#include <vector>

#include "base/types.h"
#include "terrain/raster.h"

namespace frana {

/// Rings of an outline: outer ones counter-clockwise, holes clockwise, not closed.
using Rings = std::vector<std::vector<Vec2>>;

/// Twice-counted and negative area met so far; both are zero for a valid outline.
struct OutlineFaults {
    double overlap = 0.0;    ///< area covered more than once [m^2]; row() counts it once
    double negative = 0.0;   ///< area enclosed the wrong way round (crossing ring, hole outside) [m^2]
    Vec2 negative_at{0, 0};  ///< a cell where that happens
};

/// Area of the rings in each cell of the grid of lines x_lines x y_lines (ascending). Every edge is cut at
/// the lines it crosses. Each piece adds the trapezium between itself and the right side of its cell. It adds its
/// height to all cells further right. This is the signed-area accumulation of scanline font rasterisers. Cost: edge
/// crossings plus cells between the leftmost and the rightmost crossing of a row.
class OutlineArea {
public:
    OutlineArea(const Rings& rings, std::vector<double> x_lines, std::vector<double> y_lines);

    /// Fills area[i] [m^2] for the columns i in [first, second) and returns that range; the other columns
    /// have none. `area` holds one number per column. Cells that differ from full or empty by round-off only
    /// are made so.
    std::pair<Index, Index> row(Index j, std::vector<double>& area);
    const OutlineFaults& faults() const { return faults_; }

private:
    struct Piece {
        Index row, column;
        double height;  ///< signed height, positive where material begins to its right [m]
        double area;    ///< signed area between the piece and the right side of its cell [m^2]
    };
    void add_edge(const Vec2& a, const Vec2& b);
    void add_piece(Index row, double xa, double ya, double xb, double yb, double sign);
    void record(Index row, Index column, double height, double mean_x);
    void sort_by_row();
    double checked(double area, double cell, Index i, Index j, double tolerance);

    std::vector<double> x_, y_;
    std::vector<Piece> pieces_;
    std::vector<std::size_t> row_start_;
    std::vector<double> height_;
    double tolerance_ = 0.0;  ///< heights below this are round-off of the coordinates [m]
    OutlineFaults faults_;
};

/// Rings of polygons, counted from a place. Those of fewer than three corners are left out.
Rings rings_of(const Polygons& polygons, const Vec2& origin);

/// Signed area of a ring, positive when counter-clockwise [m^2].
double ring_area(const std::vector<Vec2>& ring);

}  // namespace frana
