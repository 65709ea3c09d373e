#pragma once
// A file as VTK's own reader sees it.
#include <vtkSmartPointer.h>

#include <filesystem>

#include "catch.h"
#include "read_back.h"

template <class Reader>
vtkSmartPointer<Reader> read(const std::filesystem::path& file) {
    auto reader = vtkSmartPointer<Reader>::New();
    REQUIRE(reader->CanReadFile(file.string().c_str()) != 0);
    reader->SetFileName(file.string().c_str());
    reader->Update();
    ++read_back.files;
    return reader;
}
