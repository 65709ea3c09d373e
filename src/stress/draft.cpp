#include "stress/draft.h"

#include <fmt/core.h>

#include <cmath>

#include "base/error.h"
#include "scene/build_scene.h"

namespace frana::stress {
namespace {

/// A draft's rasters, by the last part of their name.
class DraftReader final : public GisReader {
public:
    explicit DraftReader(const Draft& draft) : draft_(draft) {}

    Raster read_dem(const std::filesystem::path& file, const DemRequest&, std::vector<std::string>&) const override {
        return raster(file);
    }
    Raster read_raster(const std::filesystem::path& file, const std::array<double, 4>&, const std::string&,
                       std::vector<std::string>&) const override {
        return raster(file);
    }
    Raster read_onto(const std::filesystem::path& file, const GridGeometry& grid, const std::string&,
                     std::vector<std::string>&) const override {
        Raster read = raster(file);
        expect(read.geometry == grid, "a draft's rasters lie on one grid");
        return read;
    }
    Polygons read_polygons(const std::filesystem::path& file, const std::string&,
                           std::vector<std::string>&) const override {
        throw UserError(file.string() + ": a draft has no polygons");
    }
    std::vector<Polyline> read_lines(const std::filesystem::path& file, const std::string&,
                                     std::vector<std::string>&) const override {
        throw UserError(file.string() + ": a draft has no lines");
    }

private:
    Raster raster(const std::filesystem::path& file) const {
        const auto found = draft_.rasters.find(file.filename().string());
        if (found == draft_.rasters.end()) throw UserError(file.string() + ": a draft without this raster");
        Raster read = found->second;
        read.source = file.filename().string();
        return read;
    }

    const Draft& draft_;
};

}  // namespace

std::string toml_of(const Draft& draft) {
    std::string text, table;
    for (const auto& [key, value] : draft.keys) {  // sorted: a table's keys come together
        const std::size_t dot = key.rfind('.');
        if (key.substr(0, dot) != table) {
            table = key.substr(0, dot);
            text += fmt::format(table == "release" ? "[[{}]]\n" : "[{}]\n", table);
        }
        text += fmt::format("{} = {}\n", key.substr(dot + 1), value);
    }
    return text;
}

Scene scene_of(const Draft& draft) {
    return build_scene(CaseFile::parse(toml_of(draft), "case.toml"), DraftReader(draft));
}

bool same(const Draft& a, const Draft& b) {
    if (a.keys != b.keys || a.steps != b.steps || a.rasters.size() != b.rasters.size()) return false;
    for (const auto& [name, raster] : a.rasters) {
        const Raster& other = b.rasters.at(name);
        if (!(raster.geometry == other.geometry)) return false;
        for (std::size_t k = 0; k < raster.values.size(); ++k)
            if (raster.values[k] != other.values[k] && !(std::isnan(raster.values[k]) && std::isnan(other.values[k])))
                return false;
    }
    return true;
}

const char* word_of(Mirror mirror) {
    switch (mirror) {
        case Mirror::none: return "none";
        case Mirror::x: return "x";
        case Mirror::y: return "y";
        case Mirror::diagonal: return "diagonal";
    }
    throw InternalError("unknown mirror");
}

Mirror mirror_of(const std::string& word) {
    for (const Mirror mirror : {Mirror::none, Mirror::x, Mirror::y, Mirror::diagonal})
        if (word == word_of(mirror)) return mirror;
    throw UserError(fmt::format("--mirror: found \"{}\"; expected x, y or diagonal; choose one of them", word));
}

}  // namespace frana::stress
