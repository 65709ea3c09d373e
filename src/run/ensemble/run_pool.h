#pragma once
// Many runs at a time, each on one thread.
#include <cstddef>
#include <functional>

#include "run/interrupt.h"
#include "scene/toolbox.h"

namespace frana {

/// Calls body(0), body(1), ... on so many threads, each number once, until they are done or an end is requested. The
/// first exception ends it too, and comes out here.
void for_each_run(std::size_t count, int threads, const Interrupt& interrupt,
                  const std::function<void(std::size_t)>& body);

/// `given`, or where that is 0 as OMP_NUM_THREADS or the machine says.
int threads_for_runs(int given);

/// Reads barrier meshes one at a time, for scenes that are built on several threads.
MeshReader meshes_in_turn();

}  // namespace frana
