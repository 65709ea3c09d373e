// check_run RUN_DIR EXPECTED.csv: compares what a run left with the case's expected figures.
// Lines of EXPECTED.csv: quantity,value,tolerance,unit,source. A quantity is
//   budgets.mass.relative_error     a number of run.json; barriers.0.first_contact: of the first of a list
//   compare/iou                     a number of compare.json
//   convert/start/conservation.mass.relative_error   a number of convert/start.h5.conservation.json
//   table/insitu/stress.csv/depth_max/last   last (or first, or the largest absolute: max) number of a column of a table,
//                                   named without its unit
//   history/max_speed/max           largest absolute value (or: last) of a column of history.csv
//   profile/x675/length/last        of a profile, last (or first) output: way from the first to the last
//                                   station deeper than 0.1 m; gap: widest way between two of them; depth
//   raster/final_depth/mirror_y     largest difference between a raster and its north-south mirror image
//   raster/final_depth-final_water_depth/quantile_x/0.5   of a raster, or of one less another: x of a line from south to
//                                   north, west of which that share of its sum lies
#include <gdal_priv.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using Row = std::vector<std::string>;

Row split(const std::string& line, char separator) {
    Row parts;
    std::stringstream stream(line);
    for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
    return parts;
}

std::vector<Row> read_csv(const std::filesystem::path& file) {
    std::ifstream stream(file);
    if (!stream) throw std::runtime_error(file.string() + ": is not there");
    std::vector<Row> rows;
    for (std::string line; std::getline(stream, line);)
        if (!line.empty()) rows.push_back(split(line, ','));
    if (rows.size() < 2) throw std::runtime_error(file.string() + ": has no lines");
    return rows;
}

double from_json(const std::filesystem::path& file, const std::string& quantity) {
    std::ifstream stream(file);
    if (!stream) throw std::runtime_error(file.string() + ": is not there");
    nlohmann::json value = nlohmann::json::parse(stream);
    for (const std::string& key : split(quantity, '.'))
        value = value.is_array() ? nlohmann::json(value.at(std::stoul(key))) : nlohmann::json(value.at(key));
    return value.get<double>();
}

double largest_of(const std::vector<Row>& rows, std::size_t place) {
    double largest = 0.0;
    for (std::size_t i = 1; i < rows.size(); ++i) largest = std::max(largest, std::abs(std::stod(rows[i].at(place))));
    return largest;
}

double from_history(const std::filesystem::path& run, const Row& path) {
    const std::vector<Row> rows = read_csv(run / "history.csv");
    const auto column = std::find(rows[0].begin(), rows[0].end(), path.at(1));
    if (column == rows[0].end()) throw std::runtime_error("history.csv has no column " + path.at(1));
    const auto place = static_cast<std::size_t>(column - rows[0].begin());
    if (path.at(2) == "last") return std::stod(rows.back().at(place));
    if (path.at(2) != "max") throw std::runtime_error(path.at(2) + ": expected max or last");
    return largest_of(rows, place);
}

double from_table(const std::filesystem::path& run, const Row& path) {
    const std::vector<Row> rows = read_csv(run / path.at(1) / path.at(2));
    const auto column = std::find_if(rows[0].begin(), rows[0].end(),
                                     [&](const std::string& name) { return name.rfind(path.at(3) + " [", 0) == 0; });
    if (column == rows[0].end()) throw std::runtime_error(path.at(2) + " has no column " + path.at(3));
    const auto place = static_cast<std::size_t>(column - rows[0].begin());
    if (path.at(4) == "max") return largest_of(rows, place);
    const Row& row = path.at(4) == "first" ? rows[1] : rows.back();
    return std::stod(row.at(place));
}

/// Columns of a profile: t, distance, x, y, bed, depth, ...
double from_profile(const std::filesystem::path& run, const Row& path) {
    const std::vector<Row> rows = read_csv(run / "profiles" / (path.at(1) + ".csv"));
    const std::string time = path.at(3) == "first" ? rows[1][0] : rows.back()[0];
    double begin = NAN, end = NAN, deepest = 0.0, gap = 0.0;
    for (std::size_t i = 1; i < rows.size(); ++i) {
        const double distance = std::stod(rows[i].at(1)), depth = std::stod(rows[i].at(5));
        if (rows[i][0] != time) continue;
        deepest = std::max(deepest, depth);
        if (depth <= 0.1) continue;
        if (std::isnan(begin)) begin = end = distance;
        gap = std::max(gap, distance - end);
        end = distance;
    }
    if (path.at(2) == "length") return end - begin;
    if (path.at(2) == "gap") return gap;
    if (path.at(2) != "depth") throw std::runtime_error(path.at(2) + ": expected length, gap or depth");
    return deepest;
}

struct Pixels {
    int nx = 0, ny = 0;
    double x0 = 0.0, width = 0.0;  ///< of the west side, of a pixel [m]
    std::vector<double> value;
    double at(int i, int j) const { return value[static_cast<std::size_t>(j * nx + i)]; }
};

Pixels read_raster(const std::filesystem::path& run, const std::string& name) {
    GDALAllRegister();
    const std::string file = (run / "rasters" / (name + ".tif")).string();
    const std::unique_ptr<GDALDataset, void (*)(GDALDataset*)> raster(GDALDataset::Open(file.c_str()),
                                                                      [](GDALDataset* dataset) { GDALClose(dataset); });
    if (!raster) throw std::runtime_error(file + ": cannot be read");
    Pixels p;
    p.nx = raster->GetRasterXSize(), p.ny = raster->GetRasterYSize();
    double place[6];
    p.value.resize(static_cast<std::size_t>(p.nx) * static_cast<std::size_t>(p.ny));
    if (raster->GetGeoTransform(place) != CE_None ||
        raster->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, p.nx, p.ny, p.value.data(), p.nx, p.ny, GDT_Float64, 0, 0) !=
            CE_None)
        throw std::runtime_error(file + ": cannot be read");
    const double nodata = raster->GetRasterBand(1)->GetNoDataValue();
    for (double& v : p.value)
        if (v == nodata) v = 0.0;  // where the flow never came
    p.x0 = place[0], p.width = place[1];
    return p;
}

double quantile_x(const Pixels& p, double share) {
    std::vector<double> sums(static_cast<std::size_t>(p.nx) + 1, 0.0);
    for (int i = 0; i < p.nx; ++i) {
        const std::size_t n = static_cast<std::size_t>(i);
        sums[n + 1] = sums[n];
        for (int j = 0; j < p.ny; ++j) sums[n + 1] += p.at(i, j);
    }
    const double wanted = share * sums.back();
    std::size_t n = 0;
    while (n + 2 < sums.size() && sums[n + 1] < wanted) ++n;
    if (!(sums[n + 1] > sums[n]))
        throw std::runtime_error("quantile_x: expected a raster with material and a share above 0");
    return p.x0 + p.width * (static_cast<double>(n) + (wanted - sums[n]) / (sums[n + 1] - sums[n]));
}

double from_raster(const std::filesystem::path& run, const Row& path) {
    const Row names = split(path.at(1), '-');
    const bool sums = path.at(2) == "quantile_x";
    Pixels p = read_raster(run, names.at(0));
    if (names.size() > 1) {
        const Pixels less = read_raster(run, names[1]);
        for (std::size_t n = 0; n < p.value.size(); ++n) p.value[n] -= less.value.at(n);
    }
    if (sums) return quantile_x(p, std::stod(path.at(3)));
    if (path.at(2) != "mirror_y") throw std::runtime_error(path.at(2) + ": expected quantile_x or mirror_y");
    double largest = 0.0;
    for (int j = 0; j < p.ny; ++j)
        for (int i = 0; i < p.nx; ++i) largest = std::max(largest, std::abs(p.at(i, j) - p.at(i, p.ny - 1 - j)));
    return largest;
}

double obtained(const std::filesystem::path& run, const std::string& quantity) {
    const Row path = split(quantity, '/');
    if (path[0] == "history") return from_history(run, path);
    if (path[0] == "profile") return from_profile(run, path);
    if (path[0] == "raster") return from_raster(run, path);
    if (path[0] == "table") return from_table(run, path);
    if (path[0] == "convert") return from_json(run / "convert" / (path.at(1) + ".h5.conservation.json"), path.at(2));
    if (path[0] == "compare") return from_json(run / "compare.json", path.at(1));
    return from_json(run / "run.json", quantity);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) return std::fprintf(stderr, "check_run RUN_DIR EXPECTED.csv\n"), 2;
    int failures = 0;
    try {
        const std::vector<Row> rows = read_csv(argv[2]);
        for (std::size_t i = 1; i < rows.size(); ++i) {
            const double value = std::stod(rows[i].at(1)), tolerance = std::stod(rows[i].at(2));
            const double found = obtained(argv[1], rows[i][0]);
            const bool good = std::abs(found - value) <= tolerance;  // false for NaN
            std::printf("%-6s %-40s expected %.10g +- %.3g %s, obtained %.10g\n", good ? "ok" : "FAILED",
                        rows[i][0].c_str(), value, tolerance, rows[i].at(3).c_str(), found);
            failures += good ? 0 : 1;
        }
    } catch (const std::exception& error) {
        return std::fprintf(stderr, "%s\n", error.what()), 1;
    }
    return failures == 0 ? 0 : 1;
}
