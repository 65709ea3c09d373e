#pragma once
// A round column of water is let go on flat ground. No formula is known. So the reference is a finite-volume solution
// in the radius alone, far finer than any grid it judges.
#include <vector>

#include "checks/verify/exact_dam_break.h"

namespace frana::verify {

/// Shallow water on flat ground in one coordinate r from a wall or an axis at r = 0. The finite-volume scheme is of
/// second order. It has limited linear states of depth and velocity, fluxes of Harten, Lax and van Leer (1983), and
/// two-stage Runge-Kutta. With an axis: d(r h) + d(r h u) = 0, d(r h u) + d(r (h u^2 + g h^2 / 2)) = g h^2 / 2.
class LineWater {
public:
    enum class Symmetry { plane, axis };
    LineWater(Symmetry symmetry, double length, Index cells, const std::function<double(double r)>& depth);

    void advance(double time);
    /// Linear between the middles of cells.
    WaveState at(double r) const;
    /// Per width, or per radian: the integral of h or of r h.
    double volume() const;
    Index cells() const { return static_cast<Index>(now_.size()); }
    double cell() const { return cell_; }

private:
    struct State {
        double h = 0.0, q = 0.0;
    };
    double face(Index i) const;
    double content(Index i) const;
    double fastest() const;
    void rates(const std::vector<State>& from, std::vector<State>& rate);

    Symmetry symmetry_;
    double cell_;
    std::vector<State> now_, rate_, half_;
    std::vector<State> low_, high_;  ///< depth and velocity (as q) at a cell's two faces
};

/// A column of radius 8 m and depth 1 m in still water of another depth, 2 s later. Depth 0: on dry ground.
class RadialDam {
public:
    static constexpr double kRadius = 8.0, kDepth = 1.0, kEnd = 2.0;
    explicit RadialDam(double outer);
    WaveState at(double r) const { return water_.at(r); }
    /// Outermost radius of a depth above `level` [m].
    double contour(double level) const;
    /// Own error against half the cells, its decay, volume, and what LineWater makes of exact solutions.
    std::vector<Residual> residuals() const;

private:
    LineWater water_;
    double outer_;
};

}  // namespace frana::verify
