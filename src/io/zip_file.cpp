#include "io/zip_file.h"

#include <fmt/core.h>

#include "base/atomic_file.h"
#include "base/error.h"
#include "io/gdal_support.h"

namespace frana {

void write_zip(const std::filesystem::path& archive, const std::string& name, const std::string& text) {
    const gdal::Messages messages;
    const std::string held = gdal::name_in_memory("archive.zip");  // GDAL gives files in archives no date
    VSILFILE* file = VSIFOpenL(fmt::format("/vsizip/{}/{}", held, name).c_str(), "wb");
    const bool written = file != nullptr && VSIFWriteL(text.data(), 1, text.size(), file) == text.size();
    if (file != nullptr) VSIFCloseL(file);
    const std::string bytes = gdal::taken_from_memory(held);
    if (!written || bytes.empty() || messages.failed())
        throw UserError(fmt::format("{}: cannot be packed ({}); check that GDAL has zlib", archive.string(),
                                    messages.reason("no reason given")));
    write_text(archive, bytes);
}

}  // namespace frana
