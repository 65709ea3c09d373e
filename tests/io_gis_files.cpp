// What a run leaves for QGIS: rasters with nodata outside the flow, their styles, results.gpkg and run.qgz, read back by
// GDAL.
#include <gdal_priv.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "base/atomic_file.h"
#include "base/colour.h"
#include "catch.h"
#include "fake_simulation.h"
#include "fresh_folder.h"
#include "io/gdal_reader.h"
#include "io/gdal_writer.h"
#include "io/netcdf_series.h"
#include "io_gdal_make.h"
#include "program.h"
#include "read_layer.h"
#include "run/folder/map_style.h"
#include "run/folder/products.h"

using namespace frana;
namespace fs = std::filesystem;
using Catch::Contains;

namespace {

constexpr double kEast = 500000.0, kNorth = 5100000.0;  // in UTM zone 32

/// A rectangle as GeoJSON in that zone.
std::string rectangle(double x0, double y0, double x1, double y1) {
    std::ostringstream text;
    text.precision(12);
    text << R"({"type":"Polygon","crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::32632"}},)"
         << R"("coordinates":[[)";
    for (const auto& [x, y] : {std::pair(x0, y0), {x1, y0}, {x1, y1}, {x0, y1}})
        text << "[" << kEast + x << "," << kNorth + y << "],";
    text << "[" << kEast + x0 << "," << kNorth + y0 << "]]]}";
    return text.str();
}

/// A slope of 30 x 20 pixels of 5 m to the east with no terrain in its south-east corner, and a release on it.
class Slope {
public:
    Slope() {
        Raster dem = Raster::filled({30, 20, kEast + 2.5, kNorth + 2.5, 5.0}, 0.0);
        for (Index j = 0; j < 20; ++j)
            for (Index i = 0; i < 30; ++i) dem.at(i, j) = j == 0 && i > 26 ? Raster::nodata : 200.0 - 3.0 * double(i);
        dem.crs_wkt = wkt_of("EPSG:32632");
        write_geotiff(path() / "dem.tif", dem, "m", "a slope");
        write_text(path() / "release.geojson", rectangle(20, 40, 40, 60));
        write_text(path() / "survey.geojson", rectangle(20, 40, 90, 60));
        write_text(path() / "case.toml", R"([case]
title = "Slope & <flow>"
[terrain]
dem = "dem.tif"
[[release]]
outline = "release.geojson"
depth = 3
[material]
density = 1500
bed.law = "coulomb"
bed.mu = 0.3
[time]
end = 4
[output]
formats = ["geotiff"]
[[gauge]]
name = "bridge"
point = [500062.5, 5100052.5]
[[gauge]]
name = "far"
point = [500142.5, 5100092.5]
[[profile]]
name = "along"
line = [[500000, 5100051], [500149, 5100051]]
[[section]]
name = "door"
line = [[500050, 5100000], [500050, 5100099]]
[survey]
footprint = "survey.geojson"
)");
    }
    const fs::path& path() const { return folder_.path(); }
    fs::path run(const std::string& out, const std::string& arguments = "") const {
        const Outcome run = call_frana(path(), "run case.toml --quiet --out " + out + " " + arguments);
        INFO(run.err);
        REQUIRE(run.code == 0);
        return path() / out;
    }

private:
    FreshFolder folder_;
};

/// A raster as GDAL has it, the north row first.
struct Band {
    GDALDatasetUniquePtr dataset;
    GDALRasterBand* band = nullptr;
    std::vector<float> values;
    float nodata = 0.0F;

    explicit Band(const fs::path& file) {
        GDALAllRegister();
        dataset.reset(GDALDataset::Open(file.c_str(), GDAL_OF_RASTER));
        REQUIRE(dataset);
        band = dataset->GetRasterBand(1);
        const int nx = dataset->GetRasterXSize(), ny = dataset->GetRasterYSize();
        values.resize(static_cast<std::size_t>(nx) * ny);
        REQUIRE(band->RasterIO(GF_Read, 0, 0, nx, ny, values.data(), nx, ny, GDT_Float32, 0, 0, nullptr) == CE_None);
        nodata = static_cast<float>(band->GetNoDataValue());
        ++read_back.files;
        read_back.array(static_cast<std::int64_t>(values.size()));
    }
    std::string tag(const char* name, const char* domain = "") const {
        const char* found = dataset->GetMetadataItem(name, domain);
        return found ? found : "";
    }
};

std::vector<OGRFeatureUniquePtr> features_of(const fs::path& gpkg, const char* layer) {
    const Layer of(gpkg, layer);
    std::vector<OGRFeatureUniquePtr> all;
    for (OGRFeatureUniquePtr& feature : of.get()) all.push_back(std::move(feature));
    return all;
}

std::string project_text(const fs::path& run) {
    GDALAllRegister();
    CPLSetThreadLocalConfigOption("CPL_VSIL_ZIP_ALLOWED_EXTENSIONS", "qgz");
    const std::string name = "/vsizip/" + (run / "run.qgz").string() + "/run.qgs";
    VSILFILE* file = VSIFOpenL(name.c_str(), "rb");
    REQUIRE(file != nullptr);
    std::string text(1 << 20, ' ');
    text.resize(VSIFReadL(text.data(), 1, text.size(), file));
    VSIFCloseL(file);
    return text;
}

}  // namespace

TEST_CASE("Rasters are nodata outside the flow, keep zero inside of it, and read back as they were", "[gis]") {
    const Slope slope;
    const fs::path run = slope.run("run");
    const Band peak(run / "rasters/peak_depth.tif"), last(run / "rasters/final_depth.tif"),
        elevation(run / "rasters/elevation.tif");
    CHECK(std::string(peak.band->GetUnitType()) == "m");
    CHECK_THAT(peak.band->GetDescription(), Contains("largest depth"));
    CHECK(peak.tag("TIFFTAG_DOCUMENTNAME") == "Slope & <flow>");
    CHECK_THAT(peak.tag("TIFFTAG_SOFTWARE"), Contains("frana "));
    CHECK(peak.tag("TIFFTAG_DATETIME").empty());  // would differ in a run that is resumed
    int outside = 0, left = 0;
    for (std::size_t k = 0; k < peak.values.size(); ++k) {
        CHECK(peak.values[k] != 0.0F);
        CHECK((peak.values[k] == peak.nodata) == (last.values[k] == last.nodata));
        outside += peak.values[k] == peak.nodata;
        left += last.values[k] == 0.0F;
    }
    CHECK(outside > 100);
    CHECK(left > 0);  // the flow has left where it was released
    const std::vector<ProductRaster> rasters = read_rasters(run);
    const Raster& back = find_product(rasters, "peak_depth")->raster;
    const GridGeometry& g = back.geometry;
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) {
            const auto k = static_cast<std::size_t>((g.ny - 1 - j) * g.nx + i);
            if (elevation.values[k] == elevation.nodata)
                CHECK(std::isnan(back.at(i, j)));
            else
                CHECK(back.at(i, j) == (peak.values[k] == peak.nodata ? 0.0 : double(peak.values[k])));
        }
    CHECK(std::isnan(back.at(g.nx - 1, 0)));  // no terrain
    CHECK(back.at(g.nx - 1, g.ny - 1) == 0.0);
}

TEST_CASE("A CRS without a code is remarked upon: footprint.geojson cannot name it, and is in degrees", "[gis]") {
    const Slope slope;
    const auto warnings = [&](const char* out) {
        return nlohmann::json::parse(text_of(slope.run(out) / "run.json"))["warnings"].dump();
    };
    CHECK_THAT(warnings("coded"), !Contains("footprint.geojson"));
    std::vector<std::string> log;
    Raster dem = GdalReader().read_dem(slope.path() / "dem.tif", {}, log);
    dem.crs_wkt = wkt_of("+proj=tmerc +lat_0=0 +lon_0=9.00001 +k=0.9996 +x_0=500000 +y_0=0 +ellps=WGS84");
    write_geotiff(slope.path() / "dem.tif", dem, "m", "a slope");
    CHECK_THAT(warnings("custom"), Contains("footprint.geojson: found a CRS without an EPSG code") &&
                                       Contains("in longitude and latitude (WGS 84)"));
}

TEST_CASE("A resumed run leaves the same bytes for a GIS; SOURCE_DATE_EPOCH dates its rasters", "[gis][resume]") {
    const Slope slope;
    const fs::path straight = slope.run("straight"), parts = slope.run("parts", "--until 1.5");
    slope.run("parts", "--resume");
    for (const char* file : {"run.qgz", "results.gpkg", "rasters/peak_depth.tif", "rasters/elevation.tif",
                             "rasters/peak_depth.qml", "rasters/arrival_time.qml", "footprint.qml"}) {
        INFO(file);
        CHECK_FALSE(text_of(straight / file).empty());
        CHECK(text_of(parts / file) == text_of(straight / file));
    }
    ::setenv("SOURCE_DATE_EPOCH", "86400", 1);
    slope.run("straight", "--overwrite");
    ::unsetenv("SOURCE_DATE_EPOCH");
    CHECK(Band(straight / "rasters/peak_depth.tif").tag("TIFFTAG_DATETIME") == "1970:01:02 00:00:00");
    CHECK(text_of(straight / "run.qgz") == text_of(parts / "run.qgz"));
}

TEST_CASE("The project names each of its layers by a relative path, and what it needs is there", "[gis]") {
    const Slope slope;
    const fs::path run = slope.run("run");
    const std::string text = project_text(run);
    CHECK_THAT(text, Contains("<title>Slope &amp; &lt;flow&gt;</title>"));
    const std::regex source("<datasource>\\./([^<|]*)(\\|layername=([a-z]+))?</datasource>");
    std::set<std::string> found;
    for (std::sregex_iterator match(text.begin(), text.end(), source), end; match != end; ++match) {
        const fs::path file = run / (*match)[1].str();
        INFO(file);
        CHECK(fs::exists(file));
        if ((*match)[3].matched) CHECK(Layer(file, (*match)[3].str().c_str()).get().GetFeatureCount() > 0);
        found.insert((*match)[3].matched ? (*match)[3].str() : file.stem().string());
    }
    for (const char* layer : {"peak_depth", "peak_speed", "arrival_time", "elevation", "footprint", "outlines",
                              "release", "gauges", "profiles", "sections", "survey"})
        CHECK(found.count(layer) == 1);
    CHECK_THAT(text, !Contains(slope.path().string()) && Contains("<layer-tree-group name=\"Survey\""));
    // The footprint alone is shown as it is there.
    const std::string style = text_of(run / "footprint.qml");
    const std::size_t from = style.find("<renderer-v2"), to = style.find("</qgis>");
    REQUIRE((from != std::string::npos && to != std::string::npos));
    CHECK_THAT(style, Contains("class=\"SimpleLine\""));
    CHECK_THAT(text, Contains(style.substr(from, to - from)));
    // It begins at the flow.
    const Band peak(run / "rasters/peak_depth.tif");
    std::smatch extent;
    REQUIRE(std::regex_search(text, extent, std::regex("<xmin>([-0-9.]+)</xmin>")));
    const double first = std::stod(extent[1]);
    CHECK(first < kEast + 20.0);  // the release begins there
    CHECK(first > kEast);         // the terrain there
    CHECK_THAT(text, Contains("UTM zone 32N"));
}

TEST_CASE("Shapes of the results have the values of the rasters and tables that they are made of", "[gis][results]") {
    const Slope slope;
    const fs::path run = slope.run("run");
    const Band peak(run / "rasters/peak_depth.tif"), speed(run / "rasters/peak_speed.tif");
    const auto gauges = features_of(run / "results.gpkg", "gauges");
    REQUIRE(gauges.size() == 2);
    const std::size_t bridge = 9 * 30 + 12;  // its pixel, from the north-west
    CHECK(std::string(gauges[0]->GetFieldAsString("name")) == "bridge");
    CHECK(static_cast<float>(gauges[0]->GetFieldAsDouble("peak_depth_m")) == peak.values[bridge]);
    CHECK(static_cast<float>(gauges[0]->GetFieldAsDouble("peak_speed_m_s")) == speed.values[bridge]);
    CHECK(gauges[0]->GetGeometryRef()->toPoint()->getX() == 500062.5);
    CHECK_FALSE(gauges[1]->IsFieldSetAndNotNull(gauges[1]->GetFieldIndex("peak_depth_m")));  // never reached
    const auto profiles = features_of(run / "results.gpkg", "profiles");
    float along = 0.0F;  // of the row of pixels that it runs through
    for (std::size_t column = 0; column < 30; ++column) along = std::max(along, peak.values[9 * 30 + column]);
    CHECK(static_cast<float>(profiles.at(0)->GetFieldAsDouble("peak_depth_m")) == along);
    const auto record = nlohmann::json::parse(text_of(run / "run.json"));
    double area = 0.0, deeper = 0.0;
    for (const auto& part : features_of(run / "results.gpkg", "footprint")) {
        CHECK(part->GetFieldAsDouble("depth_m") == 0.1);
        CHECK(part->GetGeometryRef()->toPolygon()->get_Area() == Approx(part->GetFieldAsDouble("area_m2")));
        area += part->GetFieldAsDouble("area_m2");
    }
    CHECK(area == record["results"]["footprint_area"].get<double>());
    for (const auto& part : features_of(run / "results.gpkg", "outlines"))
        if (part->GetFieldAsDouble("depth_m") == 0.5) deeper += part->GetFieldAsDouble("area_m2");
    for (const float h : peak.values) deeper -= h > 0.5F ? 25.0 : 0.0;
    CHECK(deeper == 0.0);
    const auto release = features_of(run / "results.gpkg", "release");
    REQUIRE(release.size() == 1);
    const double outlined = release[0]->GetGeometryRef()->toPolygon()->get_Area();
    CHECK(release[0]->GetFieldAsDouble("area_m2") == Approx(outlined).epsilon(1e-12));
    CHECK(release[0]->GetFieldAsDouble("volume_m3") == record["release_volume"].get<double>());
    const auto sections = features_of(run / "results.gpkg", "sections");
    CHECK(sections.at(0)->GetFieldAsDouble("volume_m3") > 0.0);
    CHECK(features_of(run / "results.gpkg", "survey").size() == 1);
    CHECK_FALSE(fs::exists(slope.run("bare", "--set output.formats=[]") / "run.qgz"));
}

TEST_CASE("A style has the colours of the pictures, labels with units, and a range that one pixel does not set",
          "[gis]") {
    Raster depth = Raster::filled({40, 25, 0.0, 0.0, 1.0}, 0.0);
    for (std::size_t k = 0; k < depth.values.size(); ++k) depth.values[k] = 2.0 * double(k) / 1000.0;
    depth.values.back() = 500.0;
    const ProductRaster peak{"peak_depth", "m", "", depth};
    const std::string pipe = raster_pipe(peak, &peak, 0.1);
    const std::regex item("<item value=\"([^\"]*)\" color=\"#([0-9a-f]{6})\" alpha=\"(\\d+)\" label=\"([^\"]*)\"/>");
    std::vector<double> values;
    std::string last;
    for (std::sregex_iterator match(pipe.begin(), pipe.end(), item), end; match != end; ++match) {
        values.push_back(std::stod((*match)[1]));
        last = (*match)[4];
        const Colour colour = colour_at(Colormap::depth, values.back() / 2.0);
        char expected[7];
        std::snprintf(expected, sizeof expected, "%02x%02x%02x", colour.r, colour.g, colour.b);
        if (values.size() > 1) CHECK((*match)[2] == expected);
        CHECK((*match)[3] == (values.size() == 1 ? "0" : "255"));  // no depth, no colour
    }
    CHECK(values == std::vector<double>{0.0, 0.1, 0.4, 0.8, 1.2, 1.6, 2.0});
    CHECK(last == "2 m and more");
    const ProductRaster pressure{"peak_dynamic_pressure", "Pa", "", Raster::filled(depth.geometry, 20000.0)};
    CHECK_THAT(raster_pipe(pressure, &peak, 0.1), Contains("value=\"20000\"") && Contains("label=\"20 kPa\""));
    const ProductRaster change{"bed_change", "m", "", Raster::filled(depth.geometry, -1.0)};
    CHECK_THAT(raster_pipe(change, &peak, 0.1),
               Contains("classificationMin=\"-1\" classificationMax=\"1\"") && Contains("label=\"-0.6 m\""));
    CHECK_THAT(raster_pipe(elevation_raster(depth), &peak, 0.1), Contains("type=\"hillshade\""));
    // A scour hole of one pixel does not set the range, and changes beyond the peak depth count.
    ProductRaster scoured{"bed_change", "m", "", Raster::filled(depth.geometry, 0.0)};
    for (std::size_t k = 0; k < 400; ++k) scoured.raster.values[k] = k % 2 == 0 ? 0.75 : -1.0;
    scoured.raster.values[0] = -30.0;
    const ProductRaster nothing{"peak_depth", "m", "", Raster::filled(depth.geometry, 0.0)};
    CHECK_THAT(raster_pipe(scoured, &nothing, 0.1),
               Contains("classificationMin=\"-1\" classificationMax=\"1\"") && Contains("and less"));
}

TEST_CASE("A raster of more than 512 pixels is cloud-optimised, with the same values and bytes", "[gis]") {
    const FreshFolder folder;
    Raster raster = Raster::filled({700, 30, 0.0, 0.0, 1.0}, Raster::nodata);
    for (Index i = 0; i < 700; ++i) raster.at(i, 7) = 0.25 * double(i);
    for (const char* name : {"a.tif", "b.tif"})
        write_geotiff(folder.path() / name, raster, "m", "a line", {{"TIFFTAG_SOFTWARE", "test"}});
    const Band back(folder.path() / "a.tif");
    CHECK(back.tag("LAYOUT", "IMAGE_STRUCTURE") == "COG");
    CHECK(back.tag("TIFFTAG_SOFTWARE") == "test");
    CHECK(back.band->GetOverviewCount() == 1);
    CHECK(std::string(back.band->GetUnitType()) == "m");
    CHECK(std::string(back.band->GetDescription()) == "a line");
    for (std::size_t k = 0; k < back.values.size(); ++k)
        CHECK(back.values[k] == (k / 700 == 22 ? 0.25F * float(k % 700) : back.nodata));
    CHECK(text_of(folder.path() / "a.tif") == text_of(folder.path() / "b.tif"));
    CHECK(std::distance(fs::directory_iterator(folder.path()), {}) == 2);  // nothing beside them
    CHECK_THROWS_WITH(write_geotiff(folder.path() / "none" / "a.tif", raster, "m", ""), Contains("cannot be written"));
}

namespace {

/// series.nc as GDAL's multidimensional reader has it.
struct Series {
    GDALDatasetUniquePtr dataset;
    std::shared_ptr<GDALGroup> root;

    explicit Series(const fs::path& file) {
        GDALAllRegister();
        dataset.reset(GDALDataset::Open(file.c_str(), GDAL_OF_MULTIDIM_RASTER));
        REQUIRE(dataset);
        root = dataset->GetRootGroup();
        ++read_back.files;
    }
    template <class T>
    std::vector<T> values(const char* name, GDALDataType type) const {
        const auto array = root->OpenMDArray(name);
        INFO(name);
        REQUIRE(array);
        std::vector<GUInt64> start;
        std::vector<std::size_t> count;
        std::size_t all = 1;
        for (const auto& dimension : array->GetDimensions()) {
            start.push_back(0);
            count.push_back(static_cast<std::size_t>(dimension->GetSize()));
            all *= count.back();
        }
        std::vector<T> read(all);
        REQUIRE(
            array->Read(start.data(), count.data(), nullptr, nullptr, GDALExtendedDataType::Create(type), read.data()));
        read_back.array(static_cast<std::int64_t>(all));
        return read;
    }
};

}  // namespace

TEST_CASE("series.nc has depth, speed and velocity at every output, by CF's names", "[gis][netcdf]") {
    GDALAllRegister();
    if (GetGDALDriverManager()->GetDriverByName("netCDF") == nullptr) {
        WARN("not tested: this GDAL has no netCDF");
        return;
    }
    const Slope slope;
    const std::string formats = R"(--set 'output.formats=["geotiff","netcdf"]')";
    const fs::path run = slope.run("run", formats);
    const Series series(run / "series.nc");
    CHECK(std::string(series.root->GetAttribute("Conventions")->ReadAsString()) == "CF-1.8");
    CHECK(std::string(series.root->GetAttribute("title")->ReadAsString()) == "Slope & <flow>");
    CHECK(series.values<double>("time", GDT_Float64) == std::vector<double>{0, 1, 2, 3, 4});
    const auto x = series.values<double>("x", GDT_Float64), y = series.values<double>("y", GDT_Float64);
    CHECK((x.size() == 30 && x.front() == kEast + 2.5 && x.back() == kEast + 147.5));
    CHECK((y.size() == 20 && y.front() == kNorth + 2.5 && y.back() == kNorth + 97.5));  // the south row first
    const auto array = series.root->OpenMDArray("depth");
    REQUIRE(array);
    CHECK(array->GetUnit() == "m");
    CHECK(series.root->OpenMDArray("speed")->GetUnit() == "m s-1");
    CHECK_THAT(array->GetAttribute("long_name")->ReadAsString(), Contains("depth"));
    CHECK(series.root->OpenMDArray("time")->GetAttribute("standard_name")->ReadAsString() == std::string("time"));
    REQUIRE(array->GetSpatialRef());
    CHECK(std::string(array->GetSpatialRef()->GetAuthorityCode(nullptr)) == "32632");
    // The last output is the rasters' final state; the first has the release.
    const auto depth = series.values<float>("depth", GDT_Float32),
               east = series.values<float>("velocity_x", GDT_Float32);
    const Band last(run / "rasters/final_depth.tif"), velocity(run / "rasters/final_velocity_x.tif");
    int wet = 0;
    float first = 0.0F;
    for (std::size_t j = 0; j < 20; ++j)
        for (std::size_t i = 0; i < 30; ++i) {
            const std::size_t ours = (4 * 20 + j) * 30 + i, theirs = (19 - j) * 30 + i;
            const bool lies = last.values[theirs] > 0.0F;
            CHECK(depth[ours] == (lies ? last.values[theirs] : -9999.0F));
            CHECK(east[ours] == (lies ? velocity.values[theirs] : -9999.0F));
            wet += lies;
            first = std::max(first, depth[j * 30 + i]);
        }
    CHECK(wet > 10);
    CHECK(first == Approx(3.0).epsilon(0.05));  // depth of the release; nodes smear its margin
    // Resumed, the same bytes; fields that are not asked for are left out.
    slope.run("parts", formats + " --until 1.5");
    slope.run("parts", formats + " --resume");
    CHECK(text_of(slope.path() / "parts/series.nc") == text_of(run / "series.nc"));
    const Series depths(slope.run("depth", R"(--set 'output.formats=["netcdf"]' --set 'output.fields=["depth"]')") /
                        "series.nc");
    CHECK(depths.root->OpenMDArray("depth"));
    CHECK_FALSE(depths.root->OpenMDArray("speed"));
    CHECK_FALSE(fs::exists(slope.path() / "depth/run.qgz"));
}

// Its elevation is that of the last output, and nothing told of the bed at the others.
TEST_CASE("series.nc has what the bed has gained and lost at every output", "[gis][netcdf][erosion]") {
    GDALAllRegister();
    if (GetGDALDriverManager()->GetDriverByName("netCDF") == nullptr) {
        WARN("not tested: this GDAL has no netCDF");
        return;
    }
    const Slope slope;
    const std::string formats = R"(--set 'output.formats=["geotiff","netcdf"]')",
                      loose =
                          formats + " --set erodible.law=growth --set erodible.depth=0.5 --set erodible.growth=0.02";
    const fs::path run = slope.run("run", loose);
    const Series series(run / "series.nc");
    const auto change = series.values<float>("bed_change", GDT_Float32);
    const Band last(run / "rasters/bed_change.tif");
    std::array<double, 5> lost{};
    for (std::size_t j = 0; j < 20; ++j)
        for (std::size_t i = 0; i < 30; ++i) {
            for (std::size_t t = 0; t < 5; ++t) lost[t] -= double{change[(t * 20 + j) * 30 + i]};
            const float theirs = last.values[(19 - j) * 30 + i];
            CHECK(change[(4 * 20 + j) * 30 + i] == (theirs > -100.0F ? theirs : 0.0F));
        }
    CHECK(lost[0] == 0.0);
    for (std::size_t t = 1; t < 5; ++t) CHECK(lost[t] > lost[t - 1]);
    CHECK_THAT(series.root->OpenMDArray("elevation")->GetAttribute("long_name")->ReadAsString(), Contains("last time"));
    slope.run("parts", loose + " --until 1.5");
    slope.run("parts", loose + " --resume");
    CHECK(text_of(slope.path() / "parts/series.nc") == text_of(run / "series.nc"));
    CHECK_FALSE(Series(slope.run("rock", formats) / "series.nc").root->OpenMDArray("bed_change"));
}

TEST_CASE("series.nc keeps coordinate systems that CF has no names for, and a full disk costs no run",
          "[gis][netcdf]") {
    GDALAllRegister();
    if (GetGDALDriverManager()->GetDriverByName("netCDF") == nullptr) return;
    for (const char* code : {"2056", "5514", "32632"}) {  // LV95 and Krovak are oblique, UTM is not
        CAPTURE(code);
        const FreshFolder folder;
        FakeSimulation simulation;
        std::vector<std::string> warnings;
        const auto writer = make_netcdf_writer(folder.path(), "a hill", wkt_of((std::string("EPSG:") + code).c_str()),
                                               {"depth"}, warnings);
        writer->observe(simulation.frame());
        writer->end(simulation.frame());
        REQUIRE(warnings.empty());
        const Series series(folder.path() / "series.nc");
        for (const char* name : {"depth", "elevation"}) {
            const auto crs = series.root->OpenMDArray(name)->GetSpatialRef();
            REQUIRE(crs);
            OGRSpatialReference wanted;
            wanted.SetFromUserInput((std::string("EPSG:") + code).c_str());
            const char* const loosely[] = {"IGNORE_DATA_AXIS_TO_SRS_AXIS_MAPPING=YES",
                                           "CRITERION=EQUIVALENT_EXCEPT_AXIS_ORDER_GEOGCRS", nullptr};
            CHECK(crs->IsSame(&wanted, loosely));
        }
    }
    FakeSimulation simulation;
    std::vector<std::string> warnings;
    const auto writer = make_netcdf_writer("/nowhere", "a hill", "", {"depth"}, warnings);
    writer->observe(simulation.frame());
    writer->end(simulation.frame());
    REQUIRE(warnings.size() == 1);
    CHECK_THAT(warnings.front(), Contains("series.nc was not written: "));
}
