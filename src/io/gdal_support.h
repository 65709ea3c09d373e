#pragma once
// What every use of GDAL here needs: drivers registered once, owned handles, and messages that reach us
// instead of stderr. Not for callers outside src/io: GDAL's own types stay in this room.
#include <gdal_priv.h>
#include <gdal_utils.h>
#include <ogrsf_frmts.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace frana::gdal {

/// Collects what GDAL, OGR and PROJ say on this thread while it lives; nothing of it reaches stderr.
class Messages {
public:
    Messages();
    ~Messages();
    Messages(const Messages&) = delete;
    Messages& operator=(const Messages&) = delete;
    bool failed() const { return failed_; }
    /// First line of the first failure, else of the last warning; `otherwise` when GDAL said nothing.
    std::string reason(const std::string& otherwise) const;
    /// Last warning, such as why a polygon is not valid; empty when there was none.
    const std::string& warning() const { return warning_; }
    void clear();

private:
    static void CPL_STDCALL hear(CPLErr kind, CPLErrorNum number, const char* text);
    bool failed_ = false;
    std::string failure_;
    std::string warning_;
};

struct CloseDataset {
    void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};
using Dataset = std::unique_ptr<GDALDataset, CloseDataset>;

struct DestroyTransformation {
    void operator()(OGRCoordinateTransformation* t) const { OGRCoordinateTransformation::DestroyCT(t); }
};
using Transformation = std::unique_ptr<OGRCoordinateTransformation, DestroyTransformation>;

/// Registers GDAL's drivers; cheap after the first call.
void register_drivers();

/// Opens for reading as raster (GDAL_OF_RASTER) or vector (GDAL_OF_VECTOR). UserError: no such file, or no
/// file of that kind, with GDAL's reason.
Dataset open(const std::filesystem::path& file, unsigned kind);

/// gdalwarp with the arguments of its command line, from a dataset into a new one. ("MEM" format: `target` is a mere
/// name.) Null when it fails; the reason is in the Messages that are alive.
Dataset warp(const std::string& target, GDALDataset& source, const std::vector<std::string>& arguments);

/// A name in GDAL's memory ("/vsimem/...") that no other has: several runs may live in one process.
std::string name_in_memory(const std::string& end);
/// The bytes of a file that GDAL made in its memory ("/vsimem/..."), which is freed. None where there is no such file.
std::string taken_from_memory(const std::string& held);

/// dem.tif, "_utm" -> dem_utm.tif: a name next to the file for the line that cures it. Always a GeoTIFF.
std::string sibling(const std::filesystem::path& file, const std::string& suffix);

}  // namespace frana::gdal
