#pragma once
// Many random cases in a row, and what became of them.
#include <cstdint>

#include "checks/fuzz/shrink.h"

namespace frana::fuzz {

struct Plan {
    std::vector<Model> models = all_models();  ///< to draw of
    std::uint64_t seed = 1;
    std::uint64_t first = 0;    ///< number of the first case
    Index scenes = 0;           ///< at most so many; 0: as many as the time allows
    double seconds = 60.0;      ///< wall time for running cases; shrinking comes on top
    Index most_shrunk = 20;     ///< failures beyond this are counted only
    Index shrink_trials = 300;  ///< for each
};

struct Failure {
    Model model = Model::depth_averaged;
    std::uint64_t n = 0;  ///< number of the case in the series
    Violation found;      ///< as drawn
    Shrunk shrunk;        ///< trials 0: not tried
};

struct Worst {
    double value = 0.0;
    Model model = Model::depth_averaged;
    std::uint64_t n = 0;
};

/// What became of the scenes of one model.
struct Part {
    Index scenes = 0, refused = 0, failed = 0, steps = 0;
    double seconds = 0.0;
};

struct Campaign {
    Plan plan;
    Index scenes = 0, refused = 0, steps = 0;
    Index parted = 0;  ///< whose mirror images parted by round-off that grew
    double particle_steps = 0.0, seconds = 0.0;
    std::map<Model, Part> mix;
    std::map<std::string, Index> refusals;  ///< by what they say
    std::vector<Failure> failures;
    std::map<std::string, Worst> worst;   ///< by invariant, in units of what is allowed, over cases that passed
    std::map<std::string, Index> broken;  ///< cases by the invariant that broke
};

/// Runs the plan. `report` gets each failure once it has been shrunk; `stop` is called before each case.
Campaign run(const Plan& plan, const std::function<void(const Failure&)>& report,
             const std::function<bool()>& stop = {});

/// For people: counts, the mix of models, worst values.
std::string table_of(const Campaign& campaign);
/// For programs: {seed, first, scenes, refused, parted, steps, particle_steps, seconds, mix: [{model, scenes, refused,
/// failed, steps, seconds}], worst: [{invariant, value, model, scene}], failures: [{model, scene, invariant, value,
/// step, time, text, shrunk_...}]}.
std::string json_of(const Campaign& campaign);

}  // namespace frana::fuzz
