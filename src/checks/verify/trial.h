#pragma once
// Building a problem's scene, running it, and holding the end state against exact fields.
#include "checks/verify/problem.h"
#include "shallow/depth_averaged.h"

namespace frana::verify {

/// A grid of nx * ny nodes whose node (0, 0) stands at (x0, y0), bed from a formula.
Scene scene_on(Index nx, Index ny, double cell, const Function& bed, double x0 = 0.0, double y0 = 0.0);

/// Where points stand: `per_side`^2 a cell on the lattice aligned with the grid, shifted by a part of a cell.
struct Lattice {
    int per_side = 2;
    double shift_x = 0.0, shift_y = 0.0;  ///< [cells]
};

/// Adds a point at each place of the lattice where the depth is positive, with the volume depth * spacing^2.
void fill(Scene& scene, const Function& depth, const Lattice& lattice = {});

/// Same, volumes exact for an outline that cuts the lattice's squares: midpoints of 8 * 8 parts of each square.
void fill_cut(Scene& scene, const Function& depth, const Lattice& lattice = {});

/// The named preset's choices of terrain model and scheme (Setup::preset).
void set_preset(Scene& scene, const std::string& preset);

/// Exact fields at the end time.
struct Exact {
    Function depth = {};                                 ///< [m]
    Function u = {}, v = {};                             ///< velocity [m/s]; without: no momentum norm
    std::function<bool(double x, double y)> where = {};  ///< nodes that count; without: all
};

/// A run: preset and edit applied, advanced to `end`, timed; fills steps, particles, times, mass and energy error.
class Trial {
public:
    /// `scene` is ready but for preset and edit. keep_terrain: the preset does not choose the terrain model.
    Trial(Scene scene, const Setup& setup, bool keep_terrain = true);

    /// Advances to `end` [s], hitting it; calls `each` after every step.
    void run_to(double end, const std::function<void(const Status&)>& each = {});
    /// Until nothing moves or `latest` [s].
    void run_to_rest(double latest);
    /// Figures of the run so far, with norms when exact fields are given.
    Measurement measure(const Exact& exact = {});

    DepthAveraged& simulation() { return *simulation_; }
    const Scene& scene() const { return scene_; }
    /// Mass-weighted mean over the points of a function of their place [map coordinates].
    double point_mean(const Function& f) const;

private:
    Scene scene_;
    std::unique_ptr<DepthAveraged> simulation_;
    Status first_;
    double wall_ = 0.0, peak_kinetic_ = 0.0;
};

/// Relative norms of a node field pair against another: {L1, L2, Linf}.
struct Norms {
    double l1 = kNone, l2 = kNone, linf = kNone;
};
Norms depth_norms(const Frame& frame, const Exact& exact);
Norms momentum_norms(const Frame& frame, const Exact& exact);

}  // namespace frana::verify
