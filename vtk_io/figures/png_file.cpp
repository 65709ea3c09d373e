#include "vtk_io/figures/png_file.h"

#include <fmt/core.h>
#include <png.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

#include <string>

#include "base/atomic_file.h"
#include "base/error.h"

namespace frana {
namespace fs = std::filesystem;

void write_png(const Pixels& picture, const fs::path& png) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(picture.width);
    image.height = static_cast<png_uint_32>(picture.height);
    image.format = PNG_FORMAT_RGB;
    image.flags = PNG_IMAGE_FLAG_FAST;  // a third of the time of all filters; files of maps are 4 % larger
    std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(image), '\0');
    png_alloc_size_t size = bytes.size();
    const int upwards = -3 * picture.width;  // from one row to the next: ours begin at the lowest
    if (!png_image_write_to_memory(&image, bytes.data(), &size, 0, picture.rgb.data(), upwards, nullptr))
        throw UserError(fmt::format("{}: libpng could not make a PNG of the picture: {}", png.string(), image.message));
    bytes.resize(size);
    write_text(png, bytes);
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
