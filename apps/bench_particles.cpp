// Time and volume error of the particle generation on the test of Fois, de Falco, Formaggia (2025),
// section 4.1. It has 100 x 100 pixels of 1 m, h = 1 + 2 exp(-((x - 50)^2 + (y - 50)^2) / 150), 10^4 to 4 10^6
// particles.
//   frana_bench_particles [lattice|r2|slope]
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <exception>
#include <string>

#include "particles/generate.h"

namespace {

using namespace frana;

Raster hump() {
    Raster depth = Raster::filled({100, 100, 0.5, 0.5, 1.0}, 0.0);
    for (Index j = 0; j < 100; ++j)
        for (Index i = 0; i < 100; ++i) {
            const double x = depth.geometry.x(i) - 50.0, y = depth.geometry.y(j) - 50.0;
            depth.at(i, j) = 1.0 + 2.0 * std::exp(-(x * x + y * y) / 150.0);
        }
    return depth;
}

void measure(const std::string& name, Placement placement) {
    // The nodes stand on the pixel corners, so that the domain is exactly the image.
    Raster bed = Raster::filled({101, 101, 0.0, 0.0, 1.0}, 0.0);
    for (Index j = 0; j < 101; ++j)
        for (Index i = 0; i < 101; ++i) bed.at(i, j) = 20.0 * std::exp(-bed.geometry.x(i) / 30.0);
    Release release;
    release.depth_field = hump();
    fmt::print("{} placement\n{:>9} {:>9} {:>9} {:>9} {:>16} {:>13}\n", name, "asked", "placed", "wall [s]", "cpu [s]",
               "cpu ns/particle", "volume error");
    for (const Index count : {10000, 100000, 1000000, 4000000}) {
        double wall = 1e300, cpu = 1e300;  // the least of three: the machine may have other work
        std::vector<ReleaseReport> reports;
        for (int round = 0; round < 3; ++round) {
            std::vector<std::string> log;
            const std::clock_t cpu_start = std::clock();
            const auto start = std::chrono::steady_clock::now();
            const Seeds seeds = make_seeds({release}, bed, {4.0, count, placement}, reports, log);
            const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
            wall = std::min(wall, taken.count());
            cpu = std::min(cpu, static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC);
        }
        fmt::print("{:>9} {:>9} {:>9.3f} {:>9.3f} {:>16.1f} {:>13.1e}\n", count, reports[0].count, wall, cpu,
                   1e9 * cpu / static_cast<double>(reports[0].count), reports[0].relative_error);
    }
}

}  // namespace

int main(int argc, char** argv) {
    const std::string only = argc > 1 ? argv[1] : "";
    try {
        if (only.empty() || only == "lattice") measure("lattice", Placement::lattice);
        if (only.empty() || only == "r2") measure("r2", Placement::r2);
        if (only.empty() || only == "slope") measure("slope", Placement::slope);
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 1;
    }
    return 0;
}
