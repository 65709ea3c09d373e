#pragma once
// What free water and the particles of a node do to one another.
#include "structured/structured_flow.h"

namespace frana {

/// Product of two velocities along the ground [m^2/s^2].
inline double along_ground(const StructuredBody::NodeGround& ground, const Vec2& a, const Vec2& b) {
    const Vec2 slope(ground.slope_x, ground.slope_y);
    return a.dot(b) + slope.dot(a) * slope.dot(b);
}

/// A node's particles as they meet its water.
struct Met {
    double mass;         ///< without what was released [kg]
    double depth;        ///< of grains and confined water [m]
    double support = 0;  ///< share of the weight that water takes off the bed
    Vec2 slope{0, 0};    ///< of the water's surface
    Vec2 lift{0, 0};     ///< acceleration by the pressure of the water [m/s^2]
};

/// Whether there is free water at a node.
bool has_water(const StructuredBody& body, Index k);
/// A node's particles, without what they released in the last step, and what the water bears of them.
Met meet_water(const StructuredBody& body, Index k);
/// Of grains with their confined water, which has gone from what broke [kg/m^3].
inline double density_of(const StructuredBody& body, Index k, const Met& met) {
    const double cell = body.grid.cell();
    return met.depth > 0.0 ? met.mass / (body.ground[k].open * cell * cell * met.depth) : body.density;
}
/// Drag and virtual mass between a node's particles and its water over a step.
struct DragStep {
    Phase c, u;  ///< particles and water, with what drives them
    Exchange by;
    Vec2 driven{0, 0};    ///< velocity of the particles without the water [m/s]
    Vec2 driving{0, 0};   ///< the water [m/s^2]
    bool outrun = false;  ///< drag is too weak for xi, which was left out
    bool held = false;    ///< friction holds the particles whatever the water does in the step

    /// Velocity of particles that nothing holds, after a step.
    Vec2 dragged(double dt) const;
};
/// The step brings the particles from `before` to `driven`, without the water. What drives the water acts along with
/// them. Its own step gave it that of all the time it is ahead.
DragStep drag_step(const StructuredBody& body, Index k, const Met& met, const Vec2& before, const Vec2& driven,
                   const StepTimes& times);
/// Takes it. Returns the particles' velocity, if friction did no more. What both lose is the impulse times the mean slip.
Vec2 drag(StructuredBody& body, Index k, const Met& met, const DragStep& step, const StepTimes& times,
          StructuredTally& tally);
/// What the particles released in the last step joins the water, with the velocity that points brought. Nodes beyond
/// the grid's sides have no water. What is released there joins the nearest node that has, in one order.
void release_to_nodes(StructuredBody& body);

}  // namespace frana
