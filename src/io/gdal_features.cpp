#include "io/gdal_features.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"
#include "io/gdal_crs.h"
#include "io/gdal_date.h"
#include "io/gdal_shapes.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void refuse(const fs::path& file, const gdal::Messages& messages) {
    throw UserError(fmt::format("{}: cannot be written ({}); check the folder, its permissions and free space",
                                file.string(), messages.reason("no reason given")));
}

struct FieldOfLayer {
    std::string name;
    OGRFieldType type = OFTInteger64;
};

/// As SQL compares names.
std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
}

OGRFieldType type_of(const Attribute& value) {
    return std::holds_alternative<double>(value)      ? OFTReal
           : std::holds_alternative<long long>(value) ? OFTInteger64
                                                      : OFTString;
}

/// In the order in which they first come.
std::vector<FieldOfLayer> fields_of(const std::vector<AttributedShape>& shapes) {
    std::vector<FieldOfLayer> fields;
    for (const AttributedShape& shape : shapes)
        for (const auto& attribute : shape.attributes) {
            const std::string& name = attribute.first;
            const auto same = [&](const FieldOfLayer& field) { return lower(field.name) == lower(name); };
            const auto field = std::find_if(fields.begin(), fields.end(), same);
            const OGRFieldType type = type_of(attribute.second);
            if (field == fields.end())
                fields.push_back({name, type});
            else if (field->type != type)
                field->type = field->type == OFTString || type == OFTString ? OFTString : OFTReal;
        }
    return fields;
}

std::string text_of(const Attribute& value) {
    return std::visit([](const auto& held) { return fmt::format("{}", held); }, value);
}

void set_field(OGRFeature& feature, int index, OGRFieldType type, const Attribute& value) {
    const auto* whole = std::get_if<long long>(&value);
    const auto* real = std::get_if<double>(&value);
    if (type == OFTString) {
        feature.SetField(index, text_of(value).c_str());
    } else if (type == OFTInteger64) {
        feature.SetField(index, static_cast<GIntBig>(*whole));
    } else {
        const double number = real ? *real : static_cast<double>(*whole);
        if (std::isfinite(number)) feature.SetField(index, number);
    }
}

std::unique_ptr<OGRGeometry> geometry_of(const Polygon& polygon) {
    auto shape = std::make_unique<OGRPolygon>();
    for (const auto& ring : polygon.rings) {
        OGRLinearRing line;
        for (const Vec2& v : ring) line.addPoint(v.x(), v.y());
        line.closeRings();
        shape->addRing(&line);
    }
    shape->flattenTo2D();
    return shape;
}

std::unique_ptr<OGRGeometry> geometry_of(const Polygons& polygons) {
    auto shape = std::make_unique<OGRMultiPolygon>();
    for (const Polygon& part : polygons.parts) shape->addGeometryDirectly(geometry_of(part).release());
    return shape;
}

std::unique_ptr<OGRGeometry> geometry_of(const Polyline& line) {
    auto shape = std::make_unique<OGRLineString>();
    for (const Vec2& v : line) shape->addPoint(v.x(), v.y());
    shape->flattenTo2D();
    return shape;
}

std::unique_ptr<OGRGeometry> geometry_of(const Vec2& place) { return std::make_unique<OGRPoint>(place.x(), place.y()); }

/// What shapes are called, and their type, by their place in the variant.
struct KindOfShape {
    const char* column;  ///< a name that no attribute has
    OGRwkbGeometryType type;
};
constexpr KindOfShape kKinds[] = {{"frana_polygon", wkbPolygon},
                                  {"frana_line", wkbLineString},
                                  {"frana_point", wkbPoint},
                                  {"frana_polygon", wkbMultiPolygon}};
static_assert(std::size(kKinds) == std::variant_size_v<decltype(AttributedShape::shape)>, "one for each kind");

/// Of the shapes of a layer: several polygons where one of them is.
const KindOfShape& kind_of(const std::vector<AttributedShape>& shapes) {
    std::size_t kind = 0;
    for (const AttributedShape& shape : shapes) kind = std::max(kind, shape.shape.index());
    return kKinds[kind];
}

OGRLayer* make_layer(GDALDataset& dataset, const ShapeLayer& shapes, const std::string& crs_wkt,
                     const std::vector<FieldOfLayer>& fields) {
    OGRSpatialReference crs;
    if (crs_wkt.empty())
        crs.SetLocalCS("local metres");  // without any the file would claim degrees
    else
        crs = gdal::crs_from_wkt(crs_wkt);
    const KindOfShape& kind = kind_of(shapes.shapes);
    CPLStringList options;
    options.SetNameValue("FID", "frana_feature");
    options.SetNameValue("GEOMETRY_NAME", kind.column);
    OGRLayer* layer = dataset.CreateLayer(shapes.name.c_str(), &crs, kind.type, options.List());
    for (const FieldOfLayer& field : fields) {
        OGRFieldDefn definition(field.name.c_str(), field.type);
        if (!layer || layer->CreateField(&definition) != OGRERR_NONE) return nullptr;
    }
    return layer;
}

bool fill(OGRLayer& layer, const std::vector<FieldOfLayer>& fields, const std::vector<AttributedShape>& shapes) {
    for (const AttributedShape& shape : shapes) {
        const OGRFeatureUniquePtr feature(OGRFeature::CreateFeature(layer.GetLayerDefn()));
        for (const auto& attribute : shape.attributes)
            for (std::size_t k = 0; k < fields.size(); ++k)
                if (lower(fields[k].name) == lower(attribute.first))
                    set_field(*feature, static_cast<int>(k), fields[k].type, attribute.second);
        auto geometry = std::visit([](const auto& held) { return geometry_of(held); }, shape.shape);
        if (layer.GetGeomType() == wkbMultiPolygon)
            geometry.reset(OGRGeometryFactory::forceToMultiPolygon(geometry.release()));
        feature->SetGeometry(geometry.get());
        if (layer.CreateFeature(feature.get()) != OGRERR_NONE) return false;
    }
    return true;
}

}  // namespace

std::vector<AttributedShape> pixel_outlines(const GridGeometry& grid, std::vector<std::uint8_t> inside) {
    gdal::register_drivers();
    const auto extent = grid.pixel_extent();
    std::vector<AttributedShape> shapes;
    const double pixel = grid.cell * grid.cell;
    for (const auto& outline :
         gdal::outlines_of(inside, grid.nx, grid.ny, {extent[0], grid.cell, 0.0, extent[1], 0.0, grid.cell})) {
        std::vector<Polygon> parts;
        gdal::append_polygon(*outline, "an outline of pixels", parts);
        const double area = std::round(outline->get_Area() / pixel) * pixel;  // whole pixels
        for (Polygon& part : parts) shapes.push_back({std::move(part), {{"area_m2", area}}});
    }
    return shapes;
}

void write_layers(const fs::path& gpkg, const std::string& crs_wkt, const std::vector<ShapeLayer>& layers) {
    gdal::register_drivers();
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GPKG");
    if (!driver) throw UserError(gpkg.string() + ": this GDAL cannot write GeoPackages; install one with SQLite");
    AtomicFile file(gpkg);
    const gdal::Messages messages;
    const gdal::WithoutDate same_bytes;
    gdal::Dataset dataset(driver->Create(file.path().c_str(), 0, 0, 0, GDT_Unknown, nullptr));
    if (!dataset) refuse(gpkg, messages);
    for (const ShapeLayer& layer : layers) {
        if (layer.shapes.empty()) continue;
        const std::vector<FieldOfLayer> fields = fields_of(layer.shapes);
        OGRLayer* made = make_layer(*dataset, layer, crs_wkt, fields);
        if (!made || dataset->StartTransaction() != OGRERR_NONE) refuse(gpkg, messages);
        if (!fill(*made, fields, layer.shapes) || dataset->CommitTransaction() != OGRERR_NONE) refuse(gpkg, messages);
    }
    dataset.reset();
    if (messages.failed()) refuse(gpkg, messages);
    file.commit();
}

}  // namespace frana
