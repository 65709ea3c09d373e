// Largest speeds at gauges, which a run, an ensemble and a calibration tell alike.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/atomic_file.h"
#include "catch.h"
#include "observe/table.h"
#include "plane_case.h"
#include "pond.h"

namespace fs = std::filesystem;

namespace {

/// The largest speed of a gauge's table, of what is deeper.
double fastest(const fs::path& csv, double deeper) {
    const frana::Table series = frana::read_table(csv);
    double most = 0.0;
    for (std::size_t k = 0; k < series.column("t").size(); ++k)
        if (series.column("depth")[k] >= deeper) most = std::max(most, series.column("speed")[k]);
    return most;
}

}  // namespace

TEST_CASE("A gauge's largest speed is that of a run's report, also where the flow is shallow", "[ensemble]") {
    const PlaneCase plane;
    // What comes first is shallow and fast.
    plane.write(
        "[material.bed]\nlaw = \"coulomb\"\nmu = 0.05\n[[gauge]]\nname = \"front\"\npoint = [90, 50]\n"
        "[survey]\nfootprint = \"release.geojson\"\n");
    std::string text = text_of(plane.file());
    frana::write_text(plane.file(), text.replace(text.find("end = 2"), 7, "end = 9"));
    const auto table_of_run = [&](double mu) {
        const std::string run = fmt::format("run_{}", mu);
        REQUIRE(plane
                    .frana("run CASE --quiet --set 'output.formats=[]' --out " + run +
                           fmt::format(" --set material.bed.mu={}", mu))
                    .code == 0);
        return plane.folder() / run / "gauges" / "front.csv";
    };
    constexpr double counts = 0.01;  // a tenth of output.footprint_depth, as the report of a run says
    const fs::path truth = table_of_run(0.05);
    const double speed = fastest(truth, counts);
    REQUIRE(speed > 1.02 * fastest(truth, 0.1));  // of what is deeper than the footprint's depth it is another one

    SECTION("of an ensemble") {
        frana::write_text(plane.folder() / "many.toml",
                          "[ensemble]\ncase = \"case.toml\"\nmethod = \"table\"\ntable = \"rows.csv\"\n");
        frana::write_text(plane.folder() / "rows.csv", "material.bed.mu\n0.05\n");
        REQUIRE(plane.frana("ensemble many.toml --out many --quiet").code == 0);
        const auto column = column_of(text_of(plane.folder() / "many/runs.csv"), "gauge_front_speed_m_s");
        CHECK(std::stod(column.at(0)) == Approx(speed).epsilon(1e-12));  // digits of the table
    }
    SECTION("of a calibration") {
        frana::write_text(plane.folder() / "find.toml",
                          "[calibrate]\nsamples = 4\nrounds = 1\nobjective = [\"gauges\"]\n"
                          "[[calibrate.vary]]\nkey = \"material.bed.mu\"\nrange = [0.04, 0.06]\n"
                          "[[event]]\ncase = \"case.toml\"\nname = \"slide\"\n"
                          "[[event.gauge]]\nname = \"front\"\nspeed = 4.0\n");
        REQUIRE(plane.frana("calibrate find.toml --out found --quiet").code == 0);
        const std::string runs = text_of(plane.folder() / "found/runs.csv");
        const double ours = fastest(table_of_run(std::stod(column_of(runs, "material.bed.mu").at(2))), counts);
        CHECK(std::stod(column_of(runs, "slide: gauges_rms").at(2)) ==
              Approx(std::abs(std::log(ours / 4.0))).epsilon(1e-9));
    }
}
