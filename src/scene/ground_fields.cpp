#include "scene/ground_fields.h"

#include "scene/scene_parts.h"

namespace frana {

bool has_fields(const CaseFile& file) {
    return friction_differs(file) || file.word("erodible.law") != "none" || file.given("forest.detrainment");
}

std::function<GroundFields(const Raster& part)> fields_later(const CaseFile& file, const GisReader& reader,
                                                             const GridGeometry& terrain) {
    if (!has_fields(file)) return {};
    return [file, reader = reader.lasting(), terrain](const Raster& part) {
        Scene scene;  // its remarks were made when the run began
        Problems problems;
        set_physics(file, scene);
        scene.bed = part;
        scene.wider = std::make_shared<WiderTerrain>(WiderTerrain{terrain, {}, {}, {}, {}});
        read_friction(file, *reader, 0.0, scene, problems);
        const auto erodible = read_erodible(file, *reader, scene, problems);
        const auto forest = read_forest(file, *reader, scene, problems);
        problems.throw_if_any();
        return GroundFields{scene.friction, erodible ? erodible->depth : Raster(),
                            forest ? forest->pressure : Raster()};
    };
}

}  // namespace frana
