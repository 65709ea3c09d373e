#pragma once
// What the VTK writers of this room share; includes VTK, so only for .cpp files of this room.
#include <vtkDataArray.h>
#include <vtkDataSetAttributes.h>
#include <vtkFieldData.h>
#include <vtkImageData.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkXMLWriter.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "observe/frame.h"
#include "vtk_io/base64_stream.h"

namespace frana {

/// The field as a VTK array in its storage type (observe/file_arrays.h), with name and component names.
vtkSmartPointer<vtkDataArray> to_vtk(const Field& field, const std::vector<std::uint8_t>& outside);

/// Adds `name_unit` to the field data.
void add_unit(vtkFieldData* data, const std::string& name, const std::string& unit);

/// Adds the time [s] as TimeValue, which VTK's readers report as the file's time.
void add_time(vtkFieldData* data, double time);

/// An image of one layer whose points are the nodes.
vtkSmartPointer<vtkImageData> image_of(const GridGeometry& grid);

/// Adds `outside`, and HIDDENPOINT where it is 1 (why both: writers.h); nothing when it is empty.
void hide_nodes(vtkImageData* image, const std::vector<std::uint8_t>& outside);

/// The particles: points in double at "position", one vertex cell each, every other field as an array. They have units
/// and the time (writers_frame.cpp).
vtkSmartPointer<vtkPolyData> cloud_of(const Frame& frame);

/// The nodes with all their arrays, units and the time; nodes without terrain are hidden (writers_frame.cpp).
vtkSmartPointer<vtkImageData> image_of(const Frame& frame);

/// Writes atomically, LZ4 in inline base64. Throws UserError with path and reason.
void write_xml(vtkXMLWriter* writer, vtkDataObject* data, const std::filesystem::path& target);

}  // namespace frana
