#include "io/gdal_raster_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/shell_word.h"
#include "io/gdal_ascii.h"
#include "io/gdal_crs.h"

namespace frana::gdal {
namespace {

/// CRS for a cure: none is given where none is known.
std::string straight_line(const std::filesystem::path& file) { return warp_line(file, "", "_north_up"); }

const char* color_word(int bands) { return bands == 3 || bands == 4 ? "; is this a picture rather than a field?" : ""; }

}  // namespace

RasterFile::RasterFile(const std::filesystem::path& file, Meaning meaning, std::vector<std::string>& log)
    : file_(file), meaning_(meaning), dataset_(open(file, GDAL_OF_RASTER)) {
    const Messages messages;
    const int bands = dataset_->GetRasterCount();
    if (bands == 0) {
        const char* inner = CSLFetchNameValue(dataset_->GetMetadata("SUBDATASETS"), "SUBDATASET_1_NAME");
        throw UserError(fmt::format("{}: holds no raster band{}", file_.string(),
                                    inner ? fmt::format(" but subdatasets; expected one raster; run: gdal_translate "
                                                        "{} {}",
                                                        shell_word(inner), shell_word(sibling(file_, "_1")))
                                          : std::string("; expected a raster such as a GeoTIFF")));
    }
    band_ = dataset_->GetRasterBand(1);
    require_numbers(file_, *dataset_);
    if (GDALDataTypeIsComplex(band_->GetRasterDataType()))
        throw UserError(
            fmt::format("{}: holds complex numbers; expected real ones; run: gdal_translate -ot Float64 "
                        "{} {}",
                        file_.string(), shell_word(file_.string()), shell_word(sibling(file_, "_real"))));
    // GDAL takes alpha for a mask in integer rasters only; gdalwarp -dstalpha makes it in any.
    if (bands > 1 && dataset_->GetRasterBand(bands)->GetColorInterpretation() == GCI_AlphaBand)
        alpha_ = dataset_->GetRasterBand(bands);
    if (bands > (alpha_ ? 2 : 1))
        log.push_back(fmt::format("{}: has {} bands, the first is used{}", name(), bands, color_word(bands)));
    if (const auto* crs = dataset_->GetSpatialRef()) {
        crs_ = *crs;
        crs_.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    }
    scale_ = band_->GetScale();
    offset_ = band_->GetOffset();
    if (scaled()) log.push_back(fmt::format("{}: values are stored number * {:g} + {:g}", name(), scale_, offset_));
    if (const char* unit = band_->GetUnitType()) unit_ = unit;
    take_geotransform();
}

void RasterFile::take_geotransform() {
    double t[6];
    if (dataset_->GetGeoTransform(t) != CE_None) {
        const bool points = dataset_->GetGCPCount() > 0;
        throw UserError(
            fmt::format("{}: has no georeference; expected the map position of its pixels; run: {}", file_.string(),
                        points ? straight_line(file_)
                               : fmt::format("gdal_translate -a_ullr XMIN YMAX XMAX YMIN {} {}",
                                             shell_word(file_.string()), shell_word(sibling(file_, "_placed")))));
    }
    const Index nx = dataset_->GetRasterXSize(), ny = dataset_->GetRasterYSize();
    // A thousandth of a pixel over the whole raster is not a rotation but the round-off of some writer.
    const bool rotated =
        std::abs(t[2]) * double(ny) > 1e-3 * std::abs(t[1]) || std::abs(t[4]) * double(nx) > 1e-3 * std::abs(t[5]);
    if (rotated || !(t[1] > 0.0) || t[5] == 0.0)
        throw UserError(
            fmt::format("{}: its rows do not run from west to east (geotransform {:g} {:g} {:g}, "
                        "{:g} {:g} {:g}: rotated or mirrored); expected pixels along the axes of the "
                        "map; run: {}",
                        file_.string(), t[0], t[1], t[2], t[3], t[4], t[5], straight_line(file_)));
    constexpr double least = 1e-6, most = 1e9;  // of a pixel, in degrees or metres
    bool placed = t[1] > least && std::abs(t[5]) > least && t[1] < most && std::abs(t[5]) < most;
    for (const double number : t) placed = placed && std::abs(number) < 1e12;
    if (!placed)
        throw UserError(
            fmt::format("{}: its georeference (geotransform {:g} {:g} {:g}, {:g} {:g} {:g}) is no place on "
                        "a map; expected pixels of a size in metres; run: gdal_translate -a_ullr XMIN YMAX "
                        "XMAX YMIN {} {}",
                        file_.string(), t[0], t[1], t[2], t[3], t[4], t[5], shell_word(file_.string()),
                        shell_word(sibling(file_, "_placed"))));
    south_up_ = t[5] > 0.0;
    x_ = {nx, t[0], t[1]};
    y_ = {ny, south_up_ ? t[3] : t[3] + double(ny) * t[5], std::abs(t[5])};
}

bool RasterFile::square() const { return std::abs(x_.size - y_.size) <= 1e-6 * x_.size; }

std::array<double, 4> RasterFile::extent() const {
    return {x_.start, y_.start, x_.start + double(x_.count) * x_.size, y_.start + double(y_.count) * y_.size};
}

bool RasterFile::has_palette() const { return band_->GetColorTable() != nullptr; }

std::string RasterFile::description() const {
    std::string text = band_->GetDescription();
    for (char** items : {dataset_->GetMetadata(), band_->GetMetadata()})
        for (int n = 0; n < CSLCount(items); ++n) text += fmt::format("\n{}", items[n]);
    return text;
}

std::vector<double> RasterFile::read(Index i, Index j, Index nx, Index ny) const {
    expect(i >= 0 && j >= 0 && nx > 0 && ny > 0 && i + nx <= x_.count && j + ny <= y_.count,
           "pixels outside the raster");
    const Messages messages;
    const Index first_row = south_up_ ? j : y_.count - j - ny;
    std::vector<double> values(static_cast<std::size_t>(nx * ny));
    if (band_->RasterIO(GF_Read, int(i), int(first_row), int(nx), int(ny), values.data(), int(nx), int(ny), GDT_Float64,
                        0, 0, nullptr) != CE_None)
        throw UserError(
            fmt::format("{}: cannot be read to its end ({}); the file is damaged or incomplete: copy or "
                        "download it again",
                        file_.string(), messages.reason("no reason given")));
    drop_nodata(values, i, first_row, nx, ny);
    refuse_sentinels(values, i, first_row, nx);
    if (scale_ != 1.0 || offset_ != 0.0)
        for (double& value : values) value = value * scale_ + offset_;
    if (!south_up_)
        for (Index low = 0, high = ny - 1; low < high; ++low, --high)
            std::swap_ranges(values.begin() + low * nx, values.begin() + (low + 1) * nx, values.begin() + high * nx);
    return values;
}

void RasterFile::drop_nodata(std::vector<double>& values, Index i, Index first_row, Index nx, Index ny) const {
    const Messages messages;
    int declared = 0;
    const double nodata = band_->GetNoDataValue(&declared);
    // A mask band hides the nodata value from GDAL's own mask; a file with both means both.
    if (declared && !std::isnan(nodata)) {
        const bool single = band_->GetRasterDataType() == GDT_Float32;
        for (double& value : values)
            if (value == nodata || (single && float(value) == float(nodata))) value = Raster::nodata;
    }
    GDALRasterBand* mask_band = alpha_;
    if (!mask_band) {
        if (band_->GetMaskFlags() == GMF_ALL_VALID || band_->GetMaskFlags() == GMF_NODATA) return;
        mask_band = band_->GetMaskBand();
    }
    std::vector<double> mask(values.size());
    if (mask_band->RasterIO(GF_Read, int(i), int(first_row), int(nx), int(ny), mask.data(), int(nx), int(ny),
                            GDT_Float64, 0, 0, nullptr) != CE_None)
        throw UserError(
            fmt::format("{}: its mask of valid pixels cannot be read ({}); the file is damaged or "
                        "incomplete: copy or download it again",
                        file_.string(), messages.reason("no reason given")));
    for (std::size_t k = 0; k < values.size(); ++k)
        if (!(mask[k] > 0.0)) values[k] = Raster::nodata;
}

bool RasterFile::sentinel(double raw) const {
    if (std::isinf(raw) || raw == -9999.0 || raw == -99999.0 || std::abs(raw) > 1e30) return true;
    const GDALDataType type = band_->GetRasterDataType();
    if (type == GDT_Int16 && raw == -32768.0) return true;
    if (meaning_ != Meaning::elevation) return false;
    if ((type == GDT_Int16 && raw == 32767.0) || (type == GDT_UInt16 && raw == 65535.0)) return true;
    const double metres = raw * scale_ + offset_;
    return metres < -1e4 || metres > 1e5;
}

void RasterFile::refuse_sentinels(const std::vector<double>& raw, Index i, Index first_row, Index nx) const {
    for (std::size_t k = 0; k < raw.size(); ++k) {
        if (std::isnan(raw[k]) || !sentinel(raw[k])) continue;
        const Index column = i + Index(k) % nx, row = first_row + Index(k) / nx;
        const Index j = south_up_ ? row : y_.count - 1 - row;
        throw UserError(fmt::format(
            "{}: pixel {} {} (column and row from the first pixel of the file), at {:.10g} {:.10g}, holds "
            "{:g}, which "
            "cannot be {} and is not declared as nodata; if it stands for no data, run: gdal_translate "
            "-a_nodata {} "
            "{} {}",
            file_.string(), column, row, x_.start + (double(column) + 0.5) * x_.size,
            y_.start + (double(j) + 0.5) * y_.size, raw[k],
            meaning_ == Meaning::elevation ? "an elevation in metres" : "a measured value",
            fmt::format("{:.17g}", raw[k]), shell_word(file_.string()), shell_word(sibling(file_, "_nodata"))));
    }
}

GridGeometry RasterFile::pixels(Index i, Index j, Index nx, Index ny) const {
    return {nx, ny, x_.start + (double(i) + 0.5) * x_.size, y_.start + (double(j) + 0.5) * y_.size, x_.size};
}

Raster RasterFile::read_raster(Index i, Index j, Index nx, Index ny) const {
    Raster raster;
    raster.geometry = pixels(i, j, nx, ny);
    raster.values = read(i, j, nx, ny);
    raster.crs_wkt = horizontal_wkt(crs_);
    raster.source = file_.string();
    return raster;
}

std::array<Index, 2> touched(const PixelAxis& axis, double low, double high) {
    constexpr double round_off = 1e-6;  // of a pixel
    const double a = std::max(0.0, std::floor((low - axis.start) / axis.size + round_off));
    const double b = std::min(double(axis.count), std::ceil((high - axis.start) / axis.size - round_off));
    return b > a ? std::array<Index, 2>{Index(a), Index(b - a)} : std::array<Index, 2>{0, 0};
}

}  // namespace frana::gdal
