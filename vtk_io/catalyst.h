#pragma once
// ParaView Catalyst: the user's own ParaView script inside the solver process. Which source file stands behind this is
// chosen when the project is configured (FRANA_CATALYST): the one in catalyst_none, catalyst_legacy or catalyst_2.
#include <filesystem>
#include <memory>
#include <string>

#include "observe/insitu.h"

namespace frana {

/// Why this build runs no Catalyst script, such as "this frana was built without ParaView Catalyst"; empty when it does.
std::string no_catalyst_reason();

/// Hands every frame to a script of version 2.0: channels "grid" (vtkImageData) and "particles" (vtkPolyData), as in
/// grid.pvd and particles.pvd. Throws UserError when there is no Catalyst.
std::unique_ptr<InsituWork> make_catalyst(const std::filesystem::path& script);

}  // namespace frana
