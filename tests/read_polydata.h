#pragma once
// A .vtp file read back by VTK's own reader.
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkXMLPolyDataReader.h>

#include <filesystem>

#include "catch.h"

namespace test {

inline vtkSmartPointer<vtkPolyData> polydata(const std::filesystem::path& file) {
    vtkNew<vtkXMLPolyDataReader> reader;
    reader->SetFileName(file.string().c_str());
    reader->Update();
    REQUIRE(reader->GetErrorCode() == 0);
    return reader->GetOutput();
}

}  // namespace test
