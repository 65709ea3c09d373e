#pragma once
// Building 3D scenes for verification problems, and running them.
#include <functional>

#include "checks/verify/problem.h"
#include "solid3d/mpm3d.h"

namespace frana::verify {

/// Where a problem's own axes lie in the grid: a point (x, y, z) of the problem stands at at(x, y, z).
struct Frame3 {
    Mat3 turn = Mat3::Identity();
    Vec3 at(const Vec3& x) const { return turn * x; }
};
/// Turned by so many degrees about the y axis.
Frame3 turned_about_y(double degrees);

/// Calls take(place, volume) for the centres of `per_cell`^3 parts of each cell of a box, in the problem's
/// own axes. The box is a whole number of parts long in each direction. If not, the parts are stretched a little.
void for_each_part(const Vec3& low, const Vec3& high, double cell, int per_cell,
                   const std::function<void(const Vec3& place, double volume)>& take);

/// A grid that holds a box given in the problem's axes, with room for mirror particles.
GridGeometry3d grid_around(const Frame3& frame, const Vec3& low, const Vec3& high, double cell);

/// The two planes at y = 0 and y = width that make a slice of a plane problem.
void add_slice(SolidScene& scene, double width);
/// The two planes of symmetry at x = 0 and y = 0 that make a quarter of a round problem.
void add_quarter(SolidScene& scene);

/// A run to `end`, timed; calls each(flow) after every step. momentum_residual: what the ledger of surfaces
/// and gravity leaves open, over all momentum that went round.
Measurement run_body(Mpm3d& flow, double end, const std::function<void(const Mpm3d&)>& each = {});

/// Shares of an energy [J] that a run turned over, as extras. They are what the scheme lost of it, and what the law
/// did.
void add_energies(Measurement& m, const Mpm3d& flow, double turned_over);

/// Runs of one problem as one. Steps and times add up, and the larger residual counts. The rest is the later run's.
Measurement joined(const Measurement& before, const Measurement& now);

}  // namespace frana::verify
