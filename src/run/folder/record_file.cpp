#include "run/folder/record_file.h"

#include <fstream>

namespace frana {

using Json = nlohmann::ordered_json;

Json json_in(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return Json::parse(stream, nullptr, false);
}

bool lists_files(const Json& record) {
    return record.is_object() && record.contains("files") && record["files"].is_array();
}

std::vector<Vec2> starts_in(const Json& record) {
    using namespace nlohmann::literals;
    if (!record.is_object()) return {};
    Json starts = record.value("/results/starts"_json_pointer, Json());
    if (!starts.is_array())
        starts = Json::array({record.value("/results/start"_json_pointer, Json())});  // older records have one
    std::vector<Vec2> places;
    for (const Json& start : starts)
        if (start.is_array() && start.size() == 2 && start[0].is_number() && start[1].is_number())
            places.emplace_back(start[0].get<double>(), start[1].get<double>());
    return places;
}

}  // namespace frana
