# Writes a C++ source that holds ParaView states as texts.
# cmake "-DSTATES=a.pvsm;b.pvsm" -DOUT=state_templates.cpp -P run/folder/state_templates.cmake
set(texts "")
foreach(state ${STATES})
  get_filename_component(name ${state} NAME_WE)
  file(READ ${state} text)
  string(APPEND texts "        {\"${name}\", R\"pvsm(${text})pvsm\"},\n")
endforeach()
file(WRITE ${OUT} "#include \"run/folder/states.h\"

namespace frana {

const std::vector<StateTemplate>& state_templates() {
    static const std::vector<StateTemplate> templates = {
${texts}    };
    return templates;
}

}  // namespace frana
")
