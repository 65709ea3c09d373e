#pragma once
#include <limits>
#include <string>
#include <vector>

#include "observe/archive.h"
#include "observe/frame.h"

namespace frana {

/// Flow at one map point.
struct Sample {
    double elevation = 0.0;  ///< bed [m]
    double depth = 0.0;      ///< [m]
    Vec2 velocity{0, 0};     ///< along the map [m/s]
    double speed = 0.0;      ///< along the bed [m/s]
};

/// What material did to a face of a barrier since the start.
struct FaceLoad {
    Vec3 impulse{0, 0, 0};  ///< on the barrier [kg m/s]
    Vec3 moment{0, 0, 0};   ///< of it about BarrierLoad::about [kg m^2/s]
};

/// What material did to a barrier since the start.
struct BarrierLoad {
    std::vector<FaceLoad> faces;  ///< none where no forces are known
    Vec3 about{0, 0, 0};          ///< place that moments are about: the middle of the outline, on the bed [m]
    /// Elevation of the highest top ever of what came to it [m]: of particles within two cells, of points 99.9 % there.
    /// Not a number as long as nothing came.
    double run_up = std::numeric_limits<double>::quiet_NaN();
    double overtopped = 0.0;  ///< material that was over it at any time [m3]
    bool touched = false;     ///< points have come to a face

    /// Something reaches up to an elevation; minus infinity and not a number are nothing [m].
    void reach(double elevation) {
        if (elevation > -std::numeric_limits<double>::infinity() && !(run_up >= elevation)) run_up = elevation;
    }
};

struct BarrierLoads {
    /// A time over which forces are to be averaged [s]. A first contact is a blow as hard as sound is fast, which is
    /// artificial. Zero before anything can load barriers.
    double blur = 0.0;
    bool measures = true;               ///< forces are known now, where they ever are
    std::vector<BarrierLoad> barriers;  ///< in the order of the scene
};

/// Answers questions about the state between frames, cheaply: velocities are half a step behind.
class Probe {
public:
    virtual ~Probe() = default;
    /// Bilinear between nodes, velocity weighted by depth; beyond them the nearest.
    virtual Sample at(const Vec2& point) const = 0;
    /// nullptr where nothing measures loads.
    virtual const BarrierLoads* loads() const { return nullptr; }
    /// What passed each section of the scene since the start, by the paths of the particles [m3]. None where that is
    /// not known.
    virtual std::vector<double> passed() const { return {}; }
};

/// Observes a case while it runs; never changes it.
class Observer {
public:
    virtual ~Observer() = default;
    virtual std::string name() const = 0;              ///< for the timing table
    virtual void step(const Status&, const Probe&) {}  ///< after every step (and once at the start)
    /// Called after every step that ends between outputs: whether observe_between() gets a frame now.
    virtual bool wants_frame(const Status&) { return false; }
    virtual void observe_between(const Frame&) {}
    virtual void observe(const Frame&) {}  ///< at the start, at every output time and at the end
    /// Whether observe() reads more of a frame than its status. Where no observer does, no fields are computed.
    virtual bool looks_at_fields() const { return true; }
    virtual void end(const Frame&) {}  ///< once, with the last frame, after observe()
    /// Saves what the observer needs to go on, or restores it before its first call. Its files are then those of that
    /// moment: what was written later is removed. Throws UserError when they are not there any more.
    virtual void serialize(Archive&) {}
};

}  // namespace frana
