#pragma once
#include <functional>

#include "observe/archive.h"

namespace frana {

/// Decides when the state of a run is saved and where it goes (run/folder/checkpoint.h writes files).
class StateKeeper {
public:
    using State = std::function<void(Archive&)>;
    virtual ~StateKeeper() = default;
    /// Called after every step: whether it is time.
    virtual bool due() const = 0;
    /// Saves the state by calling `state`. If that fails, the keeper notes it and the run goes on.
    virtual void save(double time, const State& state) = 0;
    /// Gives the saved state to `state`; false when the run starts at its beginning. Throws UserError.
    virtual bool load(const State& state) = 0;
};

}  // namespace frana
