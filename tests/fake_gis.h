#pragma once
// Files of a GIS that exist in memory only, by the last part of their name.
#include <cmath>
#include <functional>
#include <map>

#include "base/error.h"
#include "scene/toolbox.h"

/// Rasters and polygons by file name; any other name is a UserError. Nothing is resampled: a DEM is cut to
/// nothing, and read_onto takes the pixel at each node.
class FakeGis : public frana::GisReader {
public:
    std::map<std::string, frana::Raster> rasters;
    std::map<std::string, frana::Polygons> polygons;
    std::map<std::string, std::vector<frana::Polyline>> lines;
    std::map<std::string, std::vector<double>> attributes;  ///< of the polygons of any file

    frana::Raster read_dem(const std::filesystem::path& file, const frana::DemRequest&,
                           std::vector<std::string>&) const override {
        return raster(file);
    }
    /// Only of this one, which has to stay.
    std::shared_ptr<const frana::GisReader> lasting() const override { return {std::shared_ptr<void>(), this}; }
    frana::RasterPlace place_of(const std::filesystem::path& file, const std::array<double, 4>& extent,
                                const std::string&) const override {
        const auto has = raster(file).geometry.pixel_extent();
        return {has[0] < extent[2] && has[2] > extent[0] && has[1] < extent[3] && has[3] > extent[1], false};
    }
    frana::Raster read_raster(const std::filesystem::path& file, const std::array<double, 4>& extent,
                              const std::string& crs, std::vector<std::string>&) const override {
        if (!place_of(file, extent, crs).touches) throw frana::UserError(file.string() + ": does not touch it");
        return raster(file);
    }
    frana::Raster read_onto(const std::filesystem::path& file, const frana::GridGeometry& grid, const std::string&,
                            std::vector<std::string>&) const override {
        const frana::Raster source = raster(file);
        frana::Raster result = frana::Raster::filled(grid, frana::Raster::nodata);
        for (frana::Index j = 0; j < grid.ny; ++j) {
            for (frana::Index i = 0; i < grid.nx; ++i) {
                const auto c = std::lround((grid.x(i) - source.geometry.x0) / source.geometry.cell);
                const auto r = std::lround((grid.y(j) - source.geometry.y0) / source.geometry.cell);
                const bool inside = c >= 0 && r >= 0 && c < source.geometry.nx && r < source.geometry.ny;
                if (inside) result.at(i, j) = source.at(c, r);
            }
        }
        return result;
    }
    frana::Polygons read_polygons(const std::filesystem::path& file, const std::string&,
                                  std::vector<std::string>&) const override {
        const auto found = polygons.find(file.filename().string());
        if (found == polygons.end()) throw frana::UserError(file.string() + ": no such polygons");
        return found->second;
    }
    frana::ValuedPolygons read_valued_polygons(const std::filesystem::path& file, const std::string& attribute,
                                               const std::string& crs, std::vector<std::string>& log) const override {
        const auto found = attributes.find(attribute);
        if (found == attributes.end()) throw frana::UserError(file.string() + ": no such attribute");
        return {read_polygons(file, crs, log), found->second};
    }
    std::vector<frana::Polyline> read_lines(const std::filesystem::path& file, const std::string&,
                                            std::vector<std::string>&) const override {
        const auto found = lines.find(file.filename().string());
        return found == lines.end() ? std::vector<frana::Polyline>() : found->second;
    }

private:
    frana::Raster raster(const std::filesystem::path& file) const {
        const auto found = rasters.find(file.filename().string());
        if (found == rasters.end()) throw frana::UserError(file.string() + ": no such raster");
        return found->second;
    }
};

/// A raster of f(x, y) at the nodes.
inline frana::Raster sampled(const frana::GridGeometry& grid, const std::function<double(double, double)>& f) {
    frana::Raster raster = frana::Raster::filled(grid, 0.0);
    for (frana::Index j = 0; j < grid.ny; ++j)
        for (frana::Index i = 0; i < grid.nx; ++i) raster.at(i, j) = f(grid.x(i), grid.y(j));
    return raster;
}

/// A rectangle as one polygon.
inline frana::Polygons rectangle(double x0, double y0, double x1, double y1) {
    frana::Polygons result;
    result.parts.push_back({{{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}}});
    result.source = "rectangle";
    return result;
}
