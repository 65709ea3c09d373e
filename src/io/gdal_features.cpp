#include "io/gdal_features.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"
#include "io/gdal_crs.h"
#include "io/gdal_shapes.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void refuse(const fs::path& file, const gdal::Messages& messages) {
    throw UserError(fmt::format("{}: cannot be written ({}); check the folder, its permissions and free space",
                                file.string(), messages.reason("no reason given")));
}

/// GeoPackages carry the time of their making, unless GDAL is told one.
class WithoutDate {
public:
    WithoutDate() { CPLSetThreadLocalConfigOption("OGR_CURRENT_DATE", "2000-01-01T00:00:00.000Z"); }
    ~WithoutDate() { CPLSetThreadLocalConfigOption("OGR_CURRENT_DATE", nullptr); }
    WithoutDate(const WithoutDate&) = delete;
    WithoutDate& operator=(const WithoutDate&) = delete;
};

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
std::vector<FieldOfLayer> fields_of(const std::vector<AttributedPolygon>& polygons) {
    std::vector<FieldOfLayer> fields;
    for (const AttributedPolygon& polygon : polygons)
        for (const auto& attribute : polygon.attributes) {
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

OGRPolygon shape_of(const Polygon& polygon) {
    OGRPolygon shape;
    for (const auto& ring : polygon.rings) {
        OGRLinearRing line;
        for (const Vec2& v : ring) line.addPoint(v.x(), v.y());
        line.closeRings();
        shape.addRing(&line);
    }
    shape.flattenTo2D();
    return shape;
}

OGRLayer* make_layer(GDALDataset& dataset, const std::string& name, const std::string& crs_wkt,
                     const std::vector<FieldOfLayer>& fields) {
    OGRSpatialReference crs;
    if (crs_wkt.empty())
        crs.SetLocalCS("local metres");  // without any the file would claim degrees
    else
        crs = gdal::crs_from_wkt(crs_wkt);
    CPLStringList options;  // names that no attribute has
    options.SetNameValue("FID", "frana_feature");
    options.SetNameValue("GEOMETRY_NAME", "frana_polygon");
    OGRLayer* layer = dataset.CreateLayer(name.c_str(), &crs, wkbPolygon, options.List());
    for (const FieldOfLayer& field : fields) {
        OGRFieldDefn definition(field.name.c_str(), field.type);
        if (!layer || layer->CreateField(&definition) != OGRERR_NONE) return nullptr;
    }
    return layer;
}

bool fill(OGRLayer& layer, const std::vector<FieldOfLayer>& fields, const std::vector<AttributedPolygon>& polygons) {
    for (const AttributedPolygon& polygon : polygons) {
        const OGRFeatureUniquePtr feature(OGRFeature::CreateFeature(layer.GetLayerDefn()));
        for (const auto& attribute : polygon.attributes)
            for (std::size_t k = 0; k < fields.size(); ++k)
                if (lower(fields[k].name) == lower(attribute.first))
                    set_field(*feature, static_cast<int>(k), fields[k].type, attribute.second);
        const OGRPolygon shape = shape_of(polygon.polygon);
        feature->SetGeometry(&shape);
        if (layer.CreateFeature(feature.get()) != OGRERR_NONE) return false;
    }
    return true;
}

}  // namespace

void write_attributed_polygons(const fs::path& gpkg, const std::string& layer, const std::string& crs_wkt,
                               const std::vector<AttributedPolygon>& polygons) {
    gdal::register_drivers();
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GPKG");
    if (!driver) throw UserError(gpkg.string() + ": this GDAL cannot write GeoPackages; install one with SQLite");
    AtomicFile file(gpkg);
    const gdal::Messages messages;
    const WithoutDate same_bytes;
    const std::vector<FieldOfLayer> fields = fields_of(polygons);
    gdal::Dataset dataset(driver->Create(file.path().c_str(), 0, 0, 0, GDT_Unknown, nullptr));
    OGRLayer* made = dataset ? make_layer(*dataset, layer, crs_wkt, fields) : nullptr;
    if (!made || dataset->StartTransaction() != OGRERR_NONE) refuse(gpkg, messages);
    if (!fill(*made, fields, polygons) || dataset->CommitTransaction() != OGRERR_NONE) refuse(gpkg, messages);
    dataset.reset();
    if (messages.failed()) refuse(gpkg, messages);
    file.commit();
}

}  // namespace frana
