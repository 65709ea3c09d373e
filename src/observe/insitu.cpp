#include "observe/insitu.h"

#include <fmt/core.h>

#include <cmath>
#include <exception>
#include <new>

namespace frana {
namespace {

/// Multiples of an interval passed so far. Output times are k * every rounded, which must count as the k-th.
Index multiples(const InsituTimes& times, const Status& now) {
    if (times.every_steps) return now.step / *times.every_steps;
    return static_cast<Index>(std::floor(now.time / *times.every + 1e-9));
}

}  // namespace

bool InsituObserver::due(const Status& now) const {
    const bool own_times = times_.every || times_.every_steps;
    return own_times && multiples(times_, now) >= next_multiple_;
}

bool InsituObserver::wants_frame(const Status& now) { return due(now); }

void InsituObserver::observe_between(const Frame& frame) {
    if (due(frame.status)) sample(frame);
}

void InsituObserver::observe(const Frame& frame) {
    const bool every_output = !times_.every && !times_.every_steps;
    if (every_output || due(frame.status)) sample(frame);
}

void InsituObserver::end(const Frame& last) {
    if (last.status.step != sampled_step_) sample(last);
}

void InsituObserver::serialize(Archive& archive) {
    archive.number("next_multiple", next_multiple_);
    archive.number("looked_at", sampled_step_);
    archive.number("made", tally_.made);
    archive.number("failed", tally_.failed);
    archive.text("first_failure", tally_.first_failure);
    const Archive::Part part(archive, "work");
    work_->serialize(archive);
}

void InsituObserver::sample(const Frame& frame) {
    if (times_.every || times_.every_steps) next_multiple_ = multiples(times_, frame.status) + 1;
    sampled_step_ = frame.status.step;
    try {
        work_->sample(frame, tally_.made);
        ++tally_.made;
    } catch (const std::bad_alloc&) {  // the run will not get far either, and can be resumed
        throw;
    } catch (const std::exception& error) {
        if (tally_.failed == 0) tally_.first_failure = fmt::format("t = {:.6g} s: {}", frame.status.time, error.what());
        ++tally_.failed;
    }
}

}  // namespace frana
