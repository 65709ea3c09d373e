#include "vtk_io/figures/png_file.h"

#include <fmt/core.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>
#include <vtkPNGWriter.h>
#include <vtkUnsignedCharArray.h>

#include <cstring>
#include <string>

#include "base/atomic_file.h"
#include "base/error.h"

namespace frana {
namespace fs = std::filesystem;

void write_png(const Pixels& picture, const fs::path& png) {
    vtkNew<vtkImageData> image;
    image->SetDimensions(picture.width, picture.height, 1);
    image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
    std::memcpy(image->GetScalarPointer(), picture.rgb.data(), picture.rgb.size());
    vtkNew<vtkPNGWriter> writer;
    writer->WriteToMemoryOn();       // on a full disk libpng would talk to the console
    writer->SetCompressionLevel(3);  // half the time of the default; files are a few per cent larger
    writer->SetInputData(image);
    writer->Write();
    vtkUnsignedCharArray* bytes = writer->GetResult();
    if (writer->GetErrorCode() != 0 || bytes == nullptr)
        throw UserError(fmt::format("{}: VTK could not make a PNG of the picture", png.string()));
    write_text(png, std::string(reinterpret_cast<const char*>(bytes->GetPointer(0)),
                                static_cast<std::size_t>(bytes->GetNumberOfValues())));
}

Pixels read_png(const fs::path& png) {
    vtkNew<vtkPNGReader> reader;
    if (!fs::exists(png) || !reader->CanReadFile(png.c_str()))
        throw UserError(fmt::format("{}: is no PNG file that can be read", png.string()));
    reader->SetFileName(png.c_str());
    reader->Update();
    vtkImageData* image = reader->GetOutput();
    const int channels = image->GetNumberOfScalarComponents();
    expect(image->GetScalarType() == VTK_UNSIGNED_CHAR && channels >= 3, "a PNG of three or four bytes a pixel");
    Pixels pixels(image->GetDimensions()[0], image->GetDimensions()[1]);
    const auto* data = static_cast<const unsigned char*>(image->GetScalarPointer());
    for (int y = 0; y < pixels.height; ++y)
        for (int x = 0; x < pixels.width; ++x) {
            const unsigned char* p = data + (static_cast<std::ptrdiff_t>(y) * pixels.width + x) * channels;
            pixels.set(x, y, {p[0], p[1], p[2]});
        }
    return pixels;
}

}  // namespace frana
