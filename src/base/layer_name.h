#pragma once
// One layer of a file that may hold several, in the words of QGIS: "FILE|layername=X".
#include <string>

namespace frana {

struct LayerName {
    std::string file;
    std::string layer;  ///< empty: not said
};

inline const std::string kLayerMark = "|layername=";

inline LayerName split_layer(const std::string& name) {
    const std::size_t mark = name.find(kLayerMark);
    if (mark == std::string::npos) return {name, ""};
    const std::size_t begin = mark + kLayerMark.size();
    return {name.substr(0, mark), name.substr(begin, name.find('|', begin) - begin)};
}

/// "field:NAME" names an attribute of the features in place of a file.
inline bool names_field(const std::string& text) { return text.rfind("field:", 0) == 0; }

}  // namespace frana
