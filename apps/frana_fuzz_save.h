#pragma once
#include <filesystem>

#include "checks/fuzz/campaign.h"

namespace frana {

/// The options of `frana stress --case` that watch `draft` as the campaign did.
std::string replay_options(const fuzz::Draft& draft);

/// Writes a failing draft as a case that `frana run` and `frana stress --case` read. It is case.toml, its rasters as
/// GeoTIFF, and its particles as particles.csv for inspection. Throws UserError when the disk refuses.
void save_draft(const std::filesystem::path& folder, const fuzz::Draft& draft, const fuzz::Violation& broken);

}  // namespace frana
