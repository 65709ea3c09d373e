#pragma once
// The one abstract face of every solver: step, observe, sample.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "observe/archive.h"
#include "observe/frame.h"
#include "observe/observer.h"
#include "run/rest_rule.h"

namespace frana {

struct Friction;
struct Scene;
struct Seeds;

class Simulation : public Probe {
public:
    /// One time step, never past `until` [s]. Throws NumericsError when a number stops being finite.
    virtual void advance(double until) = 0;
    virtual const Status& status() const = 0;
    /// Length at most of the next step, if nothing limits it [s]. 0 where that is not known beforehand.
    virtual double longest_step() const { return 0.0; }
    /// What moves now: the same bits for any number of threads. `fastest` is the status's.
    virtual MovingMass motion(const MotionQuery& query) const = 0;
    /// Whether what stands still may be taken for rest: not while something is still to begin.
    virtual bool may_rest() const { return true; }
    /// Whether material is still to come, so that a run without any is not over.
    virtual bool more_comes() const { return false; }
    /// The state at status().time as named arrays; borrowed until the next call of advance() or frame().
    virtual Frame frame() = 0;
    /// The status of that frame, for callers that need none of its fields. It too ends what a borrowed frame points to.
    virtual Status frame_status() { return frame().status; }
    /// What the last frame's fields point into, for callers that read them longer than until the next step. They stay
    /// as they are while somebody holds it. To be called before the next advance() or frame().
    virtual std::shared_ptr<const void> give_frame_away() = 0;
    /// Why material from outside cannot be added: what was found, expected, and what to do; empty: it can.
    virtual std::string why_not_add(const Seeds&) const {
        return "found a case with 3D points or structured solids; expected one of depth-averaged flow alone; give what "
               "comes later as a release or an inflow of the case";
    }
    /// Adds particles between two steps: mass and momentum come in as those of inflows do (Status::mass_in). While the
    /// state is put aside they wait for the step after it.
    virtual void add(const Seeds&) { throw InternalError("internal error: this model takes no material from outside"); }
    /// The ground that the run works on now, where that has grown beyond the scene's; frames lie within it.
    virtual const Raster* ground() const { return nullptr; }
    /// Friction on that ground, where it varies spatially.
    virtual const Friction* friction() const { return nullptr; }
    /// Remarks for the user on how the run was set up.
    virtual std::vector<std::string> remarks() const { return {}; }
    /// What only some models can tell.
    virtual Extras extras() const { return {}; }
    /// Wall time by phase since the start.
    virtual std::vector<PhaseTime> timings() const = 0;
    /// Saves the state between two steps, or restores it with all its bits. The simulation is then of the same scene
    /// and was made for that (Start::resumed). Steps then go on as if they had never stopped, on any number of threads.
    virtual void serialize(Archive& archive) = 0;
};

/// Where a simulation starts: with the scene's particles, or empty, for serialize() to fill.
enum class Start { placed, resumed };

/// Chooses physics and scheme once, as types, and builds the solver of a scene.
std::unique_ptr<Simulation> make_simulation(const Scene& scene, Start start = Start::placed);
/// What stands or comes in on top of barriers, as the simulation of particles remarks at its end.
std::vector<std::string> remarks_on_barriers(const Scene& scene);

}  // namespace frana
