#include "particles/export.h"

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "terrain/bed_points.h"

namespace frana {

namespace {

std::vector<double> interleaved(const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<double> pairs(2 * a.size());
    for (std::size_t p = 0; p < a.size(); ++p) {
        pairs[2 * p] = a[p];
        pairs[2 * p + 1] = b[p];
    }
    return pairs;
}

std::vector<double> masses(const SeedsExport& data) {
    std::vector<double> mass(data.seeds.volume);
    for (double& m : mass) m *= data.density;
    return mass;
}

}  // namespace

SeedsExport make_seeds_export(const Seeds& seeds, double density, const Raster& bed) {
    SeedsExport data{seeds, density, bed.crs_wkt, {}};
    data.elevation.reserve(seeds.x.size());
    for (std::size_t p = 0; p < seeds.x.size(); ++p) {
        data.elevation.push_back(bed_elevation(bed, seeds.x[p], seeds.y[p]));
        if (!std::isfinite(data.elevation.back()))
            throw UserError(
                fmt::format("particle {} at x = {:.2f}, y = {:.2f} stands outside the elevation model {} or on "
                            "its nodata; move the release",
                            p, seeds.x[p], seeds.y[p], bed.source));
    }
    return data;
}

std::vector<SeedsColumn> seeds_columns(const SeedsExport& data) {
    const Seeds& seeds = data.seeds;
    std::vector<SeedsColumn> columns{
        {"position", "m", 2, interleaved(seeds.x, seeds.y)},
        {"elevation", "m", 1, data.elevation},
        {"depth", "m", 1, seeds.depth},
        {"size", "m", 1, seeds.size},
        {"velocity", "m/s", 2, interleaved(seeds.vx, seeds.vy)},
        {"volume", "m3", 1, seeds.volume},
        {"mass", "kg", 1, masses(data)},
    };
    for (const SeedsColumn& column : columns) {
        expect(column.values.size() == column.components * seeds.x.size(), "seed columns have equal lengths");
        for (const double value : column.values) expect(std::isfinite(value), "seeds are finite numbers");
    }
    return columns;
}

PointTable seeds_table(const SeedsExport& data, const std::vector<SeedsColumn>& columns) {
    PointTable table;
    table.format = "frana particles 1";
    table.crs_wkt = data.crs_wkt;
    table.constants = {{"density", "kg/m3", data.density}};
    table.count = data.seeds.x.size();
    for (const SeedsColumn& column : columns) {
        std::vector<std::string> heads{column.name};
        if (column.name == "position") heads = {"x", "y"};
        if (column.name == "velocity") heads = {"vx", "vy"};
        table.columns.push_back({column.name, column.unit, heads, column.values.data()});
    }
    return table;
}

void write_seeds_csv(const std::filesystem::path& file, const SeedsExport& data) {
    const std::vector<SeedsColumn> columns = seeds_columns(data);
    write_points_csv(file, seeds_table(data, columns));
}

void write_seeds_json(const std::filesystem::path& file, const SeedsExport& data) {
    const std::vector<SeedsColumn> columns = seeds_columns(data);
    write_points_json(file, seeds_table(data, columns));
}

}  // namespace frana
