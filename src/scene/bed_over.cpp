#include "scene/bed_over.h"

#include "terrain/part_of.h"

namespace frana {

Raster bed_over(const Raster& bed, const WiderTerrain* wider, const GridGeometry& shown) {
    const std::optional<NodeBox> box = wider ? box_of(shown, wider->grid) : std::nullopt;
    return box ? wider->read(common(united(*box, wider->held), NodeBox::all(wider->grid))) : bed;
}

}  // namespace frana
