#pragma once
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <filesystem>

namespace frana {

/// Points and faces of a Wavefront OBJ file; what else it holds (normals, textures, groups) is passed over. VTK's own
/// reader has single precision, and dies of faces that name normals or textures which are not there. Throws UserError
/// with the line when a point or a face cannot be read.
vtkSmartPointer<vtkPolyData> read_obj(const std::filesystem::path& file);

}  // namespace frana
