#pragma once
// Looking at a run from inside: when, and what happens when it goes wrong. What is made of a frame (tables here,
// lines and pictures in vtk_io) is the work that the caller gives.
#include <memory>
#include <optional>
#include <string>

#include "observe/observer.h"

namespace frana {

/// What is made of a frame.
class InsituWork {
public:
    virtual ~InsituWork() = default;
    /// Observes a frame; `number` counts what was made so far (0, 1, 2, ...). Any exception says that it failed.
    virtual void sample(const Frame& frame, Index number) = 0;
    virtual void serialize(Archive&) {}  ///< as Observer::serialize
};

/// When: neither member: at every output.
struct InsituTimes {
    std::optional<double> every;       ///< at the start, then the first state at or past each multiple [s]
    std::optional<Index> every_steps;  ///< at the start, then whenever that many steps have passed
};

/// How it went.
struct InsituTally {
    std::string name, kind;
    Index made = 0;
    Index failed = 0;
    std::string first_failure;  ///< "t = 3 s: the disk is full"; empty without one
};

/// Calls the work when it is time to, and at the end. A work that fails is counted in `tally`, which outlives the
/// observer. The run goes on, since it is worth more than its pictures.
class InsituObserver final : public Observer {
public:
    InsituObserver(InsituTimes times, std::unique_ptr<InsituWork> work, InsituTally& tally)
        : times_(times), work_(std::move(work)), tally_(tally) {}
    std::string name() const override { return "insitu " + tally_.name; }
    bool wants_frame(const Status& now) override;
    void observe_between(const Frame& frame) override;
    void observe(const Frame& frame) override;
    void end(const Frame& last) override;
    void serialize(Archive& archive) override;

private:
    bool due(const Status& now) const;
    void sample(const Frame& frame);

    InsituTimes times_;
    std::unique_ptr<InsituWork> work_;
    InsituTally& tally_;
    Index next_multiple_ = 0;  ///< of times_.every or every_steps
    Index sampled_step_ = -1;  ///< the step
};

}  // namespace frana
