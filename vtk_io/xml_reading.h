#pragma once
// Files of VTK's XML kinds and meshes from anywhere. What would make VTK itself crash is found before or after it
// reads.
#include <filesystem>
#include <functional>
#include <string>

class vtkPolyData;
class vtkXMLReader;

namespace frana {

/// Has `reader` read a file. False when it is not of the reader's kind, damaged, or VTK says anything about it;
/// nothing reaches stderr. With `wanted` only those of the points' arrays are read. The others keep their names in the
/// reader's selection of arrays.
bool read_xml(vtkXMLReader* reader, const std::filesystem::path& file,
              const std::function<bool(const std::string& array)>& wanted = {});

/// What is wrong with faces, lines or vertices, as "a face names point 7, counted from 0, of 4 points". Empty when
/// nothing is. VTK's filters trust what a file says.
std::string fault_of(vtkPolyData* mesh);

}  // namespace frana
