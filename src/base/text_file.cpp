#include "base/text_file.h"

#include "base/error.h"

namespace frana {

TextFile::TextFile(const std::filesystem::path& target)
    : target_(target), file_(target), stream_(file_.path(), std::ios::binary) {}

void TextFile::commit() {
    flush();
    stream_.close();
    if (!stream_)
        throw UserError(fmt::format(
            "{}: cannot be written; check that the folder exists, its permissions and free space", target_.string()));
    file_.commit();
}

void TextFile::flush() {
    stream_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    buffer_.clear();
}

std::optional<std::string> text_in_file(const std::filesystem::path& file) {
    const std::string mark = "\xEF\xBB\xBF";
    std::error_code not_there;
    std::ifstream stream(file, std::ios::binary);
    if (!stream || std::filesystem::is_directory(file, not_there)) return {};
    std::string text{std::istreambuf_iterator<char>(stream), {}};
    if (text.compare(0, mark.size(), mark) == 0) text.erase(0, mark.size());
    return text;
}

std::string json_text(const std::string& text) {
    std::string quoted = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\')
            quoted += {'\\', c};
        else if (static_cast<unsigned char>(c) < 0x20)
            quoted += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
        else
            quoted += c;
    }
    return quoted + '"';
}

}  // namespace frana
