#pragma once
// What colours mean in pictures of 3D points.
#include "vtk_io/figures/moment_3d.h"
#include "vtk_io/figures/objects_3d.h"

namespace frana {

class Colours3d {
public:
    explicit Colours3d(const View3d& view);
    Colour of_speed(double speed) const;        ///< [m/s]
    Colour of_pressure(double pressure) const;  ///< [Pa]
    std::vector<ColourBar> bars() const;        ///< one of pressures only where there are any

private:
    View3d view_;
    bool kilo_;  ///< pressures in kPa
};

}  // namespace frana
