// The face of the module.
#include "base/version.h"
#include "vtk_io/module/functions.h"
#include "vtk_io/module/same_build.h"
#include "vtk_io/vtk_threads.h"

namespace {

const frana::VtkFunctions kFunctions = {FRANA_VERSION " " FRANA_SAME_BUILD, sizeof(frana::VtkFunctions),
#define FRANA_VTK_ROW(name) &frana::name,
                                        FRANA_VTK_FUNCTIONS(FRANA_VTK_ROW)
#undef FRANA_VTK_ROW
};

}  // namespace

extern "C" __attribute__((visibility("default"))) const frana::VtkFunctions* frana_vtk_functions() {
    frana::keep_vtk_to_one_thread();
    return &kFunctions;
}
