#include "vtk_io/vtk_threads.h"

#include <vtkSMPTools.h>

namespace frana {

void keep_vtk_to_one_thread() { vtkSMPTools::SetBackend("Sequential"); }

}  // namespace frana
