#pragma once
// A case whose maps are known, and the program called on it.
#include <fmt/format.h>

#include <filesystem>
#include <sstream>
#include <string>

#include "base/atomic_file.h"
#include "io/gdal_reader.h"
#include "program.h"

/// A column of a table with commas, without its name.
inline std::vector<std::string> column_of(const std::string& table, const std::string& name) {
    std::istringstream rows(table);
    std::vector<std::string> values;
    std::string row, field;
    std::getline(rows, row);
    std::istringstream head(row);
    std::size_t place = 0;
    while (std::getline(head, field, ',') && field != name) ++place;
    REQUIRE(field == name);
    while (std::getline(rows, row)) {
        std::istringstream fields(row);
        for (std::size_t k = 0; k <= place; ++k)
            if (!std::getline(fields, field, ',')) field.clear();
        values.push_back(field);
    }
    return values;
}

/// A level pond between walls: whatever depth is released stays as it is, everywhere. So the maps are those of the depth.
class Pond {
public:
    Pond() {
        std::string dem = "ncols 12\nnrows 12\nxllcorner 0\nyllcorner 0\ncellsize 5\nNODATA_value -9999\n";
        for (int row = 0; row < 12; ++row) dem += "0 0 0 0 0 0 0 0 0 0 0 0\n";
        write("dem.asc", dem);
        outline("all.geojson", 57.5);
        outline("west.geojson", 27.5);
        write("case.toml",
              "[terrain]\ndem = \"dem.asc\"\n[[release]]\noutline = \"all.geojson\"\ndepth = 1.5\n[time]\nend = 0.5\n"
              "[boundary]\nsides = \"wall\"\n[output]\nfootprint_depth = 0.1\n");
    }
    void write(const std::string& name, const std::string& text) const { frana::write_text(path(name), text); }
    std::filesystem::path path(const std::string& name) const { return folder_.path() / name; }
    Outcome frana(const std::string& arguments) const { return call_frana(folder_.path(), arguments); }
    /// A column of runs.csv, by sample.
    std::vector<std::string> column(const std::string& folder, const std::string& name) const {
        return column_of(text_of(path(folder) / "runs.csv"), name);
    }
    frana::Raster map(const std::string& folder, const std::string& name) const {
        std::vector<std::string> log;
        return frana::GdalReader().read_raster(path(folder) / "rasters" / (name + ".tif"), {0.0, 0.0, 60.0, 60.0}, "",
                                               log);
    }

private:
    void outline(const std::string& name, double east) const {
        write(name,
              fmt::format(R"({{"type": "Polygon", "coordinates": [[[2.5, 2.5], [{0}, 2.5], [{0}, 57.5], [2.5, 57.5],
                               [2.5, 2.5]]]}})",
                          east));
    }
    FreshFolder folder_;
};
