#include "vtk_io/figures/map_figure_piece.h"

#include <algorithm>
#include <cmath>

#include "vtk_io/figures/map_figure_layout.h"

namespace frana {

MapBox block_of(const PerspectiveFigure& figure) {
    const GridGeometry& g = figure.bed.geometry;
    const MapBox all{g.x0, g.y0, g.x_max(), g.y_max()};
    auto covered = figure.focus ? figure.focus : covered_extent(g, figure.outlined(), figure.shown_above);
    if (!covered || (figure.eye && !figure.focus)) return all;
    MapBox box = *covered;
    if (!figure.focus) {
        if (figure.survey && !figure.survey->parts.empty()) box = united(box, extent_of(*figure.survey));
        const double margin = 0.22 * std::max(box[2] - box[0], box[3] - box[1]);
        for (std::size_t k = 0; k < 2; ++k) {
            const double wanted = std::max(box[k + 2] - box[k] + 2.0 * margin, 0.4 * (all[k + 2] - all[k]));
            const double middle = 0.5 * (box[k] + box[k + 2]);
            box[k] = middle - 0.5 * wanted;
            box[k + 2] = middle + 0.5 * wanted;
        }
    }
    for (std::size_t k = 0; k < 2; ++k) {
        box[k] = std::max(box[k], all[k]);
        box[k + 2] = std::min(box[k + 2], all[k + 2]);
        if (!(box[k] < box[k + 2])) box[k] = all[k], box[k + 2] = all[k + 2];
    }
    return box;
}

GridGeometry block_grid(const MapBox& box, double along) {
    const double w = box[2] - box[0], h = box[3] - box[1];
    GridGeometry grid;
    grid.cell = std::max(w, h) / (along - 1.0);
    grid.nx = std::max<Index>(2, static_cast<Index>(w / grid.cell + 1e-6) + 1);
    grid.ny = std::max<Index>(2, static_cast<Index>(h / grid.cell + 1e-6) + 1);
    grid.x0 = box[0];
    grid.y0 = box[1];
    return grid;
}

double uphill_azimuth(const Raster& bed, const Raster& field, double shown_above) {
    Vec2 shown(0, 0), all(0, 0);
    const GridGeometry& g = bed.geometry;
    for (Index j = 0; j + 1 < g.ny; ++j)
        for (Index i = 0; i + 1 < g.nx; ++i) {
            const Vec2 up(bed.at(i + 1, j) - bed.at(i, j), bed.at(i, j + 1) - bed.at(i, j));
            if (!up.allFinite()) continue;
            all += up;
            if (std::abs(field.at(i, j)) > shown_above) shown += up;
        }
    const Vec2 up = shown.norm() > 0.0 ? shown : all;
    return up.norm() > 0.0 ? std::atan2(up.x(), up.y()) : 0.0;
}

}  // namespace frana
