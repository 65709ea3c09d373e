# What the solver library needs, and the library itself as frana::core.
include(CMakeFindDependencyMacro)
find_dependency(Eigen3 3.4)
find_dependency(OpenMP COMPONENTS CXX)
find_dependency(fmt)
find_dependency(tomlplusplus)
include(${CMAKE_CURRENT_LIST_DIR}/frana_targets.cmake)
