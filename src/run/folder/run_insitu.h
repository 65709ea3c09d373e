#pragma once
// From [[insitu]] to observers, and what became of them.
#include <filesystem>
#include <vector>

#include "observe/insitu.h"
#include "run/folder/run_record.h"
#include "scene/scene.h"

namespace frana {

/// Refuses a scene whose [[insitu]] this build cannot serve (a Catalyst script without Catalyst): UserError.
void check_insitu(const Scene& scene);

/// One observer an entry, in the scene's order, writing into `run_dir`/insitu. `tallies` gets one item each, where the
/// observers count as long as they live.
Observers make_insitu(const Scene& scene, const std::filesystem::path& run_dir, std::vector<InsituTally>& tallies);

/// A warning for every entry that failed at least once.
std::vector<std::string> insitu_warnings(const std::vector<InsituTally>& tallies);

}  // namespace frana
