// Rasters that lie on a terrain: depths, masks, velocities.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/shell_word.h"
#include "io/gdal_crs.h"
#include "io/gdal_onto.h"
#include "io/gdal_reader.h"
#include "io/gdal_transformation.h"
#include "terrain/part_of.h"

namespace frana {
namespace {

using gdal::extent_text;
using gdal::RasterFile;

[[noreturn]] void refuse_outside(const RasterFile& raster, const std::array<double, 4>& covers,
                                 const std::array<double, 4>& extent) {
    throw UserError(
        fmt::format("{}: covers {}, which does not touch {}; expected a raster on the terrain in use; "
                    "check its coordinates, its CRS ({}) and the window",
                    raster.file().string(), extent_text(covers), extent_text(extent),
                    raster.crs().IsEmpty() ? "none" : gdal::crs_name(raster.crs())));
}

/// The file's CRS is known and is not the terrain's.
bool needs_warp(const RasterFile& raster, const std::string& crs_wkt) {
    if (crs_wkt.empty() || raster.crs().IsEmpty() || raster.crs().IsLocal()) return false;
    return !gdal::same_crs(raster.crs(), gdal::crs_from_wkt(crs_wkt));
}

/// A raster without a CRS lies where its numbers say on the terrain's map.
void note_no_crs(const RasterFile& raster, const std::string& crs_wkt, std::vector<std::string>& log) {
    if (!crs_wkt.empty() && (raster.crs().IsEmpty() || raster.crs().IsLocal()))
        log.push_back(raster.name() + ": no CRS; coordinates are taken as the terrain's own");
}

gdal::Transformation transformation(const RasterFile& raster, const OGRSpatialReference& from,
                                    const OGRSpatialReference& to, const std::array<double, 4>& extent) {
    const gdal::Messages messages;
    gdal::Transformation made = gdal::transformation(from, to, extent);
    if (!made)
        throw UserError(fmt::format("{}: cannot be brought from {} to {} ({}); reproject it with gdalwarp -t_srs",
                                    raster.file().string(), gdal::crs_name(from), gdal::crs_name(to),
                                    messages.reason("no transformation known")));
    return made;
}

/// The pixels of the file that can matter in `extent` of the other CRS, as a dataset in memory.
class Source {
public:
    Source(const RasterFile& raster, const OGRSpatialReference& target, const std::array<double, 4>& extent) {
        const auto back = transformation(raster, target, raster.crs(), extent);
        const gdal::Messages messages;
        double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
        if (!back->TransformBounds(extent[0], extent[1], extent[2], extent[3], &x0, &y0, &x1, &y1, 21))
            refuse_outside(raster, raster.extent(), extent);
        constexpr double support = 4.0;  // pixels around, for the interpolation
        const double dx = raster.x_axis().size, dy = raster.y_axis().size;
        if (gdal::touched(raster.x_axis(), x0, x1)[1] == 0 || gdal::touched(raster.y_axis(), y0, y1)[1] == 0)
            refuse_outside(raster, raster.extent(), {x0, y0, x1, y1});
        const auto [i, nx] = gdal::touched(raster.x_axis(), x0 - support * dx, x1 + support * dx);
        const auto [j, ny] = gdal::touched(raster.y_axis(), y0 - support * dy, y1 + support * dy);
        values_ = raster.read(i, j, nx, ny);
        x_ = {nx, raster.x_axis().start + double(i) * dx, dx}, y_ = {ny, raster.y_axis().start + double(j) * dy, dy};
        dataset_ = in_memory(raster, x_, y_, values_);
        dataset_->GetRasterBand(1)->SetNoDataValue(Raster::nodata);
        set_pixel_edge(raster, target, x_.start + 0.5 * dx * double(nx), y_.start + 0.5 * dy * double(ny));
    }
    GDALDataset& dataset() { return *dataset_; }
    /// 1 where a pixel has a value and 0 elsewhere, also around the pixels for at least a cell of the target [m].
    gdal::Dataset where_known(const RasterFile& raster, double cell) const {
        const Index ring = 2 + Index(std::ceil(cell / edge_));
        const PixelAxis x{x_.count + 2 * ring, x_.start - double(ring) * x_.size, x_.size},
            y{y_.count + 2 * ring, y_.start - double(ring) * y_.size, y_.size};
        std::vector<double> known(std::size_t(x.count * y.count), 0.0);
        for (Index j = 0; j < y_.count; ++j)
            for (Index i = 0; i < x_.count; ++i)
                if (!std::isnan(values_[std::size_t(j * x_.count + i)]))
                    known[std::size_t((j + ring) * x.count + i + ring)] = 1.0;
        return in_memory(raster, x, y, known);
    }
    /// Edge of a square of the target's map with the area of one pixel.
    double pixel_edge() const { return edge_; }

private:
    static gdal::Dataset in_memory(const RasterFile& raster, const PixelAxis& x, const PixelAxis& y,
                                   std::vector<double> values) {
        const int nx = int(x.count), ny = int(y.count);
        auto* memory = GetGDALDriverManager()->GetDriverByName("MEM");
        gdal::Dataset dataset(memory->Create("", nx, ny, 1, GDT_Float64, nullptr));
        expect(dataset != nullptr, "a raster in memory");
        double south_up[6] = {x.start, x.size, 0.0, y.start, 0.0, y.size};
        dataset->SetGeoTransform(south_up);
        dataset->SetSpatialRef(&raster.crs());
        const CPLErr written = dataset->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, nx, ny, values.data(), nx, ny,
                                                                   GDT_Float64, 0, 0, nullptr);
        expect(written == CE_None, "a raster in memory takes its pixels");
        return dataset;
    }
    void set_pixel_edge(const RasterFile& raster, const OGRSpatialReference& target, double x, double y) {
        const auto forth = transformation(raster, raster.crs(), target, raster.extent());
        double xs[] = {x, x + raster.x_axis().size, x}, ys[] = {y, y, y + raster.y_axis().size};
        if (!forth->Transform(3, xs, ys)) refuse_outside(raster, raster.extent(), raster.extent());
        edge_ = std::sqrt(std::abs((xs[1] - xs[0]) * (ys[2] - ys[0]) - (xs[2] - xs[0]) * (ys[1] - ys[0])));
    }
    PixelAxis x_, y_;
    std::vector<double> values_;
    gdal::Dataset dataset_;
    double edge_ = 0.0;
};

/// A raster in memory on `grid` of another CRS. `nodata`: pixels without a number are left out.
std::vector<double> warped_values(const RasterFile& raster, GDALDataset& source, const GridGeometry& grid,
                                  const std::string& crs_wkt, const std::string& method, bool nodata) {
    const auto e = grid.pixel_extent();
    const auto number = [](double v) { return fmt::format("{:.17g}", v); };
    const gdal::Messages messages;
    std::vector<std::string> options{"-of",
                                     "MEM",
                                     "-ot",
                                     "Float64",
                                     "-t_srs",
                                     crs_wkt,
                                     "-r",
                                     method,
                                     "-et",
                                     "0",
                                     "-te",
                                     number(e[0]),
                                     number(e[1]),
                                     number(e[2]),
                                     number(e[3]),
                                     "-ts",
                                     std::to_string(grid.nx),
                                     std::to_string(grid.ny)};
    if (nodata) options.insert(options.end(), {"-srcnodata", "nan", "-dstnodata", "nan"});
    const gdal::Dataset result = gdal::warp("", source, options);
    std::vector<double> values(std::size_t(grid.size()), Raster::nodata);
    const int nx = int(grid.nx), ny = int(grid.ny);
    double* last_row = values.data() + (grid.ny - 1) * grid.nx;
    if (!result || result->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, nx, ny, last_row, nx, ny, GDT_Float64, 0,
                                                      -GSpacing(sizeof(double)) * nx, nullptr) != CE_None)
        throw UserError(fmt::format("{}: cannot be reprojected to the terrain's CRS ({}); reproject it with gdalwarp",
                                    raster.file().string(), messages.reason("no reason given")));
    return values;
}

/// The file on `grid` of another CRS. As in the file's own CRS, half of a value's weight has to lie on pixels with one.
Raster warped(const RasterFile& raster, Source& source, const GridGeometry& grid, const std::string& crs_wkt,
              const std::string& method) {
    constexpr double least_share = 0.5 - 1e-6;
    Raster out;
    out.geometry = grid;
    out.values = warped_values(raster, source.dataset(), grid, crs_wkt, method, true);
    if (method != "near") {
        const gdal::Dataset known = source.where_known(raster, grid.cell);
        const std::vector<double> share = warped_values(raster, *known, grid, crs_wkt, method, false);
        for (std::size_t k = 0; k < share.size(); ++k)
            if (!(share[k] >= least_share)) out.values[k] = Raster::nodata;
    }
    out.crs_wkt = crs_wkt;
    out.source = raster.file().string();
    return out;
}

/// A file that ends before the grid does is a remark, not an error. A depth is often given where it is not zero.
void note_gaps(const RasterFile& raster, const GridGeometry& grid, std::vector<std::string>& log) {
    const auto has = raster.extent(), wants = grid.pixel_extent();
    const double slack = 0.5 * grid.cell;
    if (has[0] > wants[0] + slack || has[1] > wants[1] + slack || has[2] < wants[2] - slack ||
        has[3] < wants[3] - slack)
        log.push_back(fmt::format("{}: covers {} only, not all of {}; no data beyond", raster.name(), extent_text(has),
                                  extent_text(wants)));
}

/// In the file's own pixels or, by that method, in square ones of another CRS.
Raster in_pixels(const std::filesystem::path& file, const std::array<double, 4>& extent, const std::string& crs_wkt,
                 const char* method, std::vector<std::string>& log) {
    const RasterFile raster(file, gdal::Meaning::any, log);
    note_no_crs(raster, crs_wkt, log);
    if (needs_warp(raster, crs_wkt)) {
        Source source(raster, gdal::crs_from_wkt(crs_wkt), extent);
        const double edge = source.pixel_edge();
        const auto nx = Index(std::ceil((extent[2] - extent[0]) / edge)),
                   ny = Index(std::ceil((extent[3] - extent[1]) / edge));
        log.push_back(fmt::format("{}: reprojected from {} to {:.6g} m pixels in the terrain's CRS", raster.name(),
                                  gdal::crs_name(raster.crs()), edge));
        return warped(raster, source, {nx, ny, extent[0] + 0.5 * edge, extent[1] + 0.5 * edge, edge}, crs_wkt, method);
    }
    const auto [i, nx] = gdal::touched(raster.x_axis(), extent[0], extent[2]);
    const auto [j, ny] = gdal::touched(raster.y_axis(), extent[1], extent[3]);
    if (nx == 0 || ny == 0) refuse_outside(raster, raster.extent(), extent);
    if (!raster.square()) {
        const double edge = std::min(raster.x_axis().size, raster.y_axis().size);
        throw UserError(
            fmt::format("{}: its pixels are {:g} m by {:g} m; expected square pixels; run: gdalwarp -tr "
                        "{:.12g} {:.12g} -r bilinear -ot Float32 -dstnodata -9999 {} {}",
                        file.string(), raster.x_axis().size, raster.y_axis().size, edge, edge,
                        shell_word(file.string()), shell_word(gdal::sibling(file, "_square"))));
    }
    Raster out = raster.read_raster(i, j, nx, ny);
    if (out.crs_wkt.empty()) out.crs_wkt = crs_wkt;
    return out;
}

}  // namespace

void GdalReader::require_metres(const std::filesystem::path& file) const {
    std::vector<std::string> said_when_it_is_read;
    const RasterFile raster(file, gdal::Meaning::any, said_when_it_is_read);
    gdal::require_metre_values({file, &raster.crs(), {}, raster.unit(), raster.scaled()});
}

std::string GdalReader::unit_of(const std::filesystem::path& file) const {
    std::vector<std::string> said_when_it_is_read;
    return RasterFile(file, gdal::Meaning::any, said_when_it_is_read).unit();
}

RasterPlace GdalReader::place_of(const std::filesystem::path& file, const std::array<double, 4>& extent,
                                 const std::string& crs_wkt) const {
    std::vector<std::string> said_when_it_is_read;
    const RasterFile raster(file, gdal::Meaning::any, said_when_it_is_read);
    if (needs_warp(raster, crs_wkt)) return {true, true};
    return {gdal::touched(raster.x_axis(), extent[0], extent[2])[1] > 0 &&
                gdal::touched(raster.y_axis(), extent[1], extent[3])[1] > 0,
            false};
}

std::optional<std::array<double, 4>> GdalReader::extent_above_zero(const std::filesystem::path& file,
                                                                   const std::array<double, 4>& extent,
                                                                   const std::string& crs_wkt) const {
    constexpr Index kRows = 64;
    std::vector<std::string> said_when_it_is_read;
    const RasterFile raster(file, gdal::Meaning::any, said_when_it_is_read);
    if (needs_warp(raster, crs_wkt)) return {};
    const auto [i0, nx] = gdal::touched(raster.x_axis(), extent[0], extent[2]);
    const auto [j0, ny] = gdal::touched(raster.y_axis(), extent[1], extent[3]);
    if (nx == 0 || ny == 0) return {};
    NodeBox box;
    for (Index row = 0; row < ny; row += kRows) {
        const Index rows = std::min(kRows, ny - row);
        const std::vector<double> values = raster.read(i0, j0 + row, nx, rows);
        for (std::size_t k = 0; k < values.size(); ++k)
            if (values[k] > 0.0) {
                const Index at = static_cast<Index>(k);
                box = united(box, {i0 + at % nx, j0 + row + at / nx, 1, 1});
            }
    }
    if (box.nx == 0) return {};
    const auto edge = [](const PixelAxis& axis, Index n) { return axis.start + axis.size * static_cast<double>(n); };
    return {{edge(raster.x_axis(), box.i0), edge(raster.y_axis(), box.j0), edge(raster.x_axis(), box.i0 + box.nx),
             edge(raster.y_axis(), box.j0 + box.ny)}};
}

Raster GdalReader::read_raster(const std::filesystem::path& file, const std::array<double, 4>& extent,
                               const std::string& crs_wkt, std::vector<std::string>& log) const {
    return in_pixels(file, extent, crs_wkt, "bilinear", log);
}

Raster GdalReader::read_mask(const std::filesystem::path& file, const std::array<double, 4>& extent,
                             const std::string& crs_wkt, std::vector<std::string>& log) const {
    return in_pixels(file, extent, crs_wkt, "near", log);
}

Raster GdalReader::read_onto(const std::filesystem::path& file, const GridGeometry& grid, const std::string& crs_wkt,
                             std::vector<std::string>& log) const {
    const RasterFile raster(file, gdal::Meaning::any, log);
    note_no_crs(raster, crs_wkt, log);
    if (needs_warp(raster, crs_wkt)) {
        Source source(raster, gdal::crs_from_wkt(crs_wkt), grid.pixel_extent());
        log.push_back(fmt::format("{}: reprojected from {} to the terrain's CRS and {:.6g} m cells", raster.name(),
                                  gdal::crs_name(raster.crs()), grid.cell));
        return warped(raster, source, grid, crs_wkt, grid.cell > 1.5 * source.pixel_edge() ? "average" : "bilinear");
    }
    const auto wants = grid.pixel_extent();
    if (gdal::touched(raster.x_axis(), wants[0], wants[2])[1] == 0 ||
        gdal::touched(raster.y_axis(), wants[1], wants[3])[1] == 0)
        refuse_outside(raster, raster.extent(), wants);
    Raster out;
    out.geometry = grid;
    out.values = gdal::onto_grid(raster, grid);
    out.crs_wkt = crs_wkt.empty() ? gdal::horizontal_wkt(raster.crs()) : crs_wkt;
    out.source = file.string();
    if (std::abs(raster.x_axis().size - grid.cell) > 1e-6 * grid.cell || !raster.square())
        log.push_back(raster.name() + ": " + gdal::how_resampled(raster, grid.cell));
    note_gaps(raster, grid, log);
    return out;
}

std::string gdal_version() { return GDALVersionInfo("RELEASE_NAME"); }

}  // namespace frana
