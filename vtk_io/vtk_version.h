#pragma once
#include <string>

namespace frana {

/// Version of the VTK library in use, "9.1.0".
std::string vtk_version();

}  // namespace frana
