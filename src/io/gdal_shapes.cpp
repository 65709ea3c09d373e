#include "io/gdal_shapes.h"

#include <fmt/core.h>
#include <gdal_alg.h>

#include <algorithm>

#include "base/error.h"

namespace frana::gdal {

std::string Census::text() const {
    std::string words;
    const auto add = [&](Index n, const char* one, const char* many) {
        if (n > 0) words += fmt::format("{}{} {}", words.empty() ? "" : ", ", n, n == 1 ? one : many);
    };
    add(polygons, "polygon", "polygons");
    add(lines, "line", "lines");
    add(points, "point", "points");
    return words.empty() ? "nothing" : words;
}

bool degrees_possible(const OGREnvelope& e) {
    return e.MinX >= -360.0 && e.MaxX <= 360.0 && e.MinY >= -90.0 && e.MaxY <= 90.0;
}

std::vector<Vec2> vertices(const OGRSimpleCurve& curve, bool ring, const std::string& place) {
    std::vector<Vec2> points;
    points.reserve(std::size_t(curve.getNumPoints()));
    for (int k = 0; k < curve.getNumPoints(); ++k) {
        const Vec2 point(curve.getX(k), curve.getY(k));
        if (!point.allFinite())
            throw UserError(place + ": has a vertex that is no number; expected finite coordinates; draw it again");
        if (points.empty() || points.back() != point) points.push_back(point);
    }
    while (ring && points.size() > 1 && points.front() == points.back()) points.pop_back();
    return points;
}

void append_polygon(const OGRPolygon& polygon, const std::string& place, std::vector<Polygon>& parts) {
    if (polygon.IsEmpty()) return;
    Polygon part;
    for (const OGRLinearRing* ring : polygon) {
        std::vector<Vec2> points = vertices(*ring, true, place);
        if (points.size() >= 3)
            part.rings.push_back(std::move(points));
        else if (part.rings.empty())
            return;  // without an outer boundary there are no holes either
    }
    if (!part.rings.empty()) parts.push_back(std::move(part));
}

void collect_polygons(const OGRGeometry& geometry, Census& census, const std::function<void(const OGRPolygon&)>& use) {
    const OGRwkbGeometryType type = wkbFlatten(geometry.getGeometryType());
    if (type == wkbPolygon || type == wkbTriangle) {
        ++census.polygons;
        use(*geometry.toPolygon());
    } else if (OGR_GT_IsSubClassOf(type, wkbPolyhedralSurface)) {
        for (const OGRPolygon* part : *geometry.toPolyhedralSurface()) collect_polygons(*part, census, use);
    } else if (OGR_GT_IsSubClassOf(type, wkbGeometryCollection)) {
        for (const OGRGeometry* part : *geometry.toGeometryCollection()) collect_polygons(*part, census, use);
    } else {
        ++(type == wkbPoint ? census.points : census.lines);
    }
}

std::vector<std::unique_ptr<OGRPolygon>> outlines_of(std::vector<std::uint8_t>& mask, Index nx, Index ny,
                                                     const std::array<double, 6>& transform) {
    const Messages messages;
    GDALDriverManager& drivers = *GetGDALDriverManager();
    const Dataset raster(drivers.GetDriverByName("MEM")->Create("", int(nx), int(ny), 1, GDT_Byte, nullptr));
    const Dataset memory(drivers.GetDriverByName("Memory")->Create("", 0, 0, 0, GDT_Unknown, nullptr));
    expect(raster && memory, "datasets in memory");
    std::array<double, 6> place = transform;
    raster->SetGeoTransform(place.data());
    GDALRasterBand* band = raster->GetRasterBand(1);
    OGRLayer* layer = memory->CreateLayer("patches", nullptr, wkbPolygon, nullptr);
    const bool done = band->RasterIO(GF_Write, 0, 0, int(nx), int(ny), mask.data(), int(nx), int(ny), GDT_Byte, 0, 0,
                                     nullptr) == CE_None &&
                      GDALPolygonize(band, band, OGRLayer::ToHandle(layer), -1, nullptr, nullptr, nullptr) == CE_None;
    expect(done, "a mask becomes polygons");
    std::vector<std::unique_ptr<OGRPolygon>> polygons;
    for (const OGRFeatureUniquePtr& feature : *layer) polygons.emplace_back(feature->StealGeometry()->toPolygon());
    std::stable_sort(polygons.begin(), polygons.end(),
                     [](const auto& a, const auto& b) { return a->get_Area() > b->get_Area(); });
    return polygons;
}

}  // namespace frana::gdal
