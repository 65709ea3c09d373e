#include "vtk_io/vtk_version.h"

#include <vtkVersion.h>

namespace frana {

std::string vtk_version() { return vtkVersion::GetVTKVersion(); }

}  // namespace frana
