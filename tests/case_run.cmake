# Runs a case as a user would, and compares it with the figures its README promises.
# cmake -DFRANA=... -DCHECK_RUN=... -DCASE=case.toml -DEXPECTED=expected.csv -DOUT=dir -P case_run.cmake
# One thread: results are the same for any number, and tests run side by side.
function(must)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "exit code ${result} of: ${ARGN}")
  endif()
endfunction()
file(REMOVE_RECURSE ${OUT})
must(${FRANA} check ${CASE})
must(${FRANA} run ${CASE} --out ${OUT} --threads 1 --quiet)
foreach(product run.json report.md history.csv particles.pvd grid.pvd terrain.vti footprint.geojson
                rasters/peak_depth.tif rasters/final_depth.tif figures/map_peak_depth.png)
  if(NOT EXISTS ${OUT}/${product})
    message(FATAL_ERROR "${OUT}/${product} was not written")
  endif()
endforeach()
must(${CHECK_RUN} ${OUT} ${EXPECTED})
