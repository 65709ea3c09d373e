#pragma once
// A case that needs no GIS to write, and the program called on it.
#include <filesystem>
#include <sstream>
#include <string>

#include "base/atomic_file.h"
#include "program.h"

/// A plane of 30 x 20 nodes, 5 m apart, with a release; files that need no GIS to write.
class PlaneCase {
public:
    PlaneCase() {
        std::ostringstream dem;
        dem << "ncols 30\nnrows 20\nxllcorner 0\nyllcorner 0\ncellsize 5\nNODATA_value -9999\n";
        for (int row = 0; row < 20; ++row)
            for (int column = 0; column < 30; ++column) dem << 100.0 - 0.5 * column << (column < 29 ? ' ' : '\n');
        frana::write_text(folder_.path() / "dem.asc", dem.str());
        frana::write_text(folder_.path() / "release.geojson",
                          R"({"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {},
                          "geometry": {"type": "Polygon", "coordinates":
                          [[[20, 30], [50, 30], [50, 70], [20, 70], [20, 30]]]}}]})");
        write("");
    }
    void write(const std::string& rest) const {
        frana::write_text(file(),
                          "[terrain]\ndem = \"dem.asc\"\n[[release]]\noutline = \"release.geojson\"\n"
                          "depth = 1.5\n[time]\nend = 2\n" +
                              rest);
    }
    std::filesystem::path file() const { return folder_.path() / "case.toml"; }
    const std::filesystem::path& folder() const { return folder_.path(); }

    /// Calls the program, which is built beside this test; CASE in the arguments stands for the case file.
    Outcome frana(std::string arguments) const {
        const std::size_t place = arguments.find("CASE");
        if (place != std::string::npos) arguments.replace(place, 4, file().string());
        return call_frana(folder(), arguments);
    }

private:
    FreshFolder folder_;
};
