#include "vtk_io/figures/png_file.h"

#include <fmt/core.h>
#include <libdeflate.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

#include <cstdint>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "base/atomic_file.h"
#include "base/error.h"

namespace frana {
namespace fs = std::filesystem;

namespace {

/// A number as PNG has it.
std::string four_bytes(std::uint32_t number) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(number >> shift);
    return bytes;
}

/// Length, name, data, and the sum of the latter two.
std::string chunk(const std::string& name, const std::string& data) {
    const std::string summed = name + data;
    return four_bytes(static_cast<std::uint32_t>(data.size())) + summed +
           four_bytes(libdeflate_crc32(0, summed.data(), summed.size()));
}

/// Rows from the top, each as the differences to the one above it (filter "up"): shaded ground is like that one.
std::string rows_of(const Pixels& picture) {
    const std::size_t width = static_cast<std::size_t>(picture.width) * 3;
    std::string rows;
    rows.reserve((width + 1) * static_cast<std::size_t>(picture.height));
    const std::vector<std::uint8_t> nothing(width, 0);
    const std::uint8_t* above = nothing.data();
    for (int y = picture.height - 1; y >= 0; --y) {  // ours begin at the lowest
        constexpr char kUp = 2;
        const std::uint8_t* const row = picture.rgb.data() + static_cast<std::size_t>(y) * width;
        rows += kUp;
        for (std::size_t x = 0; x < width; ++x) rows += static_cast<char>(row[x] - above[x]);
        above = row;
    }
    return rows;
}

/// The format of zlib. The levels below take no less time, the ones above half more for a twentieth of the bytes.
std::string deflated(const std::string& bytes) {
    constexpr int kLevel = 2;
    const std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> compressor(
        libdeflate_alloc_compressor(kLevel), libdeflate_free_compressor);
    if (!compressor) throw std::bad_alloc();
    std::string packed(libdeflate_zlib_compress_bound(compressor.get(), bytes.size()), '\0');
    packed.resize(libdeflate_zlib_compress(compressor.get(), bytes.data(), bytes.size(), packed.data(), packed.size()));
    return packed;
}

}  // namespace

void write_png(const Pixels& picture, const fs::path& png) {
    expect(picture.width > 0 && picture.height > 0, "a picture has pixels");
    const std::string header = four_bytes(static_cast<std::uint32_t>(picture.width)) +
                               four_bytes(static_cast<std::uint32_t>(picture.height)) +
                               std::string("\x08\x02\0\0\0", 5);  // bits a colour, RGB, none of the variants
    write_text(png, "\x89PNG\r\n\x1a\n" + chunk("IHDR", header) + chunk("sRGB", std::string(1, '\0')) +
                        chunk("IDAT", deflated(rows_of(picture))) + chunk("IEND", ""));
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
