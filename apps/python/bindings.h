#pragma once
// The parts of the module _frana, a file each.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <future>
#include <string>
#include <utility>

#include "terrain/raster.h"
#include "waiting.h"

namespace frana {
namespace py = pybind11;

void bind_case(py::module_& module);      // bind_case.cpp
void bind_run(py::module_& module);       // bind_run.cpp
void bind_folder(py::module_& module);    // bind_folder.cpp
void bind_ensemble(py::module_& module);  // bind_ensemble.cpp

/// Calls `work` on a thread of its own, without the interpreter's lock. A process that forks later has no threads of
/// OpenMP on its main one.
template <class Work>
auto aside(Work&& work) {
    const Waiting waiting;
    const py::gil_scoped_release release;
    return std::async(std::launch::async, std::forward<Work>(work)).get();
}

/// Numbers that become an array's own.
py::array array_of(std::vector<double>&& numbers, std::vector<py::ssize_t> shape);

/// (array (ny, nx) with its north row first, x of the western edge, y of the northern edge, pixel, WKT)
py::tuple north_up(const Raster& raster);

}  // namespace frana
