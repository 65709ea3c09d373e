#include "coupling/terrain_particles.h"

#include "coupling/lake_at_barriers.h"

namespace frana {

TerrainParticles::TerrainParticles(const Scene& scene, Start start)
    : begin_(scene.wider ? scene.wider->held : NodeBox::all(scene.bed.geometry)) {
    if (scene.wider)
        growing_ = std::make_unique<GrowingParticles>(scene, start);
    else
        hold_all(scene, start);
}

void TerrainParticles::hold_all(Scene scene, Start start) {
    if (!scene.barriers.empty()) {
        const Raster bed = scene.bed;
        footings_ = stand_in(scene, barrier_nodes(scene), 0, 0);
        footings_.displaced = make_room_in_lake(scene, bed);
    }
    whole_ = std::make_unique<DepthAveraged>(scene, start);
}

std::vector<std::string> TerrainParticles::remarks() const {
    std::vector<std::string> all = inner().remarks();
    for (const std::string& remark : remarks_on(footings_)) all.push_back(remark);
    return all;
}

NodeAt TerrainParticles::origin() const {
    if (!growing_) return {};
    const NodeBox& held = growing_->held();
    return {begin_.i0 - held.i0, begin_.j0 - held.j0};
}

void TerrainParticles::open_exits(const NodeBox& nodes, bool leave_now) {
    if (growing_)
        growing_->open_exits(of_terrain(nodes), leave_now);
    else
        whole_->open_exits(nodes, leave_now);
}

void TerrainParticles::close_exits() {
    if (growing_)
        growing_->close_exits();
    else
        whole_->close_exits();
}

}  // namespace frana
