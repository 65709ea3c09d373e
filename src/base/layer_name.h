#pragma once
// One layer of a file that may hold several, and a filter of its features, in the words of QGIS:
// "FILE|layername=X|subset=FILTER".
#include <algorithm>
#include <string>

namespace frana {

struct LayerName {
    std::string file;
    std::string layer;   ///< empty: not said
    std::string filter;  ///< of the features, by their attributes; empty: all
    std::string rest;    ///< what follows the layer's name and is no filter, as found
};

inline const std::string kLayerMark = "|layername=";
inline const std::string kFilterMark = "|subset=";

/// A filter goes on to the end of the text, since it may have a "|" of its own.
inline LayerName split_layer(const std::string& name) {
    const std::size_t end = name.size(), filter = std::min(name.find(kFilterMark), end),
                      layer = std::min(name.find(kLayerMark), filter);
    LayerName parts;
    parts.file = name.substr(0, layer);
    if (filter < end) parts.filter = name.substr(filter + kFilterMark.size());
    if (layer == filter) return parts;
    const std::size_t begin = layer + kLayerMark.size(), rest = std::min(name.find('|', begin), filter);
    parts.layer = name.substr(begin, rest - begin);
    parts.rest = name.substr(rest, filter - rest);
    return parts;
}

/// `name` with that layer, before the filter that it may have.
inline std::string with_layer(const std::string& name, const std::string& layer) {
    const std::size_t at = std::min(name.find(kFilterMark), name.size());
    return name.substr(0, at) + kLayerMark + layer + name.substr(at);
}

/// "field:NAME" names an attribute of the features in place of a file.
inline bool names_field(const std::string& text) { return text.rfind("field:", 0) == 0; }

}  // namespace frana
