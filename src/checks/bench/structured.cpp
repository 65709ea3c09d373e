#include "checks/bench/structured.h"

#include "base/error.h"
#include "checks/bench/blob.h"

namespace frana::bench {

const char* name_of(ParticlesThat what) {
    switch (what) {
        case ParticlesThat::hold:
            return "structured/elastic";
        case ParticlesThat::break_up:
            return "structured/breaking";
        case ParticlesThat::are_grains:
            return "structured/grains";
        case ParticlesThat::drain:
            return "mixture";
    }
    throw InternalError("unknown particles");
}

Scene structured_blob(ParticlesThat what, Index particles) {
    Blob blob;
    blob.particles = particles;
    blob.rheology = false;
    Scene scene = blob_scene(blob);
    scene.curvature = Curvature::none;
    Structure structure;
    structure.material.young = 50e6;  // sound ten times as fast as what it carries
    structure.material.critical_strain = 0.1;
    // The blob's spreading alone, 0.3 to 3 % a second, takes 1 kPa to the yield surface within the first window.
    structure.cohesion = what == ParticlesThat::hold ? 1e9 : 1e3;
    structure.share = what == ParticlesThat::are_grains ? 0.0 : 1.0;
    if (what == ParticlesThat::drain) {
        structure.confined = 0.2;
        scene.density = 1900.0;
        WaterPhase water;
        water.share = 0.2;
        water.exchange.material.solid_density = (1900.0 - 0.2 * 1000.0) / 0.8;
        scene.water = water;
    }
    scene.structure = structure;
    return scene;
}

}  // namespace frana::bench
