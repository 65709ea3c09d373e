#pragma once
// What colours mean in pictures of points in space.
#include "vtk_io/figures/space_moment.h"
#include "vtk_io/figures/space_objects.h"

namespace frana {

class SpaceColours {
public:
    explicit SpaceColours(const SpaceView& view);
    Colour of_speed(double speed) const;        ///< [m/s]
    Colour of_pressure(double pressure) const;  ///< [Pa]
    std::vector<ColourBar> bars() const;        ///< one of pressures only where there are any

private:
    SpaceView view_;
    bool kilo_;  ///< pressures in kPa
};

}  // namespace frana
