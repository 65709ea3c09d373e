#include <gdal_priv.h>

#include <cmath>
#include <set>

#include "fuzz/answers.h"
#include "fuzz/targets.h"
#include "io/gdal_crs.h"
#include "io/gdal_reader.h"
#include "io/gdal_support.h"

namespace frana::fuzz {
namespace {

/// The drivers of the formats that people send; GDAL has two hundred, which are not ours to test.
void keep_drivers(const std::set<std::string>& wanted) {
    static bool done = false;
    if (done) return;
    done = true;
    gdal::register_drivers();
    GDALDriverManager& manager = *GetGDALDriverManager();
    for (int n = manager.GetDriverCount(); n-- > 0;)
        if (GDALDriver* driver = manager.GetDriver(n); !wanted.count(driver->GetDescription()))
            manager.DeregisterDriver(driver);
}
const std::set<std::string> kDrivers{"GTiff",  "AAIGrid", "GSAG",     "GSBG", "GS7BG", "MEM",
                                     "Memory", "GeoJSON", "TopoJSON", "GML",  "KML"};

/// A file in memory, gone at the end.
class MemoryFile {
public:
    MemoryFile(const char* name, const Input& bytes) : name_(std::string("/vsimem/") + name), bytes_(bytes) {
        VSIFCloseL(VSIFileFromMemBuffer(name_.c_str(), reinterpret_cast<GByte*>(bytes_.data()), bytes_.size(), false));
    }
    ~MemoryFile() {
        VSIUnlink(name_.c_str());
        VSIUnlink((name_ + ".aux.xml").c_str());
    }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;
    std::filesystem::path path() const { return name_; }

private:
    std::string name_;
    Input bytes_;
};

/// A header may claim any size; only small rasters are worth a fuzzer's time.
bool small(const std::filesystem::path& file) {
    const gdal::Messages quiet;
    const gdal::Dataset dataset(GDALDataset::Open(file.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY));
    if (!dataset) return true;
    return double(dataset->GetRasterXSize()) * dataset->GetRasterYSize() <= 1e5 && dataset->GetRasterCount() <= 16;
}

const std::string& utm() {
    static const std::string wkt = [] {
        OGRSpatialReference crs;
        crs.importFromEPSG(32632);
        return gdal::horizontal_wkt(crs);
    }();
    return wkt;
}

/// A terrain's values are finite or missing.
void require_finite(const Raster& raster) {
    if (static_cast<Index>(raster.values.size()) != raster.geometry.size())
        throw std::logic_error("a raster with values missing");
    for (const double value : raster.values)
        if (std::isinf(value)) throw std::logic_error("an infinite value was let through");
}

void require_finite(const Polygons& polygons) {
    for (const Polygon& part : polygons.parts)
        for (const auto& ring : part.rings)
            for (const Vec2& at : ring)
                if (!std::isfinite(at.x()) || !std::isfinite(at.y()))
                    throw std::logic_error("a vertex that is not finite was let through");
}

}  // namespace

void raster(const Input& bytes) {
    keep_drivers(kDrivers);
    const MemoryFile file("fuzz.tif", bytes);
    if (!small(file.path())) return;
    const GdalReader reader;
    std::vector<std::string> log;
    const GridGeometry grid{12, 10, 2.5, 2.5, 5.0};
    refused_fairly([&] { require_finite(reader.read_dem(file.path(), {std::nullopt, std::nullopt}, log)); });
    refused_fairly([&] {
        require_finite(reader.read_dem(file.path(), {std::array<double, 4>{0, 0, 50, 40}, 7.0}, log));
    });
    for (const std::string& crs : {std::string(), utm()}) {
        refused_fairly([&] { require_finite(reader.read_raster(file.path(), grid.pixel_extent(), crs, log)); });
        refused_fairly([&] { require_finite(reader.read_onto(file.path(), grid, crs, log)); });
        refused_fairly([&] { require_finite(reader.read_survey(file.path(), grid.pixel_extent(), crs, log)); });
        refused_fairly([&] { require_finite(reader.read_deposit(file.path(), grid, crs, log)); });
    }
}

void vector(const Input& bytes) {
    keep_drivers(kDrivers);
    const MemoryFile file("fuzz.geojson", bytes);
    if (!small(file.path())) return;  // a survey may be a raster
    const GdalReader reader;
    std::vector<std::string> log;
    for (const std::string& crs : {std::string(), utm()}) {
        refused_fairly([&] { require_finite(reader.read_polygons(file.path(), crs, log)); });
        refused_fairly([&] { reader.read_lines(file.path(), crs, log); });
        refused_fairly([&] { require_finite(reader.read_survey(file.path(), {0, 0, 100, 100}, crs, log)); });
    }
}

}  // namespace frana::fuzz
