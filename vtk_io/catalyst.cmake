# FRANA_CATALYST -> FRANA_CATALYST_SOURCE, FRANA_CATALYST_LIBRARIES. Included once VTK is found.
if(FRANA_CATALYST STREQUAL "none")
  set(FRANA_CATALYST_SOURCE catalyst_none/catalyst.cpp)
  set(FRANA_CATALYST_LIBRARIES)
elseif(FRANA_CATALYST STREQUAL "legacy")
  set(FRANA_CATALYST_SOURCE catalyst_legacy/catalyst.cpp)
  get_filename_component(paraview_libraries ${VTK_DIR}/../../.. ABSOLUTE)
  set(FRANA_CATALYST_LIBRARIES)
  foreach(name vtkPVCatalyst vtkPVPythonCatalyst)
    find_library(FRANA_${name} ${name}-pv5.11 HINTS ${paraview_libraries} REQUIRED)
    list(APPEND FRANA_CATALYST_LIBRARIES ${FRANA_${name}})
  endforeach()
  # Debian's libvtkPythonInterpreter does not link Python itself. The linker must neither drop it nor require more.
  find_package(Python3 3.11 REQUIRED COMPONENTS Development.Embed)
  list(APPEND FRANA_CATALYST_LIBRARIES -Wl,--no-as-needed ${Python3_LIBRARIES} -Wl,--as-needed
              -Wl,--allow-shlib-undefined)
else()
  message(FATAL_ERROR "FRANA_CATALYST: found \"${FRANA_CATALYST}\"; expected none or legacy")
endif()
