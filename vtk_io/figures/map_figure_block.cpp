#include "vtk_io/figures/map_figure_block.h"

#include <vtkActor.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkTexture.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "terrain/places.h"

namespace frana {
namespace {

vtkSmartPointer<vtkTexture> as_texture(const Pixels& picture) {
    vtkNew<vtkImageData> image;
    image->SetDimensions(picture.width, picture.height, 1);
    image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
    std::memcpy(image->GetScalarPointer(), picture.rgb.data(), picture.rgb.size());
    auto texture = vtkSmartPointer<vtkTexture>::New();
    texture->SetInputData(image);
    texture->InterpolateOn();
    texture->MipmapOn();
    texture->SetColorModeToDirectScalars();
    return texture;
}

/// Linear between the nodes; NaN outside or next to a NaN node.
double height_at(const Raster& surface, const Vec2& p) {
    return between_nodes(surface.geometry, p) ? NodeSquare(surface.geometry, p).value(surface) : Raster::nodata;
}

/// The line with points no further apart than `step` [m].
Polyline dense(const Polyline& line, double step) {
    Polyline result;
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
        const Vec2 d = line[i + 1] - line[i];
        const int parts = std::max(1, static_cast<int>(std::ceil(d.norm() / step)));
        for (int k = 0; k < parts; ++k) result.emplace_back(line[i] + d * (static_cast<double>(k) / parts));
    }
    if (!line.empty()) result.push_back(line.back());
    return result;
}

void add_strip(vtkCellArray* cells, const std::vector<vtkIdType>& ids) {
    if (ids.size() > 1) cells->InsertNextCell(static_cast<vtkIdType>(ids.size()), ids.data());
}

}  // namespace

vtkSmartPointer<vtkActor> unlit_actor(vtkPolyData* data) {
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(data);
    auto actor = vtkSmartPointer<vtkActor>::New();
    actor->SetMapper(mapper);
    actor->GetProperty()->LightingOff();
    return actor;
}

vtkSmartPointer<vtkActor> skin_actor(const Raster& surface, const Pixels& picture, const Vec2& origin) {
    const GridGeometry& g = surface.geometry;
    vtkNew<vtkPoints> points;
    vtkNew<vtkFloatArray> places;
    places->SetNumberOfComponents(2);
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) {
            const double z = surface.at(i, j);
            points->InsertNextPoint(g.x(i) - origin.x(), g.y(j) - origin.y(), std::isnan(z) ? 0.0 : z);
            places->InsertNextTuple2(static_cast<double>(i) / static_cast<double>(g.nx - 1),
                                     static_cast<double>(j) / static_cast<double>(g.ny - 1));
        }
    vtkNew<vtkCellArray> cells;
    for (Index j = 0; j + 1 < g.ny; ++j)
        for (Index i = 0; i + 1 < g.nx; ++i) {
            const vtkIdType a = j * g.nx + i, b = a + g.nx;
            const double corners =
                surface.at(i, j) + surface.at(i + 1, j) + surface.at(i, j + 1) + surface.at(i + 1, j + 1);
            if (std::isnan(corners)) continue;
            cells->InsertNextCell({a, a + 1, b + 1});
            cells->InsertNextCell({a, b + 1, b});
        }
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    data->SetPolys(cells);
    data->GetPointData()->SetTCoords(places);
    auto actor = unlit_actor(data);
    actor->SetTexture(as_texture(picture));
    return actor;
}

vtkSmartPointer<vtkActor> wall_actor(const Raster& surface, double foot, const Vec2& origin) {
    const GridGeometry& g = surface.geometry;
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> cells;
    vtkNew<vtkUnsignedCharArray> colours;
    colours->SetNumberOfComponents(3);
    const auto side = [&](Index count, const auto& node, unsigned char grey) {
        for (Index k = 0; k + 1 < count; ++k) {
            const auto [i0, j0] = node(k);
            const auto [i1, j1] = node(k + 1);
            const double z0 = surface.at(i0, j0), z1 = surface.at(i1, j1);
            if (std::isnan(z0 + z1)) continue;
            const Vec2 a = Vec2(g.x(i0), g.y(j0)) - origin, b = Vec2(g.x(i1), g.y(j1)) - origin;
            const std::array<vtkIdType, 4> ids{
                points->InsertNextPoint(a.x(), a.y(), foot), points->InsertNextPoint(b.x(), b.y(), foot),
                points->InsertNextPoint(b.x(), b.y(), z1), points->InsertNextPoint(a.x(), a.y(), z0)};
            cells->InsertNextCell(4, ids.data());
            colours->InsertNextTuple3(grey, grey, grey);
        }
    };
    using Node = std::pair<Index, Index>;
    side(
        g.nx,
        [&](Index k) {
            return Node{k, 0};
        },
        176);
    side(
        g.nx,
        [&](Index k) {
            return Node{k, g.ny - 1};
        },
        176);
    side(
        g.ny,
        [&](Index k) {
            return Node{0, k};
        },
        200);
    side(
        g.ny,
        [&](Index k) {
            return Node{g.nx - 1, k};
        },
        152);
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    data->SetPolys(cells);
    data->GetCellData()->SetScalars(colours);
    return unlit_actor(data);
}

vtkSmartPointer<vtkActor> draped_actor(const std::vector<Polyline>& lines, const Raster& surface, double lift,
                                       const Vec2& origin, const Colour& colour, double width) {
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> cells;
    for (const Polyline& line : lines) {
        std::vector<vtkIdType> strip;
        for (const Vec2& p : dense(line, surface.geometry.cell)) {
            const double z = height_at(surface, p);
            if (std::isnan(z)) {
                add_strip(cells, strip);
                strip.clear();
            } else {
                strip.push_back(points->InsertNextPoint(p.x() - origin.x(), p.y() - origin.y(), z + lift));
            }
        }
        add_strip(cells, strip);
    }
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    data->SetLines(cells);
    auto actor = unlit_actor(data);
    actor->GetProperty()->SetColor(colour.r / 255.0, colour.g / 255.0, colour.b / 255.0);
    actor->GetProperty()->SetOpacity(colour.a / 255.0);
    actor->GetProperty()->SetLineWidth(static_cast<float>(width));
    return actor;
}

}  // namespace frana
