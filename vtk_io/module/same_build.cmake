# Writes the header OUT with FRANA_SAME_BUILD: a name for all that the program and its module of VTK share. Those are the
# headers under ROOT and what they are compiled with (MADE_WITH). Others than its own a program cannot call.
file(GLOB_RECURSE headers LIST_DIRECTORIES FALSE RELATIVE ${ROOT} ${ROOT}/src/*.h ${ROOT}/vtk_io/*.h)
list(SORT headers)
set(all "${MADE_WITH}")
foreach(header ${headers})
  file(SHA256 ${ROOT}/${header} sum)
  string(APPEND all "\n${header} ${sum}")
endforeach()
string(SHA256 name "${all}")
string(SUBSTRING ${name} 0 12 name)
file(CONFIGURE OUTPUT ${OUT} CONTENT "#pragma once\n#define FRANA_SAME_BUILD \"${name}\"\n")
