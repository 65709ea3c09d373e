// A module of VTK as another build of the same version left it: as large, and with functions that cannot be called.
#include "vtk_io/module/functions.h"

extern "C" __attribute__((visibility("default"))) const frana::VtkFunctions* frana_vtk_functions() {
    static frana::VtkFunctions functions{};
    functions.build = OTHER_BUILD;
    functions.size = sizeof(functions);
    return &functions;
}
