#include "vtk_io/level_lines.h"

#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkFlyingEdges2D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkStripper.h>

#include <algorithm>
#include <cmath>

namespace frana {
namespace {

/// The raster as an image that borrows its values, in node numbers.
vtkSmartPointer<vtkImageData> as_image(const Raster& raster) {
    auto image = vtkSmartPointer<vtkImageData>::New();
    image->SetDimensions(static_cast<int>(raster.geometry.nx), static_cast<int>(raster.geometry.ny), 1);
    vtkNew<vtkDoubleArray> values;
    values->SetArray(const_cast<double*>(raster.values.data()), raster.geometry.size(), 1);  // 1: not owned
    image->GetPointData()->SetScalars(values);
    return image;
}

/// Adds the line to the result, broken at points that are not finite.
void add_finite(const std::vector<Vec2>& line, std::vector<Polyline>& result) {
    Polyline piece;
    for (const Vec2& point : line) {
        if (point.allFinite()) {
            piece.push_back(point);
            continue;
        }
        if (piece.size() > 1) result.push_back(piece);
        piece.clear();
    }
    if (piece.size() > 1) result.push_back(piece);
}

/// Distance along the line up to each of its points.
std::vector<double> arc_lengths(const std::vector<Vec2>& line) {
    std::vector<double> arc{0.0};
    for (std::size_t i = 1; i < line.size(); ++i) arc.push_back(arc.back() + (line[i] - line[i - 1]).norm());
    return arc;
}

Vec2 point_at(const std::vector<Vec2>& line, const std::vector<double>& arc, double s) {
    const auto next = std::upper_bound(arc.begin() + 1, arc.end() - 1, s);
    const auto i = static_cast<std::size_t>(next - arc.begin());
    const double length = arc[i] - arc[i - 1];
    const double t = length > 0.0 ? std::clamp((s - arc[i - 1]) / length, 0.0, 1.0) : 0.0;
    return line[i - 1] + t * (line[i] - line[i - 1]);
}

/// The stretch of the line between two distances.
std::vector<Vec2> part_of(const std::vector<Vec2>& line, const std::vector<double>& arc, double from, double to) {
    std::vector<Vec2> part{point_at(line, arc, from)};
    for (std::size_t i = 0; i < line.size(); ++i)
        if (arc[i] > from && arc[i] < to) part.push_back(line[i]);
    part.push_back(point_at(line, arc, to));
    return part;
}

}  // namespace

std::vector<Polyline> level_lines(const Raster& raster, double level) {
    std::vector<Polyline> result;
    if (raster.geometry.nx < 2 || raster.geometry.ny < 2) return result;
    vtkNew<vtkFlyingEdges2D> contour;
    contour->SetInputData(as_image(raster));
    contour->SetValue(0, level);
    vtkNew<vtkStripper> joined;
    joined->SetInputConnection(contour->GetOutputPort());
    joined->JoinContiguousSegmentsOn();
    joined->SetMaximumLength(100000);
    joined->Update();
    vtkPolyData* lines = joined->GetOutput();
    vtkNew<vtkIdList> cell;
    const GridGeometry& g = raster.geometry;
    for (lines->GetLines()->InitTraversal(); lines->GetLines()->GetNextCell(cell);) {
        std::vector<Vec2> line;
        for (vtkIdType k = 0; k < cell->GetNumberOfIds(); ++k) {
            const double* p = lines->GetPoint(cell->GetId(k));
            line.emplace_back(g.x0 + p[0] * g.cell, g.y0 + p[1] * g.cell);
        }
        add_finite(line, result);
    }
    return result;
}

LabelledLine with_label(const std::vector<Vec2>& line, double label_width,
                        const std::function<bool(const Vec2&)>& free) {
    LabelledLine result;
    result.pieces = {line};
    const auto arc = arc_lengths(line);
    const double gap = label_width;
    double best_straightness = 0.95, best = -1.0;  // below, the label would stray from its line
    for (double s = gap; s + gap < arc.back(); s += 0.25 * gap) {
        const Vec2 chord = point_at(line, arc, s + 0.5 * gap) - point_at(line, arc, s - 0.5 * gap);
        const double straightness = chord.norm() / gap;
        if (straightness <= best_straightness || !free(point_at(line, arc, s))) continue;
        best_straightness = straightness;
        best = s;
    }
    if (best < 0.0) return result;
    const Vec2 chord = point_at(line, arc, best + 0.5 * gap) - point_at(line, arc, best - 0.5 * gap);
    result.angle = std::atan2(chord.y(), chord.x()) * 57.29577951308232;
    if (result.angle > 90.0) result.angle -= 180.0;
    if (result.angle <= -90.0) result.angle += 180.0;
    result.labelled = true;
    result.at = point_at(line, arc, best);
    result.pieces = {part_of(line, arc, 0.0, best - 0.5 * gap), part_of(line, arc, best + 0.5 * gap, arc.back())};
    return result;
}

}  // namespace frana
