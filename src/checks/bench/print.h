#pragma once
#include <string>

#include "checks/bench/gates.h"

namespace frana::bench {

/// For people: calibration, cost by phase, gates, hashes.
std::string table_of(const Report& report);

/// For programs: {stream_triad_GBps, node_touch_ns, kernels: [{name, particles, threads, ns_per_particle_step,
/// bytes_per_particle_step, fraction_of_stream, ...}], ...}.
std::string json_of(const Report& report);

}  // namespace frana::bench
