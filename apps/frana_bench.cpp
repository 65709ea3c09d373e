// `frana bench`: cost of a step by phase, beside what the machine can do, measured in the same process.
#include <fmt/core.h>

#include "base/atomic_file.h"
#include "bench/print.h"
#include "frana_commands.h"

namespace frana {

int bench_command(const BenchOptions& options) {
    bench::Options wanted;
    if (!options.particles.empty()) wanted.particles.assign(options.particles.begin(), options.particles.end());
    if (!options.threads.empty()) wanted.threads = options.threads;
    wanted.quick = options.quick;
    const bench::Report report = bench::run(wanted, [](const std::string& text) {
        fmt::print(stderr, "{}\n", text);
    });
    fmt::print("{}", bench::table_of(report));
    if (!options.json.empty()) write_text(options.json, bench::json_of(report));
    return bench::same_bits(report) ? 0 : 1;
}

}  // namespace frana
