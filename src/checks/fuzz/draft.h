#pragma once
// A case that exists in memory only: the text of its keys and its rasters. It becomes a Scene on the way that the files
// of a case take. So a draft written to a folder is the same case to the last bit.
#include <map>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace frana::fuzz {

/// What carries the material of a scene.
enum class Model { depth_averaged, mpm3d, structured, water, mixture, staged, flood };

/// Images of a draft that are the draft itself.
enum class Mirror { none, x, y, diagonal };

/// What must hold of a scene beyond what holds of any.
struct Claims {
    bool rests = false;            ///< nothing moves by one bit (a lake: no more than its level implies)
    Mirror mirror = Mirror::none;  ///< x: west and east change places, y: south and north, diagonal: x and y
    bool threads = false;          ///< one thread and two give the same bits
    bool resumes = false;          ///< saved half way and resumed it ends with the same bits
    bool resolved = false;         ///< the grid resolves its depth and bed: linear shapes conserve energy too
};

struct Draft {
    /// "material.bed.mu" -> "0.4": what a case file says, in TOML. Those of `release` belong to its one release. Of
    /// other tables that come more than once each has a number: "stage#0.model".
    std::map<std::string, std::string> keys;
    Model model = Model::depth_averaged;  ///< that the keys give
    /// By file name, on one grid; values that float32 holds, since that is what a GeoTIFF of ours holds.
    std::map<std::string, Raster> rasters;
    Claims claims;
    Index steps = 60;

    const Raster& dem() const { return rasters.at("dem.tif"); }
    bool has(const std::string& key) const { return keys.count(key) > 0; }
};

/// The case file, keys by table.
std::string toml_of(const Draft& draft);

/// Nearest number that float32 holds.
inline double single(double value) { return static_cast<double>(static_cast<float>(value)); }

/// The Scene, on the way of a case file. Throws UserError as reading the files would.
Scene scene_of(const Draft& draft);

/// The same keys, steps and rasters, bit for bit.
bool same(const Draft& a, const Draft& b);

/// All of them, and the word of each on the command line.
const std::vector<Model>& all_models();
const char* word_of(Model model);
/// Those that "all" or a list of words with commas names. Throws UserError for any other word.
std::vector<Model> models_of(const std::string& words);

const char* word_of(Mirror mirror);
/// Throws UserError for any other word.
Mirror mirror_of(const std::string& word);

}  // namespace frana::fuzz
