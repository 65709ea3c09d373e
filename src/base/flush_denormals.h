#pragma once

namespace frana {

/// Numbers below 1e-308 become zero on every OpenMP thread: a nearly resting flow otherwise computes up to three
/// times slower. Does nothing on machines without SSE.
void flush_denormals_on_all_threads();

}  // namespace frana
