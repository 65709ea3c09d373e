// The face of the module.
#include <vtkSMPTools.h>

#include "base/version.h"
#include "vtk_io/module/functions.h"
#include "vtk_io/module/same_build.h"

namespace {

const frana::VtkFunctions kFunctions = {FRANA_VERSION " " FRANA_SAME_BUILD, sizeof(frana::VtkFunctions),
#define FRANA_VTK_ROW(name) &frana::name,
                                        FRANA_VTK_FUNCTIONS(FRANA_VTK_ROW)
#undef FRANA_VTK_ROW
};

}  // namespace

extern "C" __attribute__((visibility("default"))) const frana::VtkFunctions* frana_vtk_functions() {
    // Files and pictures are made side by side as it is. VTK's own threads, a few for each short loop, took a twentieth
    // of a run's time to wake up and fall asleep.
    vtkSMPTools::SetBackend("Sequential");
    return &kFunctions;
}
