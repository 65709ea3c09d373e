// Products that a GIS opens: read back with GDAL itself and with our reader.
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "base/error.h"
#include "fresh_folder.h"
#include "io/gdal_reader.h"
#include "io/gdal_support.h"
#include "io/gdal_writer.h"
#include "io_gdal_make.h"
#include "read_back.h"

#include "catch.h"

using namespace frana;

namespace {

std::string utm32() {
    OGRSpatialReference crs;
    crs.importFromEPSG(32632);
    char* text = nullptr;
    crs.exportToWkt(&text);
    std::string wkt(text);
    CPLFree(text);
    return wkt;
}

Raster field(Index nx = 300, Index ny = 70) {
    Raster raster = Raster::filled({nx, ny, 408400.25, 6870086.61, 5.0}, 0.0);
    for (Index j = 0; j < ny; ++j)
        for (Index i = 0; i < nx; ++i) raster.at(i, j) = 0.25 * double(i) + 100.0 * double(j);
    raster.crs_wkt = utm32();
    return raster;
}

struct Footprint {
    std::vector<std::unique_ptr<OGRGeometry>> outlines;
    double area = 0.0, attribute_area = 0.0;
    int epsg = 0;
};

Footprint footprint_of(const std::filesystem::path& file) {
    Footprint out;
    const gdal::Dataset dataset = gdal::open(file, GDAL_OF_VECTOR);
    OGRLayer& layer = *dataset->GetLayer(0);
    if (layer.GetSpatialRef()) out.epsg = std::atoi(layer.GetSpatialRef()->GetAuthorityCode(nullptr));
    for (const OGRFeatureUniquePtr& feature : layer) {
        out.outlines.emplace_back(feature->StealGeometry());
        CHECK(out.outlines.back()->IsValid());
        const double own = feature->GetFieldAsDouble("area_m2");
        CHECK(own == Approx(out.outlines.back()->toPolygon()->get_Area()).epsilon(1e-6));
        out.attribute_area += own;
        out.area += out.outlines.back()->toPolygon()->get_Area();
        CHECK(feature->GetFieldAsDouble("threshold_m") == 0.1);
    }
    return out;
}

Raster covered(const std::vector<std::string>& rows_from_north) {
    const Index ny = Index(rows_from_north.size()), nx = Index(rows_from_north[0].size());
    Raster depth = Raster::filled({nx, ny, 408400.25, 6870086.61, 5.0}, 0.0);
    depth.crs_wkt = utm32();
    for (Index j = 0; j < ny; ++j)
        for (Index i = 0; i < nx; ++i)
            if (rows_from_north[std::size_t(ny - 1 - j)][std::size_t(i)] == '#') depth.at(i, j) = 0.2;
    return depth;
}

}  // namespace

TEST_CASE("A written GeoTIFF reads back with the same pixels, values, gaps and CRS", "[gdal]") {
    const FreshFolder folder;
    Raster raster = field();
    raster.at(3, 60) = Raster::nodata;
    const auto file = folder.path() / "peak_depth.tif";
    write_geotiff(file, raster, "m", "largest depth");
    std::vector<std::string> log;
    const Raster back = GdalReader().read_dem(file, {}, log);
    CHECK(back.geometry.nx == raster.geometry.nx);
    CHECK(back.geometry.ny == raster.geometry.ny);
    CHECK(back.geometry.cell == raster.geometry.cell);
    CHECK(back.geometry.x0 == Approx(raster.geometry.x0).epsilon(1e-15));
    CHECK(back.geometry.y0 == Approx(raster.geometry.y0).epsilon(1e-15));
    for (std::size_t k = 0; k < raster.values.size(); ++k)
        if (!(back.values[k] == raster.values[k] || (std::isnan(back.values[k]) && std::isnan(raster.values[k]))))
            FAIL("value " << k);
    CHECK(std::isnan(back.at(3, 60)));
    CHECK(contains(back.crs_wkt, "ID[\"EPSG\",32632]"));
    CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1);  // nothing beside it
}

TEST_CASE("A written GeoTIFF is float32, tiled, compressed, north-up, with unit, description and nodata", "[gdal]") {
    const FreshFolder folder;
    const auto file = folder.path() / "peak_depth.tif";
    Raster raster = field();
    raster.at(0, 0) = Raster::nodata;
    write_geotiff(file, raster, "m", "largest depth");
    const gdal::Dataset dataset = gdal::open(file, GDAL_OF_RASTER);
    GDALRasterBand& band = *dataset->GetRasterBand(1);
    CHECK(band.GetRasterDataType() == GDT_Float32);
    CHECK(band.GetNoDataValue() == -9999.0);
    CHECK(std::string(band.GetUnitType()) == "m");
    CHECK(std::string(band.GetDescription()) == "largest depth");
    CHECK(std::string(dataset->GetMetadataItem("COMPRESSION", "IMAGE_STRUCTURE")) == "DEFLATE");
    int block_x = 0, block_y = 0;
    band.GetBlockSize(&block_x, &block_y);
    CHECK(block_x == 256);
    double transform[6];
    REQUIRE(dataset->GetGeoTransform(transform) == CE_None);
    CHECK(transform[3] == Approx(raster.geometry.y_max() + 2.5).epsilon(1e-15));
    CHECK(transform[5] == -5.0);
    std::vector<float> all(raster.values.size());
    const int nx = int(raster.geometry.nx), ny = int(raster.geometry.ny);
    REQUIRE(band.RasterIO(GF_Read, 0, 0, nx, ny, all.data(), nx, ny, GDT_Float32, 0, 0, nullptr) == CE_None);
    Index different = 0;
    for (int row = 0; row < ny; ++row)  // a file's first row is the northernmost
        for (int i = 0; i < nx; ++i) {
            const double wanted = raster.at(i, ny - 1 - row);
            different += all[std::size_t(row * nx + i)] != (std::isnan(wanted) ? -9999.0F : float(wanted));
        }
    ++read_back.files;
    read_back.array(Index(all.size()));
    CHECK(different == 0);
    float corner = 0.0F;  // the file's last row, first column: our node (0, 0), which is nodata
    REQUIRE(band.RasterIO(GF_Read, 0, 69, 1, 1, &corner, 1, 1, GDT_Float32, 0, 0, nullptr) == CE_None);
    CHECK(corner == -9999.0F);
}

TEST_CASE("A value that is infinite, or too large for float32, leaves no file and the old one whole", "[gdal]") {
    const FreshFolder folder;
    const auto file = folder.path() / "peak_depth.tif";
    write_geotiff(file, field(), "m", "");
    const std::string before = text_of(file);
    for (const double bad :
         {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), 1e300}) {
        Raster raster = field();
        raster.at(5, 5) = bad;
        CHECK_THROWS_AS(write_geotiff(file, raster, "m", ""), NumericsError);
    }
    CHECK(text_of(file) == before);
    CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1);
}

TEST_CASE("Writing where it is not possible is refused in one sentence", "[gdal]") {
    const FreshFolder folder;
    const auto nowhere = folder.path() / "no_such_folder";
    std::string raster, outline;
    const std::string noise = heard_on_stderr([&] {
        raster = user_error([&] { write_geotiff(nowhere / "a.tif", field(), "m", ""); });
        outline = user_error([&] { write_footprint(nowhere / "a.geojson", field(), 0.1); });
    });
    CHECK(noise == "");
    CHECK(contains(raster, "cannot be written"));
    CHECK(contains(outline, "cannot be written"));
}

TEST_CASE("A footprint has the area of its cells, keeps holes and carries the CRS", "[gdal]") {
    const FreshFolder folder;
    const auto file = folder.path() / "footprint.geojson";
    write_footprint(file,
                    covered({"..........",  //
                             ".#####....",  //
                             ".#...#..#.",  //
                             ".#.#.#..#.",  //
                             ".#...#....",  //
                             ".#####...."}),
                    0.1, {{"time_s", 12.5}});
    const Footprint out = footprint_of(file);
    REQUIRE(out.outlines.size() == 3);  // the ring, the island in its hole, the bar: largest first
    CHECK(out.outlines[0]->toPolygon()->getNumInteriorRings() == 1);
    CHECK(out.attribute_area == 19 * 25.0);
    CHECK(out.area == Approx(19 * 25.0).epsilon(1e-6));  // shoelace cancellation at 6.9e6 m: 1e-3 m2
    CHECK(out.epsg == 32632);
    OGREnvelope envelope;
    out.outlines[1]->getEnvelope(&envelope);
    CHECK(envelope.MinX == Approx(408400.25 + 7.5 * 5.0).epsilon(1e-12));  // the bar at column 8, rows 2 and 3
    CHECK(envelope.MinY == Approx(6870086.61 + 1.5 * 5.0).epsilon(1e-12));
    CHECK(envelope.MaxY == Approx(6870086.61 + 3.5 * 5.0).epsilon(1e-12));
}

TEST_CASE("Footprints of random cover are valid polygons with exactly the covered area", "[gdal]") {
    const FreshFolder folder;
    std::mt19937 random(7);
    for (const unsigned share : {10U, 50U, 90U}) {
        std::vector<std::string> rows(60, std::string(80, '.'));
        Index cells = 0;
        for (std::string& row : rows)
            for (char& cell : row)
                if (random() % 100 < share) {
                    cell = '#';
                    ++cells;
                }
        write_footprint(folder.path() / "footprint.geojson", covered(rows), 0.1);
        CHECK(footprint_of(folder.path() / "footprint.geojson").attribute_area == double(cells) * 25.0);
    }
}

TEST_CASE("The footprint reads back as the polygons it was, with and without a CRS", "[gdal]") {
    const FreshFolder folder;
    const auto file = folder.path() / "footprint.geojson";
    for (const bool with_crs : {true, false}) {
        Raster depth = covered({"###", "#.#", "###"});
        if (!with_crs) depth.crs_wkt.clear();
        depth.at(0, 0) = Raster::nodata;
        write_footprint(file, depth, 0.1);
        CHECK(contains(text_of(file), "\"crs\"") == with_crs);
        std::vector<std::string> log;
        const Polygons back = GdalReader().read_polygons(file, depth.crs_wkt, log);
        REQUIRE(back.parts.size() == 1);
        for (const auto& ring : back.parts[0].rings)
            for (const Vec2& corner : ring) {
                const double column = (corner.x() - 408397.75) / 5.0;
                CHECK(std::abs(column - std::round(column)) < 1e-9);  // nine decimals of metres are written
            }
    }
}

TEST_CASE("Levels of a probability are outlines in one file, and a value at a level belongs to it", "[gdal]") {
    const FreshFolder folder;
    const auto file = folder.path() / "probability.geojson";
    Raster share = covered({"....", ".##.", ".##."});
    for (double& value : share.values) value = value > 0.0 ? 0.05 : 0.0;
    share.at(1, 0) = 0.5;
    share.at(2, 0) = 0.1 + 0.2 + 0.2;  // 0.5 but for round-off
    write_levels(file, share, "probability", {0.05, 0.5, 0.95});
    using Json = nlohmann::json;
    const Json features = Json::parse(text_of(file))["features"];
    REQUIRE(features.size() == 2);
    CHECK(features[0]["properties"] == Json{{"area_m2", 100.0}, {"probability", 0.05}});
    CHECK(features[1]["properties"] == Json{{"area_m2", 50.0}, {"probability", 0.5}});
}

TEST_CASE("Nothing covered gives an empty collection, and a threshold of NaN is refused", "[gdal]") {
    const FreshFolder folder;
    const auto file = folder.path() / "footprint.geojson";
    write_footprint(file, covered({"...", "..."}), 0.1);
    CHECK(footprint_of(file).outlines.empty());
    CHECK_THROWS_AS(write_footprint(file, covered({"..."}), std::nan("")), NumericsError);
}

TEST_CASE("The version is that of GDAL", "[gdal]") { CHECK(gdal_version().substr(0, 2) == "3."); }

TEST_CASE("Outlines in a CRS without a code are written in degrees, at the same place", "[gdal]") {
    const FreshFolder folder;
    const auto file = folder.path() / "footprint.geojson";
    Raster depth = covered({".##.", ".#..", "...."});
    OGRSpatialReference own;
    own.SetFromUserInput("+proj=tmerc +lat_0=0 +lon_0=9.00001 +k=0.9996 +x_0=500000 +y_0=0 +ellps=WGS84");
    char* text = nullptr;
    own.exportToWkt(&text);
    depth.crs_wkt = text;
    CPLFree(text);
    REQUIRE(footprint_place(depth.crs_wkt) == FootprintPlace::degrees);
    CHECK(footprint_place(utm32()) == FootprintPlace::named);
    CHECK(footprint_place("") == FootprintPlace::unnamed);
    write_footprint(file, depth, 0.1);
    const gdal::Dataset dataset = gdal::open(file, GDAL_OF_VECTOR);
    OGRLayer& layer = *dataset->GetLayer(0);
    REQUIRE(layer.GetSpatialRef());
    CHECK(layer.GetSpatialRef()->IsGeographic());
    OGREnvelope box;
    REQUIRE(layer.GetExtent(&box) == OGRERR_NONE);
    CHECK((box.MinX > 7.0 && box.MaxX < 8.5 && box.MinY > 61.5 &&
           box.MaxY < 62.5));  // where 408 km 6870 km of UTM 32 are
    std::vector<std::string> log;
    const Polygons back = GdalReader().read_polygons(file, depth.crs_wkt, log);
    REQUIRE(back.parts.size() == 1);
    double low = 1e300, high = -1e300, area = 0.0;
    const auto& ring = back.parts[0].rings[0];
    for (std::size_t k = 0, last = ring.size() - 1; k < ring.size(); last = k++) {
        low = std::min(low, ring[k].x()), high = std::max(high, ring[k].x());
        const Vec2 origin(408400.0, 6870086.0), a = ring[last] - origin, b = ring[k] - origin;
        area += 0.5 * (a.x() * b.y() - b.x() * a.y());
    }
    // Written to 1e-12 degrees and brought back by the inverse series of PROJ: 1e-5 m is far more than both.
    CHECK(low == Approx(408402.75).margin(1e-5));
    CHECK(high == Approx(408412.75).margin(1e-5));
    CHECK(std::abs(area) == Approx(75.0).margin(1e-3));
    CHECK(layer.GetFeature(1) == nullptr);
    const OGRFeatureUniquePtr feature(layer.GetFeature(0));
    CHECK(feature->GetFieldAsDouble("area_m2") == 75.0);
}
