// ISeeSnow (Wirbel, Oesterle, Fischer et al.): one idealised track, twelve codes. Our run must lie within what they
// span, and its front beside their median (data read where it lies, skipped when absent).
#include <fmt/core.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "analytic_scene.h"
#include "catch.h"
#include "io/gdal_reader.h"
#include "scene/build_scene.h"
#include "shared_data.h"

using namespace frana;

namespace {

/// What the data set's reference_metrics.csv holds for each code.
struct Figures {
    double front = 0.0;  ///< farthest place with a peak thickness above 0.1 m, along the track from x = 1020 m
    double area = 0.0;   ///< of such places [m2]
    double thickness99 = 0.0, speed99 = 0.0;  ///< 99th percentiles of the peaks there [m], [m/s]
    double centre = 0.0;                      ///< x of the centre of mass at the end [m]
};

double percentile99(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values.at(static_cast<std::size_t>(0.99 * static_cast<double>(values.size() - 1)));
}

/// The release is the raster's cells, as the codes had it. Peak thickness normal to the slope: the codes report that one.
Figures figures_of(const Frame& frame, const Scene& scene) {
    const double* peak = frame.node("peak_depth")->data;
    const double* speed = frame.node("peak_speed")->data;
    const GridGeometry& g = frame.grid;
    std::vector<double> thicknesses, speeds;
    Figures f;
    for (Index j = 1; j + 1 < g.ny; ++j)
        for (Index i = 1; i + 1 < g.nx; ++i) {
            const double bx = (scene.bed.at(i + 1, j) - scene.bed.at(i - 1, j)) / (2 * g.cell);
            const double by = (scene.bed.at(i, j + 1) - scene.bed.at(i, j - 1)) / (2 * g.cell);
            const double thickness = peak[j * g.nx + i] / std::sqrt(1 + bx * bx + by * by);
            if (!(thickness > 0.1)) continue;
            thicknesses.push_back(thickness);
            speeds.push_back(speed[j * g.nx + i]);
            // The track's path: 1480 m to the east, then a bend of 0.42 degrees.
            f.front = std::max(f.front, 1480.0 + 0.99997 * (g.x(i) - 2500.0) + 0.00742 * (g.y(j) + 4250.0));
        }
    f.area = static_cast<double>(thicknesses.size()) * g.cell * g.cell;
    f.thickness99 = percentile99(thicknesses);
    f.speed99 = percentile99(speeds);
    const Field &position = *frame.particle("position"), &mass = *frame.particle("mass");
    double sum = 0.0;
    for (Index p = 0; p < mass.count; ++p) {
        f.centre += mass.data[p] * position.data[3 * p];
        sum += mass.data[p];
    }
    f.centre /= sum;
    return f;
}

Figures run(const std::filesystem::path& folder, const std::string& law, const std::string& curvature,
            double rest_fraction) {
    const std::string text = fmt::format(R"(
        terrain = {{ dem = "{0}/dem.tif", curvature = "{2}" }}
        material.density = 200.0
        material.bed = {1}
        time = {{ end = 400.0, stop_at_rest = true, rest_fraction = {3} }}
        [[release]]
        mask = "{0}/release.tif"
        depth = 1.5
        thickness = "normal"
    )",
                                         folder.string(), law, curvature, rest_fraction);
    const Scene scene = build_scene(CaseFile::parse(text, folder / "case.toml", {}), GdalReader());
    const auto simulation = make_simulation(scene);
    RestRule rest(scene.bed.geometry.cell, scene.rest_fraction);
    while (simulation->status().time < scene.end && !rest.at_rest()) {
        simulation->advance(scene.end);
        rest.note(*simulation);
    }
    return figures_of(simulation->frame(), scene);
}

/// [median, least, largest] of the codes.
std::array<double, 3> band(const std::filesystem::path& folder, const char* metric) {
    std::ifstream file(folder / "expected.json");
    return nlohmann::json::parse(file)["metrics"][metric].get<std::array<double, 3>>();
}

void check_within(double value, const std::array<double, 3>& codes, const char* what) {
    CAPTURE(what, value, codes[0]);
    CHECK(value >= codes[1]);
    CHECK(value <= codes[2]);
}

}  // namespace

// The front within two cells of the codes' median; the rest within their least and largest.
TEST_CASE("On ISeeSnow's track the flow ends near the median of twelve codes, with and without drag", "[real]") {
    for (const auto& [name, law] : {std::pair{"iseesnow_coulomb", R"({ law = "coulomb", mu = 0.4 })"},
                                    std::pair{"iseesnow_idealized", R"({ law = "voellmy", mu = 0.4, xi = 2000.0 })"}}) {
        const auto folder = shared_data(name);
        if (!folder) continue;
        const Figures f = run(*folder, law, "full", 0.05);
        UNSCOPED_INFO(fmt::format("{}: front {} m, area {} m2, p99 thickness {:.2f} m, p99 speed {:.1f} m/s", name,
                                  f.front, f.area, f.thickness99, f.speed99));
        CHECK(std::lround(std::abs(f.front - band(*folder, "front_s_m_pft>0.1")[0]) / 5.0) <= 2);  // cells
        check_within(f.area, band(*folder, "area_m2_pft>0.1"), "area");
        check_within(f.thickness99, band(*folder, "p99_pft_m"), "99th percentile of thickness");
        check_within(f.speed99, band(*folder, "p99_pfv_ms"), "99th percentile of speed");
        CHECK(f.speed99 < 1.1 * band(*folder, "p99_pfv_ms")[0]);  // one code's 298 m/s is an artefact of its thin cells
    }
}

// Without curvature in the friction the centre of mass must stop on the energy line: x = 1195.0 + 1369.2 / 0.4.
TEST_CASE("On ISeeSnow's track without curvature friction the centre of mass stops on the energy line", "[real]") {
    const auto folder = shared_data("iseesnow_coulomb");
    if (!folder) return;
    const Figures f = run(*folder, R"({ law = "coulomb", mu = 0.4 })", "inertia", 0.01);
    CAPTURE(f.centre);
    CHECK(std::abs(f.centre - 4618.0) <= 6.0);
}
