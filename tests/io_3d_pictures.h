#pragma once
// Pictures of 3D points as tests look at them.
#include <string>

#include "io_figures_scene.h"
#include "vtk_io/figures/figure_3d.h"

namespace figures {

using Render = bool (*)(const frana::Figure3d&, const std::filesystem::path&, std::string&);

/// What a figure comes out as.
inline frana::Pixels drawn(Render render, const frana::Figure3d& figure) {
    const Folder folder;
    std::string why_not;
    const bool done = render(figure, folder / "space.png", why_not);
    INFO(why_not);
    REQUIRE(done);
    return frana::read_png(folder / "space.png");
}

}  // namespace figures
