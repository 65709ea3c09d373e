// `frana bench`: cost of a step by phase, compared with what the machine can do, measured in the same process.
#include <fmt/core.h>

#include "base/atomic_file.h"
#include "checks/bench/print.h"
#include "frana_commands.h"
#include "io/xdmf_writer.h"
#include "vtk_io/writers.h"

namespace frana {

int bench_command(const BenchOptions& options) {
    bench::Options wanted;
    if (!options.particles.empty()) wanted.particles.assign(options.particles.begin(), options.particles.end());
    if (!options.threads.empty()) wanted.threads = options.threads;
    wanted.quick = options.quick;
    wanted.writers = {
        {bench::kGatedWriter, true, false, [](const auto& folder) { return make_xdmf_writer(folder); }},
        {"VTK, particles", true, false, [](const auto& folder) { return make_particle_writer(folder); }},
        {"VTK, grid", false, true, [](const auto& folder) { return make_grid_writer(folder); }},
        {"HDF5, particles and grid", true, true, [](const auto& folder) { return make_xdmf_writer(folder); }},
    };
    const bench::Report report = bench::run(wanted, [](const std::string& text) { fmt::print(stderr, "{}\n", text); });
    fmt::print("{}", bench::table_of(report));
    if (!options.json.empty()) write_text(options.json, bench::json_of(report));
    return bench::same_bits(report) ? 0 : 1;
}

}  // namespace frana
