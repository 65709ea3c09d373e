#include "checks/fuzz/draft.h"

#include <fmt/core.h>

#include <cmath>
#include <sstream>

#include "base/error.h"
#include "scene/build_scene.h"

namespace frana::fuzz {
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
    std::map<std::string, std::string> tables;  // keys of [water] lie around those of [water.sides]
    for (const auto& [key, value] : draft.keys) {
        const std::size_t number = key.find('#');  // keys of a repeated table may have dots of their own
        const std::size_t dot = number == std::string::npos ? key.rfind('.') : key.find('.', number);
        tables[key.substr(0, dot)] += fmt::format("{} = {}\n", key.substr(dot + 1), value);
    }
    std::string text;
    for (const auto& [table, keys] : tables) {
        const std::size_t number = table.find('#');
        const bool repeated = table == "release" || number != std::string::npos;
        text += fmt::format(repeated ? "[[{}]]\n" : "[{}]\n", table.substr(0, number)) + keys;
    }
    return text;
}

Scene scene_of(const Draft& draft) {
    return build_scene(CaseFile::parse(toml_of(draft), "case.toml"), DraftReader(draft));
}

bool same(const Draft& a, const Draft& b) {
    if (a.model != b.model || a.keys != b.keys || a.steps != b.steps || a.rasters.size() != b.rasters.size())
        return false;
    for (const auto& [name, raster] : a.rasters) {
        const Raster& other = b.rasters.at(name);
        if (!(raster.geometry == other.geometry)) return false;
        for (std::size_t k = 0; k < raster.values.size(); ++k)
            if (raster.values[k] != other.values[k] && !(std::isnan(raster.values[k]) && std::isnan(other.values[k])))
                return false;
    }
    return true;
}

const std::vector<Model>& all_models() {
    static const std::vector<Model> models = {Model::depth_averaged, Model::mpm3d,  Model::structured, Model::water,
                                              Model::mixture,        Model::staged, Model::flood};
    return models;
}

const char* word_of(Model model) {
    switch (model) {
        case Model::depth_averaged:
            return "depth_averaged";
        case Model::mpm3d:
            return "mpm3d";
        case Model::structured:
            return "structured";
        case Model::water:
            return "water";
        case Model::mixture:
            return "mixture";
        case Model::staged:
            return "staged";
        case Model::flood:
            return "flood";
    }
    throw InternalError("unknown model");
}

namespace {

/// 3D points had another word once, which is still taken.
bool is_word_of(Model model, const std::string& word) {
    return word == word_of(model) || (model == Model::mpm3d && word == "solid_flow");
}

}  // namespace

std::vector<Model> models_of(const std::string& words) {
    if (words == "all") return all_models();
    std::vector<Model> models;
    std::istringstream in(words);
    for (std::string word; std::getline(in, word, ',');) {
        const std::size_t before = models.size();
        for (const Model model : all_models())
            if (is_word_of(model, word)) models.push_back(model);
        if (models.size() == before)
            throw UserError(
                fmt::format("--model: found \"{}\"; expected all, or some of depth_averaged, mpm3d, "
                            "structured, water, mixture, staged, flood with commas between; choose of these",
                            word));
    }
    if (models.empty()) throw UserError("--model: found no word; expected all, or the models to draw; name one");
    return models;
}

const char* word_of(Mirror mirror) {
    switch (mirror) {
        case Mirror::none:
            return "none";
        case Mirror::x:
            return "x";
        case Mirror::y:
            return "y";
        case Mirror::diagonal:
            return "diagonal";
    }
    throw InternalError("unknown mirror");
}

Mirror mirror_of(const std::string& word) {
    for (const Mirror mirror : {Mirror::none, Mirror::x, Mirror::y, Mirror::diagonal})
        if (word == word_of(mirror)) return mirror;
    throw UserError(fmt::format("--mirror: found \"{}\"; expected x, y or diagonal; choose one of them", word));
}

}  // namespace frana::fuzz
