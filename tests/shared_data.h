#pragma once
// Real terrain and surveys that some tests read; they are not part of the project. Set FRANA_SHARED_DATA, or have
// a folder ../shared/data beside the project. Without it those tests say so and pass.
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

#include "catch.h"

inline std::optional<std::filesystem::path> shared_data(const std::string& name) {
    const char* named = std::getenv("FRANA_SHARED_DATA");
    const std::filesystem::path root =
        named ? std::filesystem::path(named) : std::filesystem::path(FRANA_SOURCE_DIR) / "../shared/data";
    if (std::filesystem::exists(root / name)) return root / name;
    WARN("data set " << name << " is not here; this test is skipped");
    return std::nullopt;
}
