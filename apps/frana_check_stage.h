#pragma once
// What `frana check` foretells of a 3D stage.
#include "scene/scene.h"

namespace frana {

struct StageForecast {
    double points = 0.0;       ///< if all of the flow is there at once
    double speed = 0.0;        ///< largest of the flow while there are points [m/s]
    double sound_speed = 0.0;  ///< [m/s]
    double steps = 0.0;
    bool thin = false;  ///< what comes is thinner than a cell: few points share a node
};

/// Of a scene with a stage. What starts in the window is counted as the stage will. What comes there from outside has
/// fallen along the steepest path, braked by the bed law. Its layer is half as deep as the release's.
StageForecast forecast_stage(const Scene& scene);

}  // namespace frana
