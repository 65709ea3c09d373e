// Outlines and lines from vector files.
#include <fmt/core.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "fresh_folder.h"
#include "io/gdal_reader.h"
#include "io/gdal_support.h"
#include "io_gdal_make.h"

#include "catch.h"

using namespace frana;

namespace {

std::string crs_member(const char* code) {
    return std::string(R"("crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::)") + code + "\"}},";
}

std::string feature(const std::string& type, const std::string& coordinates) {
    return R"({"type":"Feature","properties":{},"geometry":{"type":")" + type + R"(","coordinates":)" + coordinates +
           "}}";
}

class GeoJson {
public:
    /// Writes a collection of the features, given with commas between them.
    std::filesystem::path write(const std::string& features, const std::string& crs = "") {
        const auto file = folder_.path() / "outline.geojson";
        std::ofstream(file) << R"({"type":"FeatureCollection",)" << crs << R"("features":[)" << features << "]}";
        return file;
    }
    std::filesystem::path path(const char* name) const { return folder_.path() / name; }

private:
    FreshFolder folder_;
};

struct Read {
    Polygons polygons;
    std::vector<std::string> log;
};

Read read(const std::filesystem::path& file, const std::string& crs_wkt = "") {
    Read out;
    out.polygons = GdalReader().read_polygons(file, crs_wkt, out.log);
    return out;
}

double signed_area(const std::vector<Vec2>& ring) {
    double twice = 0.0;
    for (std::size_t k = 0; k < ring.size(); ++k) {
        const Vec2& a = ring[k];
        const Vec2& b = ring[(k + 1) % ring.size()];
        twice += a.x() * b.y() - b.x() * a.y();
    }
    return 0.5 * twice;
}

double area(const Polygons& polygons) {
    double sum = 0.0;
    for (const Polygon& part : polygons.parts)
        for (std::size_t k = 0; k < part.rings.size(); ++k)
            sum += (k == 0 ? 1.0 : -1.0) * std::abs(signed_area(part.rings[k]));
    return sum;
}

const char* const square = "[[[0,0],[10,0],[10,10],[0,10],[0,0]]]";
const char* const square_with_hole = "[[[0,0],[10,0],[10,10],[0,10],[0,0]],[[2,2],[2,5],[5,5],[5,2],[2,2]]]";

}  // namespace

TEST_CASE("A polygon keeps its holes, and its rings are not closed", "[gdal]") {
    GeoJson json;
    const Polygons polygons = read(json.write(feature("Polygon", square_with_hole))).polygons;
    REQUIRE(polygons.parts.size() == 1);
    REQUIRE(polygons.parts[0].rings.size() == 2);
    CHECK(polygons.parts[0].rings[0].size() == 4);
    CHECK(polygons.parts[0].rings[1].size() == 4);
    CHECK(area(polygons) == 91.0);
}

TEST_CASE("Multipolygons, collections and several features are flattened, Z is dropped", "[gdal]") {
    GeoJson json;
    const std::string multi =
        feature("MultiPolygon", "[[[[0,0],[1,0],[1,1],[0,1],[0,0]]],[[[5,5,9],[7,5,9],[7,7,9],[5,7,9],[5,5,9]]]]");
    const std::string collection =
        R"({"type":"Feature","properties":{},"geometry":{"type":"GeometryCollection","geometries":[)"
        R"({"type":"Point","coordinates":[0,0]},)"
        R"({"type":"Polygon","coordinates":[[[20,0],[23,0],[23,3],[20,3],[20,0]]]}]}})";
    const auto out = read(json.write(multi + "," + collection + "," + feature("Polygon", square_with_hole)));
    CHECK(out.polygons.parts.size() == 4);
    CHECK(area(out.polygons) == 1.0 + 4.0 + 9.0 + 91.0);
    CHECK(any_contains(out.log, "4 polygons, 1 point"));
}

TEST_CASE("A GeoPackage with two layers is read by the layer that is named; curves become chords", "[gdal]") {
    GeoJson folder;
    GDALAllRegister();
    const auto file = folder.path("outlines.gpkg");
    {
        const gdal::Dataset made(
            GetGDALDriverManager()->GetDriverByName("GPKG")->Create(file.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
        REQUIRE(made);
        OGRSpatialReference crs;
        crs.importFromEPSG(32632);
        const char* const shapes[] = {"POLYGON ((0 0,10 0,10 10,0 10,0 0))",
                                      "CURVEPOLYGON (CIRCULARSTRING (100 0,110 10,100 20,90 10,100 0))"};
        for (int k = 0; k < 2; ++k) {
            OGRLayer* layer = made->CreateLayer(k ? "round" : "square", &crs, wkbUnknown, nullptr);
            OGRGeometry* geometry = nullptr;
            REQUIRE(OGRGeometryFactory::createFromWkt(shapes[k], nullptr, &geometry) == OGRERR_NONE);
            const OGRFeatureUniquePtr one(OGRFeature::CreateFeature(layer->GetLayerDefn()));
            one->SetGeometryDirectly(geometry);
            REQUIRE(layer->CreateFeature(one.get()) == OGRERR_NONE);
        }
    }
    const auto of = [&](const std::string& layer) {
        return read(file.string() + (layer.empty() ? "" : "|layername=" + layer), wkt_of("EPSG:32632"));
    };
    CHECK(area(of("square").polygons) == 100.0);
    CHECK(area(of("round").polygons) == Approx(3.14159265 * 100.0).epsilon(1e-3));  // chords of 4 degrees
    CHECK_FALSE(any_contains(of("round").log, "reprojected"));
    const std::string message = user_error([&] { of(""); });
    CHECK(contains(message,
                   "outlines.gpkg: has 2 layers (\"square\", \"round\"); expected one, or its name; give "
                   "outlines.gpkg|layername=square"));
    CHECK(contains(user_error([&] { of("oval"); }),
                   "no layer \"oval\" with features; expected one of \"square\", \"round\""));
}

TEST_CASE("Of a source with a filter, as QGIS writes it, only the features of the filter are read", "[gdal]") {
    GeoJson folder;
    const auto of_kind = [](int kind, int x) {
        return fmt::format(
            R"({{"type":"Feature","properties":{{"kind":{}}},"geometry":{{"type":"Polygon","coordinates":)"
            "[[[{},0],[{},0],[{},10],[{},0]]]}}}}",
            kind, x, x + 10, x + 10, x);
    };
    const std::string file = folder.write(of_kind(1, 0) + "," + of_kind(2, 20) + "," + of_kind(2, 40)).string();
    CHECK(area(read(file).polygons) == 150.0);
    CHECK(area(read(file + "|layername=outline|subset=\"kind\" = 2").polygons) == 100.0);
    CHECK(area(read(file + "|subset=\"kind\" = 1").polygons) == 50.0);
    CHECK(area(read(file + "|subset=\"kind\" = 1 OR 'a|b' = 'c'").polygons) == 50.0);
    CHECK(contains(
        user_error([&] { read(file + "|subset=\"kind\" = 3"); }),
        "holds no features of its filter \"\"kind\" = 3\"; expected at least one polygon; correct the filter"));
    CHECK(contains(user_error([&] { read(file + "|subset=\"kind\" = = 3"); }),
                   "its filter \"\"kind\" = = 3\" cannot be used ("));
    CHECK(
        contains(user_error([&] { read(file + "|layername=outline|geometrytype=Polygon"); }),
                 "outline.geojson: found \"|geometrytype=Polygon\" after the layer's name; expected |subset=FILTER or "
                 "nothing; remove it"));
}

TEST_CASE("Longitude and latitude are brought to the terrain's UTM zone within a millimetre", "[gdal]") {
    GeoJson json;
    const std::vector<Vec2> degrees = {{7.26, 61.96}, {7.29, 61.96}, {7.29, 61.98}, {7.26, 61.98}};
    std::string ring;
    for (const std::size_t k : {0, 1, 2, 3, 0})
        ring += (ring.empty() ? "" : ",") + fmt::format("[{},{}]", degrees[k].x(), degrees[k].y());
    const auto out = read(json.write(feature("Polygon", "[[" + ring + "]]")), wkt_of("EPSG:32632"));
    CHECK(any_contains(out.log, "reprojected from EPSG:4326"));
    const std::vector<Vec2>& map = out.polygons.parts.at(0).rings.at(0);
    REQUIRE(map.size() == 4);
    CHECK(map[0].x() > 408000.0);  // Ryggfonn: not swapped, not in another zone
    CHECK(map[0].x() < 412000.0);

    OGRSpatialReference from, to;
    from.importFromEPSG(32632);
    to.importFromEPSG(4326);
    to.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    const gdal::Transformation back(OGRCreateCoordinateTransformation(&from, &to));
    for (std::size_t k = 0; k < 4; ++k) {
        double x = map[k].x(), y = map[k].y();
        REQUIRE(back->Transform(1, &x, &y));
        CHECK(std::abs(y - degrees[k].y()) * 111e3 < 1e-3);  // [m]
        CHECK(std::abs(x - degrees[k].x()) * 53e3 < 1e-3);
    }
}

TEST_CASE("A legacy crs member is honoured: zone 33 comes out in zone 32", "[gdal]") {
    GeoJson json;
    const auto out =
        read(json.write(feature("Polygon", "[[[100000,6880000],[101000,6880000],[101000,6881000],[100000,6880000]]]"),
                        crs_member("32633")),
             wkt_of("EPSG:32632"));
    CHECK(any_contains(out.log, "reprojected from EPSG:32633"));
    CHECK(area(out.polygons) == Approx(5e5).epsilon(5e-3));  // scales of the two projections
    CHECK(out.polygons.parts[0].rings[0][0].x() > 400000.0);
    const auto same = read(json.path("outline.geojson"), wkt_of("EPSG:32633"));
    CHECK(same.polygons.parts[0].rings[0][0] == Vec2(100000, 6880000));
    CHECK_FALSE(any_contains(same.log, "reprojected"));
}

TEST_CASE("Plain coordinates without a crs member are the terrain's own when they are no degrees", "[gdal]") {
    GeoJson json;
    const auto file =
        json.write(feature("Polygon", "[[[409000,6871000],[409100,6871000],[409100,6871100],[409000,6871000]]]"));
    const auto out = read(file, wkt_of("EPSG:32632"));
    CHECK(out.polygons.parts[0].rings[0][0] == Vec2(409000, 6871000));
    CHECK(any_contains(out.log, "terrain's own, since they are no degrees"));
}

TEST_CASE("On a terrain without CRS every outline's coordinates are the terrain's own", "[gdal]") {
    GeoJson json;
    auto out = read(json.write(feature("Polygon", square)));
    CHECK(area(out.polygons) == 100.0);
    CHECK(any_contains(out.log, "the terrain has no CRS"));
    out = read(json.write(feature("Polygon", square), crs_member("32632")));
    CHECK(area(out.polygons) == 100.0);
    CHECK(any_contains(out.log, "EPSG:32632"));
}

TEST_CASE("An outline that crosses itself is repaired to the area it draws, and named in the log", "[gdal]") {
    GeoJson json;
    std::string noise;
    Read out;
    const auto file = json.write(feature("Polygon", "[[[0,0],[10,10],[10,0],[0,10],[0,0]]]"));
    noise = heard_on_stderr([&] { out = read(file); });
    CHECK(noise == "");
    CHECK(out.polygons.parts.size() == 2);
    CHECK(area(out.polygons) == Approx(50.0));
    CHECK(any_contains(out.log, "Self-intersection"));
}

TEST_CASE("Polygons come with the numbers of an attribute, and one without its number is refused", "[gdal]") {
    GeoJson json;
    const auto with = [](const std::string& properties, const std::string& type, const std::string& coordinates) {
        std::string text = feature(type, coordinates);
        return text.replace(text.find("{}"), 2, "{" + properties + "}");
    };
    const std::string two = "[[[[20,0],[21,0],[21,1],[20,0]]],[[[30,0],[31,0],[31,1],[30,0]]]]";
    const auto valued = [&](const std::string& features) {
        std::vector<std::string> log;
        return GdalReader().read_valued_polygons(json.write(features), "thickness_m", "", log).values;
    };
    CHECK(valued(with(R"("thickness_m":2)", "Polygon", square) + "," +
                 with(R"("thickness_m":1.5,"name":"scar")", "MultiPolygon", two)) ==
          std::vector<double>{2.0, 1.5, 1.5});
    CHECK(contains(user_error([&] { valued(with(R"("depth":2,"name":"a")", "Polygon", square)); }),
                   "has no attribute \"thickness_m\"; expected one of \"depth\", \"name\""));
    CHECK(contains(user_error([&] { valued(with(R"("thickness_m":"2 m")", "Polygon", square)); }),
                   "its attribute \"thickness_m\" holds String; expected numbers"));
    CHECK(contains(user_error([&] {
                       valued(with(R"("thickness_m":2)", "Polygon", square) + "," +
                              with(R"("thickness_m":null)", "Polygon", square));
                   }),
                   "feature 1 has no \"thickness_m\"; expected a number for each feature"));
}

TEST_CASE("Features without a geometry are refused by their numbers", "[gdal]") {
    GeoJson json;
    const std::string none = R"({"type":"Feature","properties":{},"geometry":null})";
    const auto message = [&](const std::string& features) { return user_error([&] { read(json.write(features)); }); };
    CHECK(contains(message(feature("Polygon", square) + "," + none),
                   "outline.geojson: 1 feature has no geometry (feature 1); expected one in each"));
    CHECK(contains(message(none + "," + feature("Polygon", square) + "," + none),
                   "2 features have no geometry (feature 0, 2)"));
}

TEST_CASE("Files without an outline are refused with what they hold", "[gdal]") {
    GeoJson json;
    const auto refusal = [&](const std::string& features) {
        const auto file = json.write(features);
        std::string message;
        const std::string noise = heard_on_stderr([&] { message = user_error([&] { read(file); }); });
        CHECK(noise == "");
        CHECK_FALSE(contains(message, "\n"));
        CHECK(contains(message, "outline.geojson"));
        return message;
    };
    CHECK(contains(refusal(""), "no features"));
    CHECK(contains(refusal(feature("Point", "[1,2]") + "," + feature("MultiPoint", "[[1,2],[3,4]]")), "3 points only"));
    CHECK(contains(refusal(feature("LineString", "[[1,2],[3,4]]")), "1 line only"));
    CHECK(contains(refusal(feature("Polygon", "[[[0,0],[10,0],[20,0],[0,0]]]")), "encloses no area"));
    CHECK(contains(refusal(feature("Polygon", "[[[0,0],[10,0]")), "cannot be opened"));
    CHECK(contains(user_error([&] { read(json.path("nowhere.geojson")); }), "no such file"));
}

TEST_CASE("Lines are read and reprojected like outlines", "[gdal]") {
    GeoJson json;
    std::vector<std::string> log;
    const auto file =
        json.write(feature("LineString", "[[0,0],[5,0],[5,0],[5,7]]") + "," +
                   feature("MultiLineString", "[[[1,1],[2,2]],[[3,3],[4,4]]]") + "," + feature("Point", "[1,1]"));
    const auto lines = GdalReader().read_lines(file, "", log);
    REQUIRE(lines.size() == 3);
    CHECK(lines[0].size() == 3);
    CHECK(lines[0][2] == Vec2(5, 7));
    CHECK(any_contains(log, "only lines are used"));
    CHECK(contains(user_error([&] { GdalReader().read_lines(json.write(feature("Polygon", square)), "", log); }),
                   "1 polygon only"));
    const auto degrees = GdalReader().read_lines(json.write(feature("LineString", "[[7.26,61.96],[7.27,61.97]]")),
                                                 wkt_of("EPSG:32632"), log);
    CHECK(degrees.at(0).at(0).x() == Approx(408833.0).margin(2000.0));
}

TEST_CASE("A file of one line gives it, and another is refused by its layer and what it holds", "[gdal]") {
    GeoJson json;
    std::vector<std::string> log;
    const auto line = [&](const std::string& features, const std::string& crs = "") {
        return GdalReader().read_line(json.write(features), crs, log);
    };
    CHECK(line(feature("LineString", "[[0,0],[5,0],[5,7]]")) == Polyline{{0, 0}, {5, 0}, {5, 7}});
    CHECK(line(feature("MultiLineString", "[[[1,1],[2,2]]]")) == Polyline{{1, 1}, {2, 2}});
    CHECK(line(feature("LineString", "[[7.26,61.96],[7.27,61.97]]"), wkt_of("EPSG:32632")).at(0).x() ==
          Approx(408833.0).margin(2000.0));
    const auto refusal = [&](const std::string& features) { return user_error([&] { line(features); }); };
    const std::string two =
        refusal(feature("LineString", "[[0,0],[5,0]]") + "," + feature("LineString", "[[1,1],[2,2]]"));
    CHECK(contains(two, ".geojson: layer \""));
    CHECK(contains(two, "\" holds 2 lines; expected one line of two points or more"));
    CHECK(contains(refusal(feature("Polygon", square)), "holds 1 polygon; expected one line"));
    CHECK(contains(refusal(""), "the file holds no features; expected one line"));
}

TEST_CASE("A folder as an outline is read with a remark where it has one layer", "[gdal][remarks]") {
    GeoJson files;
    const std::string square = feature("Polygon", "[[[0,0],[10,0],[10,10],[0,10],[0,0]]]");
    const auto file = files.write(square, crs_member("32632"));
    std::filesystem::create_directory(files.path("maps"));
    const std::string to = files.path("maps/area.shp").string();
    {
        const gdal::Dataset source(GDALDataset::Open(file.c_str(), GDAL_OF_VECTOR));
        GDALDriver* const shapes = GetGDALDriverManager()->GetDriverByName("ESRI Shapefile");
        const gdal::Dataset copy(shapes->CreateCopy(to.c_str(), source.get(), 0, nullptr, nullptr, nullptr));
        REQUIRE(copy);
    }
    const Read out = read(files.path("maps"));
    CHECK(out.polygons.parts.size() == 1);
    CHECK(any_contains(out.log, "found a folder, of which the only layer \"area\" is read; expected a file"));
    CHECK_FALSE(any_contains(read(to).log, "found a folder"));
}
