#pragma once
// A thin blob on a bed that varies along one direction of the map: scene, and where the blob is.
#include "checks/verify/trial.h"

namespace frana::verify {

/// `turn`: angle of the slide's direction s to the grid's x [rad]. The blob starts around s = start, n = 0.
struct Slide {
    double cell = 1.0;
    double turn = 0.0;
    double start = 0.0, reach = 0.0;  ///< s where the blob starts, and the farthest s of its way [m]
    double radius = 1.2;              ///< of the blob [cells]
    double depth = 2e-7;              ///< of the blob [cells]; so thin that its pressure has no effect
    int per_side = 2;

    double along(double x, double y) const;
    double across(double x, double y) const;
    /// A window around the blob's way on the bed z(s, n).
    Scene scene(const Function& z) const;
};

/// Mass-weighted means over a blob's points.
struct BlobState {
    double along, across, height, energy;
};  ///< [m], [m], bed [m], V^2/2 + g z [m^2/s^2]
BlobState blob_state(Trial& trial, const Slide& slide, const Function& z);

}  // namespace frana::verify
