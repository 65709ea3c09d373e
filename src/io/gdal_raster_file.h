#pragma once
// One raster file as an array of pixels with its south row first, whatever way it is stored.
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "io/gdal_resample.h"
#include "io/gdal_support.h"
#include "terrain/raster.h"

namespace frana::gdal {

/// What the numbers of a raster may be; decides which values are taken for undeclared nodata.
enum class Meaning { elevation, any };

/// A north- or south-up raster with a geotransform. Reads band 1 in blocks: only the pixels needed.
class RasterFile {
public:
    /// Opens and checks. UserError: missing, no raster, no georeference, rotated, complex numbers,
    /// words where numbers should be.
    RasterFile(const std::filesystem::path& file, Meaning meaning, std::vector<std::string>& log);

    const PixelAxis& x_axis() const { return x_; }
    const PixelAxis& y_axis() const { return y_; }  ///< from the south
    bool square() const;                            ///< within 1e-6
    std::array<double, 4> extent() const;           ///< xmin, ymin, xmax, ymax of the pixels' outer edges
    const OGRSpatialReference& crs() const { return crs_; }
    const std::string& unit() const { return unit_; }
    bool scaled() const { return scale_ != 1.0 || offset_ != 0.0; }  ///< what is stored are other numbers
    /// What the file says of itself and of its band, in words.
    bool has_palette() const;  ///< its numbers stand for colours
    std::string description() const;
    const std::filesystem::path& file() const { return file_; }
    std::string name() const { return file_.filename().string(); }

    /// Pixels [i, i + nx) x [j, j + ny), j from the south, row 0 = south. Scale and offset are applied. NaN where there
    /// is no data (nodata value, mask band, alpha, NaN). UserError: unreadable, or a value that must be nodata but is
    /// not declared as such.
    std::vector<double> read(Index i, Index j, Index nx, Index ny) const;

    /// The grid of pixels [i, i + nx) x [j, j + ny), which must be square.
    GridGeometry pixels(Index i, Index j, Index nx, Index ny) const;
    /// Their values as a raster.
    Raster read_raster(Index i, Index j, Index nx, Index ny) const;

private:
    void take_geotransform();
    void drop_nodata(std::vector<double>& values, Index i, Index first_row, Index nx, Index ny) const;
    void refuse_sentinels(const std::vector<double>& raw, Index i, Index first_row, Index nx) const;
    bool sentinel(double raw) const;

    std::filesystem::path file_;
    Meaning meaning_;
    Dataset dataset_;
    GDALRasterBand* band_ = nullptr;
    GDALRasterBand* alpha_ = nullptr;  ///< 0 there: no data; null when the file has none
    OGRSpatialReference crs_;
    PixelAxis x_, y_;
    bool south_up_ = false;
    double scale_ = 1.0, offset_ = 0.0;
    std::string unit_;
};

/// Pixels of an axis that touch [low, high], as first and count; clipped to the axis, count 0 when none does.
std::array<Index, 2> touched(const PixelAxis& axis, double low, double high);

}  // namespace frana::gdal
