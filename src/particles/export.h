#pragma once
// Particles for other programs, as text. HDF5 and VTK live in io/hdf5_seeds.h and vtk_io/seeds_vtp.h.
#include <filesystem>
#include <string>
#include <vector>

#include "base/point_table.h"
#include "particles/seeds.h"
#include "terrain/raster.h"

namespace frana {

/// What every exporter gets; `seeds` is borrowed.
struct SeedsExport {
    const Seeds& seeds;
    double density = 1000.0;        ///< [kg/m^3]; mass = density * volume
    std::string crs_wkt;            ///< WKT2 of the map coordinates, empty when unknown
    std::vector<double> elevation;  ///< bed elevation at each particle [m]
};

/// Gathers the export; the elevation is bilinear between the nodes of `bed`, whose CRS is taken.
/// Throws UserError when a particle stands outside the nodes or on nodata.
SeedsExport make_seeds_export(const Seeds& seeds, double density, const Raster& bed);

/// One quantity of all particles; components interleaved.
struct SeedsColumn {
    std::string name;  ///< position, velocity, elevation, depth, size, volume, mass
    std::string unit;  ///< "m", "m/s", "m3", "kg"
    int components = 1;
    std::vector<double> values;
};

/// The quantities that every format holds, besides the id 0, 1, ... Throws InternalError on a number that is not
/// finite, so that none reaches a file.
std::vector<SeedsColumn> seeds_columns(const SeedsExport& data);

/// The same as a table that writers take; `columns` is what seeds_columns() gave and must outlive it.
PointTable seeds_table(const SeedsExport& data, const std::vector<SeedsColumn>& columns);

/// Text table with the header id,x,y,elevation,depth,size,vx,vy,volume,mass; units m, m/s, m3, kg. Numbers
/// read back to the same bits. Throws UserError when the file cannot be written.
void write_seeds_csv(const std::filesystem::path& file, const SeedsExport& data);

/// One JSON object: format, count, density [kg/m3], crs_wkt, units (name: unit), id, and an array per column. Position
/// and velocity are arrays of pairs. Numbers read back to the same bits. Throws as above.
void write_seeds_json(const std::filesystem::path& file, const SeedsExport& data);

}  // namespace frana
