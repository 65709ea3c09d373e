#pragma once
#include <string>

#include "observe/archive.h"
#include "observe/frame.h"

namespace frana {

/// Flow at one map point.
struct Sample {
    double elevation = 0.0;  ///< bed [m]
    double depth = 0.0;      ///< [m]
    Vec2 velocity{0, 0};     ///< [m/s]
};

/// Answers questions about the state between frames, cheaply: velocities are half a step behind.
class Probe {
public:
    virtual ~Probe() = default;
    virtual Sample at(const Vec2& point) const = 0;  ///< bilinear between nodes; beyond them the nearest
};

/// Looks on while a case runs; never changes it.
class Observer {
public:
    virtual ~Observer() = default;
    virtual std::string name() const = 0;                  ///< for the timing table
    virtual void step(const Status&, const Probe&) {}      ///< after every step (and once at the start)
    /// Asked after every step that ends between outputs: is a frame wanted now? Then glance() gets it.
    virtual bool wants_frame(const Status&) { return false; }
    virtual void glance(const Frame&) {}
    virtual void see(const Frame&) {}                      ///< at the start, at every output time and at the end
    virtual void end(const Frame&) {}                      ///< once, with the last frame, after see()
    /// Saves what the observer needs to go on, or takes it up again before its first call; then its files are those of
    /// that moment: what was written later is taken back. Throws UserError when they are not there any more.
    virtual void keep(Archive&) {}
};

}  // namespace frana
