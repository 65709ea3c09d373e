// The compiled part of the Python module `frana`.
#include <dlfcn.h>

#include <filesystem>

#include "base/error.h"
#include "base/version.h"
#include "bindings.h"

namespace frana {
namespace {

/// Python opens modules for themselves. The part of frana that draws pictures and reads VTK's files uses the solver's
/// functions. As in the program, it finds them among those that all may see.
void show_to_modules() {
    Dl_info here;
    if (dladdr(reinterpret_cast<const void*>(&show_to_modules), &here) != 0)
        dlopen(here.dli_fname, RTLD_LAZY | RTLD_NOLOAD | RTLD_GLOBAL);
}

/// What frana/errors.py makes of an error.
void raise(const char* maker, const py::object& of) {
    const py::object error = py::module_::import("frana.errors").attr(maker)(of);
    PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(error.ptr())), error.ptr());
}

void translate(std::exception_ptr thrown) {
    try {
        std::rethrow_exception(std::move(thrown));
    } catch (const UserError& error) {
        raise("of_problems", py::cast(error.problems()));
    } catch (const NumericsError& error) {
        raise("of_numerics", py::cast(error.what()));
    } catch (const std::filesystem::filesystem_error& error) {
        raise("of_problems", py::cast(std::vector<std::string>{error.what()}));
    }
}

}  // namespace
}  // namespace frana

PYBIND11_MODULE(_frana, module) {
    frana::show_to_modules();
    module.attr("version") = FRANA_VERSION;
    pybind11::register_exception_translator(&frana::translate);
    frana::bind_case(module);
    frana::bind_run(module);
    frana::bind_folder(module);
    frana::bind_ensemble(module);
}
