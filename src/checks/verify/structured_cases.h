#pragma once
// The clay flume and the block scenarios of van den Bout et al. 2021 (sec. 3 and 4), with the set-up that is
// assumed here: the paper's own dimensions and parameters are not known. What they show was calibrated
// (clay_flume) or found by search (blocks) and is no prediction.
#include "checks/verify/structured.h"
#include "structured/breakage.h"

namespace frana::verify {

/// A clay of the flume: triaxial cohesion [Pa] and angle [deg].
struct Clay {
    double cohesion, friction_deg;
};
constexpr Clay kSoftClay{18.3e3, 27.0}, kStiffClay{26.7e3, 28.0};

/// A block of clay, 0.30 x 0.25 x 0.10 m, that comes down 42 degrees. At 2.39 m/s it strikes an obstacle over two
/// fifths of its width, where the floor turns to 5 degrees.
StructuredScene clay_flume(const Clay& clay, double cell, int per_side = 2);

/// Share of the block's length in which a particle of the unhindered part is broken by more than 0.9. It is in slices
/// of a cell. That part is 0.28 to 0.80 of the width from the obstacle's side, whose corner is at 0.40. `seeds` are the
/// scene's.
double crack_coverage(const StructuredFlow& flow, const StructuredSeeds& seeds);

/// Blocks 100 x 60 m. 2A and 2B go over a convex slope, 5 m thick. 3A to 3C, 12 m thick, go down a slope into a valley.
/// Its floor falls away from the middle by `fan` at its sides, or rises where that is positive.
StructuredScene convex_block(double cohesion, double cell, int per_side = 2);
StructuredScene valley_block(double cohesion, double fan, double cell, int per_side = 2);

/// A scene that a picture shows at its end.
struct ShownBlock {
    std::string name, title;
    StructuredScene scene;
    double end = 0.0;  ///< [s]
    Function bed;      ///< [m]
};
/// Both clays of the flume, or the scenarios 2A, 2B, 3A to 3C.
std::vector<ShownBlock> shown_blocks(const std::string& problem);

/// On the nodes of the grid: depth [m], and mean damage [1], NaN where nothing lies.
struct NodeMaps {
    std::vector<double> depth, damage;
};
NodeMaps node_maps(const StructuredFlow& flow);

}  // namespace frana::verify
