#pragma once
#include <fmt/core.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

/// An empty folder of its own, removed at the end of the test.
class FreshFolder {
public:
    FreshFolder() : path_(next_place()) {
        std::filesystem::remove_all(path_);
        std::filesystem::create_directories(path_);
    }
    ~FreshFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    FreshFolder(const FreshFolder&) = delete;
    FreshFolder& operator=(const FreshFolder&) = delete;
    const std::filesystem::path& path() const { return path_; }

private:
    static std::filesystem::path next_place() {
        static int count = 0;
        return std::filesystem::temp_directory_path() / fmt::format("frana_test_{}_{}", ::getpid(), count++);
    }

    std::filesystem::path path_;
};

inline std::string text_of(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
}
