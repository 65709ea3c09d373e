#pragma once
// ParaView Catalyst: the user's own ParaView script inside the solver process. Which source file stands behind this is
// chosen when the project is configured (FRANA_CATALYST): the one in catalyst_none, catalyst_legacy or catalyst_2.
#include <filesystem>
#include <memory>
#include <string>

#include "observe/insitu.h"

namespace frana {

/// Throws UserError when this process cannot run the script: no Catalyst in this build, a script of another version, or
/// one that draws where there is no display (ParaView would then end the process). `place` is "case.toml:12: insitu.0".
void check_catalyst(const std::filesystem::path& script, const std::string& place);

/// Hands every frame to a script of version 2.0: channels "grid" (vtkImageData) and "particles" (vtkPolyData), as in
/// grid.pvd and particles.pvd; `timestep` counts the looks.
std::unique_ptr<InsituWork> make_catalyst(const std::filesystem::path& script);

}  // namespace frana
