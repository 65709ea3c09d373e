#pragma once
// 3D pictures without a screen: a surfaceless EGL context under a VTK window. Never tries X, since VTK ends the process
// when it finds no display. Where no renderer can be had, a reason is returned instead.
#include <memory>
#include <string>

#include "vtk_io/figures/pixels.h"

class vtkRenderer;

namespace frana {

/// Why no 3D picture can be drawn in this process; empty when one can. FRANA_NO_RENDER=1 in the environment switches
/// all drawing off. The first call makes the one EGL context of the process (about 50 ms).
std::string no_renderer_reason();

/// A window of the given size [px] with a white background, in memory. One at a time: a second `open` in another thread
/// waits until the first window is gone. VTK's own error messages go to `why_not`.
class Offscreen {
public:
    /// nullptr when there is no renderer; then `why_not` has the reason.
    static std::unique_ptr<Offscreen> open(int width, int height, std::string& why_not);
    ~Offscreen();
    Offscreen(const Offscreen&) = delete;
    Offscreen& operator=(const Offscreen&) = delete;

    /// Renderers are drawn in the order of their layers; the caller sets viewport and layer.
    void add(vtkRenderer* renderer, int layer = 0);
    /// Draws, and takes what was drawn. False with a reason when VTK failed.
    bool grab(Pixels& picture, std::string& why_not);

private:
    struct Window;
    explicit Offscreen(std::unique_ptr<Window> window);
    std::unique_ptr<Window> window_;
};

}  // namespace frana
