#pragma once
// A slope of 1 in 2 of which a run holds a part that grows.
#include <cmath>
#include <memory>

#include "catch.h"
#include "coupling/growing_particles.h"
#include "observe/budget.h"
#include "scene/scene.h"

/// Downhill to the west, 400 x 200 nodes of 4 m, `begin` of them held at first; Voellmy's friction, nothing released.
inline frana::Scene growing_slope(const frana::NodeBox& begin) {
    using namespace frana;
    const GridGeometry terrain{400, 200, 0.0, 0.0, 4.0};
    const auto ground = [terrain](const NodeBox& box) {
        Raster bed = Raster::filled(box.of(terrain), 0.0);
        for (Index j = 0; j < bed.geometry.ny; ++j)
            for (Index i = 0; i < bed.geometry.nx; ++i) bed.at(i, j) = 0.5 * bed.geometry.x(i);
        return bed;
    };
    Scene scene;
    scene.bed = ground(begin);
    scene.wider = std::make_shared<WiderTerrain>(WiderTerrain{terrain, begin, ground, {}});
    scene.bed_law = bed::Voellmy{0.1, 1000.0};
    return scene;
}

/// Runs on to that time [s], with the mass checked in each step. Whether the part grew westward while more was to come.
inline bool grows_before_all_is_in(frana::GrowingParticles& part, double end) {
    const frana::Status first = part.status();
    bool grew = false;
    while (part.status().time < end) {
        const frana::Index before = part.held().i0;
        part.advance(end);
        grew = grew || (part.held().i0 < before && part.more_comes());
        CHECK(std::abs(frana::budget(first, part.status()).mass_error) < 1e-13);
    }
    return grew;
}
