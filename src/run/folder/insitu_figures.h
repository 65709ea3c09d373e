#pragma once
// Pictures made while the case runs.
#include <filesystem>
#include <memory>

#include "observe/insitu.h"
#include "scene/scene.h"

namespace frana {

/// The field of an entry of kind figure, as its camera sees it: `folder`/NAME/NAME_NNNNNN.png.
std::unique_ptr<InsituWork> make_figure(const Scene& scene, const Insitu& entry, const std::filesystem::path& folder);

/// The cut of an entry of kind profile as a line chart: `folder`/NAME/NAME_NNNNNN.png.
std::unique_ptr<InsituWork> make_cut_figure(const Scene& scene, const Insitu& entry,
                                            const std::filesystem::path& folder);

}  // namespace frana
