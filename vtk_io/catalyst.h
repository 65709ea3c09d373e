#pragma once
// ParaView Catalyst: the user's own ParaView script inside the solver process. The configuration (FRANA_CATALYST)
// chooses the source file behind this: the one in catalyst_none, catalyst_legacy or catalyst_2.
#include <filesystem>
#include <memory>
#include <string>

#include "observe/insitu.h"

namespace frana {

/// Throws UserError when this process cannot run the script. There may be no Catalyst in this build, or the script may
/// be of another version. Or it draws where there is no display (ParaView would then end the process). `place` is
/// "case.toml:12: insitu.0".
void check_catalyst(const std::filesystem::path& script, const std::string& place);

/// Gives every frame to a script of version 2.0. Its channels are "grid" (vtkImageData) and "particles" (vtkPolyData),
/// as in grid.pvd and particles.pvd. `timestep` counts the frames.
std::unique_ptr<InsituWork> make_catalyst(const std::filesystem::path& script);

}  // namespace frana
