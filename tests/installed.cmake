# Installs what is built in BUILD and uses it as others would. A project of its own uses the library (tests/installed),
# and the program runs away from its sources.
#   cmake -DBUILD=... -DSOURCE=... -DOUT=... -DPROGRAM=ON|OFF -DVERSION=...
#         -DCOMPILER=... -DFLAGS=... -DBUILD_TYPE=... [-DPYTHON=python3 -DPYTHON_DIR=...] -P installed.cmake
set(prefix ${OUT}/prefix)
string(REGEX REPLACE "([][+.*()^$?|])" "\\\\\\1" source "${SOURCE}")  # as a pattern
set(source "${source}/(src|vtk_io|apps|cases|tests)/")  # a short name alone may stand in any text
set(away ${OUT}/away)  # the prefix moved there: nothing may know where it was
file(REMOVE_RECURSE ${OUT})

function(call what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE rc OUTPUT_VARIABLE out ERROR_VARIABLE out WORKING_DIRECTORY /)
  if(NOT rc EQUAL 0)
    message(FATAL_ERROR "${what}: exit ${rc}\n${out}")
  endif()
  set(out "${out}" PARENT_SCOPE)
endfunction()

call("install" ${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix} --component library)
if(PROGRAM)
  call("install" ${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix} --component program)
endif()
file(RENAME ${prefix} ${away})

call("configure" ${CMAKE_COMMAND} -S ${SOURCE}/tests/installed -B ${OUT}/slide -DCMAKE_PREFIX_PATH=${away}
     -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_CXX_FLAGS=${FLAGS} -DCMAKE_BUILD_TYPE=Debug)
call("build" ${CMAKE_COMMAND} --build ${OUT}/slide)
call("slide" ${OUT}/slide/slide)
# On a 1 in 2 slope the slab without spreading slides g (sin a - 0.3 cos a) cos a t^2 / 2 = 0.16 g t^2 / 2 = 7.06 m on
# the map in 3 s. Its front spreads ahead of it by at most 2 sqrt(g h cos^2 a) t = 16.8 m.
if(NOT out MATCHES "mass 100000.000000 kg, runout ([0-9.]+) m")
  message(FATAL_ERROR "slide printed: ${out}")
endif()
if(CMAKE_MATCH_1 LESS 7.06 OR CMAKE_MATCH_1 GREATER 23.9)
  message(FATAL_ERROR "slide: found a runout of ${CMAKE_MATCH_1} m; expected 7.06 to 23.9 m")
endif()
file(GLOB_RECURSE texts ${away}/*.cmake ${away}/*.h)
foreach(text ${texts})
  file(STRINGS ${text} known REGEX "${source}" LIMIT_COUNT 1)
  if(known)
    message(FATAL_ERROR "${text} knows where it was built: ${known}")
  endif()
endforeach()

if(PROGRAM)
  call("frana --version" ${away}/bin/frana --version)
  if(NOT out MATCHES "${VERSION}" OR NOT out MATCHES "VTK [0-9]")
    message(FATAL_ERROR "frana --version printed: ${out}")
  endif()
  # Every name that the module of vtk_io needs of the program is there, resolved at once instead of at the first call.
  call("frana --version" ${CMAKE_COMMAND} -E env LD_BIND_NOW=1 ${away}/bin/frana --version)
  if(NOT out MATCHES "VTK [0-9]")
    message(FATAL_ERROR "frana --version printed, with all names looked up: ${out}")
  endif()
  call("frana check" ${away}/bin/frana check ${away}/share/frana/cases/maungawhau/case.toml)
  if(out MATCHES "${source}")
    message(FATAL_ERROR "frana check read the sources: ${out}")
  endif()
  file(GLOB_RECURSE modules ${away}/frana_vtk.so)
  if(PYTHON)
    # The Python module finds the one of vtk_io, which finds the solver's functions in it.
    file(MAKE_DIRECTORY ${OUT}/python)
    call("Python" ${CMAKE_COMMAND} -E env PYTHONPATH=${away}/${PYTHON_DIR} LD_BIND_NOW=1 PYTHONDONTWRITEBYTECODE=1
         ${PYTHON} -c "import frana
case = frana.Case('${away}/share/frana/cases/maungawhau/case.toml', set={'output.formats': ['vtk']})
case.run('${OUT}/python/run', until=0.1).finish()
print(frana.open('${OUT}/python/run').frames[-1].grid['depth'].max())")
    if(NOT out MATCHES "^[1-9][0-9.]*\n$")
      message(FATAL_ERROR "the Python module printed: ${out}")
    endif()
  endif()
  # A program that does not have the sources' path in it cannot look there. Debug symbols have it.
  if(BUILD_TYPE STREQUAL "Release" AND NOT FLAGS)
    foreach(binary ${away}/bin/frana ${modules})
      file(STRINGS ${binary} known REGEX "${source}" LIMIT_COUNT 1)
      if(known)
        message(FATAL_ERROR "${binary} knows where it was built: ${known}")
      endif()
    endforeach()
  endif()
  # The plugin for QGIS lies next to the program, and finds it from there.
  find_program(python NAMES python3)
  if(python)
    call("the plugin for QGIS" ${CMAKE_COMMAND} -E env --unset=FRANA_PROGRAM PYTHONDONTWRITEBYTECODE=1
         PYTHONPATH=${away}/share/frana/qgis/frana_qgis ${python} -c "print(__import__('program').find())")
    if(NOT out STREQUAL "${away}/bin/frana\n")
      message(FATAL_ERROR "the plugin for QGIS found: ${out}")
    endif()
  elseif(NOT EXISTS ${away}/share/frana/qgis/frana_qgis/metadata.txt)
    message(FATAL_ERROR "the plugin for QGIS is not installed")
  endif()
  # Without the module a run has all but its pictures, and one of VTK files says what is missing.
  file(REMOVE ${modules})
  set(case ${away}/share/frana/cases/maungawhau/case.toml)
  call("frana run" ${away}/bin/frana run ${case} --until 0.1 --out ${OUT}/run --set "output.formats=['png']")
  file(READ ${OUT}/run/report.md report)
  if(NOT report MATCHES "frana_vtk.so: cannot open shared object file[^\n]*; expected the part of frana")
    message(FATAL_ERROR "a run without the module of vtk_io reported: ${report}")
  endif()
  execute_process(COMMAND ${away}/bin/frana run ${case} --until 0.1 --out ${OUT}/vtk --set "output.formats=['vtk']"
                  RESULT_VARIABLE rc OUTPUT_QUIET ERROR_VARIABLE complaint)
  if(NOT rc EQUAL 2 OR NOT complaint MATCHES "frana_vtk.so: cannot open shared object file")
    message(FATAL_ERROR "a run of VTK files without the module of vtk_io: exit ${rc}: ${complaint}")
  endif()
endif()
