# Writes a C++ source that holds the page's texts and three.js.
# cmake -DFOLDER=run/web "-DSCRIPTS=a.js;b.js" "-DTHREE=three.min.js;..." -DOUT=resources.cpp -P resources.cmake
set(script "")
foreach(file ${SCRIPTS})
  file(READ ${FOLDER}/${file} text)
  string(APPEND script "${text}")
endforeach()
set(three "")
foreach(file ${THREE})
  file(READ ${file} text)
  string(APPEND three "${text}\n")
endforeach()
file(READ ${FOLDER}/page.html frame)
file(READ ${FOLDER}/page.css style)
file(WRITE ${OUT} "#include \"run/web/resources.h\"

namespace frana {

const PageResources& page_resources() {
    static const PageResources resources = {R\"frana(${frame})frana\", R\"frana(${style})frana\",
                                            R\"frana(${script})frana\", R\"frana(${three})frana\"};
    return resources;
}

}  // namespace frana
")
