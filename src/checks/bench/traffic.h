#pragma once
// How many bytes each phase of a step has to move, from what it reads and writes. It is a model, not a measurement.
#include <string>

#include "shallow/flow.h"
#include "solid3d/mpm3d.h"
#include "structured/structured_flow.h"

namespace frana::bench {

/// Memory traffic of one call of a phase. Every array counts once per sweep over it, and nothing stays in a cache
/// between sweeps. A number that is written without being read costs its bytes twice (write-allocate), as one that is
/// read and written.
struct Traffic {
    double particle = 0.0;  ///< bytes per particle
    double node = 0.0;      ///< bytes per node of the work list
};

/// Traffic of the phase that the solver's timings call `phase`; nothing for one that is not known.
Traffic traffic_of(const std::string& phase, const Flow& flow);
/// The same for 3D points.
Traffic traffic_of(const std::string& phase, const SolidBody& body);
/// The same for structured particles.
Traffic traffic_of(const std::string& phase, const StructuredBody& body);

}  // namespace frana::bench
