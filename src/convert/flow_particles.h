#pragma once
#include <vector>

#include "terrain/raster.h"

namespace frana {

/// A depth-averaged state for 3D conversion: particles, each a column of material, one array per quantity. All have
/// equal lengths but for the stress and the domain, which may be absent (empty).
struct FlowParticles {
    std::vector<double> x, y;              ///< map position [m]
    std::vector<double> bed;               ///< elevation of the bed below [m]
    std::vector<double> depth;             ///< from the bed to the free surface, vertical, >= 0 [m]
    std::vector<double> slope_x, slope_y;  ///< gradient of the bed [1]
    std::vector<double> vx, vy;            ///< horizontal velocity, mean over the depth [m/s]
    std::vector<double> mass;              ///< > 0 [kg]
    std::vector<double> volume;            ///< > 0 [m^3]
    std::vector<double> bed_pressure;      ///< at the bed [Pa]
    std::vector<double> stress;            ///< of the rheology, mean over the depth: xx, yy, xy of each [Pa], or empty
    std::vector<double> id;                ///< the run's number of the particle [1]
    std::vector<Mat2> domain;              ///< edges of the parallelogram it stands on, each a column [m], or empty

    std::size_t count() const { return x.size(); }
    void reserve(std::size_t particles);
    /// Adds particle k of `other`; its stress when there is one.
    void take(const FlowParticles& other, std::size_t k);
};

/// Gradient of the bed at a map point [1]. It is the difference quotient over a cell of the bilinear bed. It is
/// one-sided where half of that cell is not known. Zero where all is unknown.
Vec2 bed_gradient(const Raster& bed, double x, double y);

/// Fills slope_x and slope_y.
void take_slopes(FlowParticles& particles, const Raster& bed);

}  // namespace frana
