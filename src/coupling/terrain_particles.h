#pragma once
// Particles on all of a terrain, or on a part of it that grows; to them barriers are ground.
#include "coupling/footings.h"
#include "coupling/growing_particles.h"
#include "terrain/places.h"

namespace frana {

class TerrainParticles final : public WrappedSimulation {
public:
    explicit TerrainParticles(const Scene& scene, Start start = Start::placed);

    std::vector<std::string> remarks() const override;

    DepthAveraged& particles() const { return growing_ ? growing_->particles() : *whole_; }
    /// With the terrain that is held now; nullptr where that is all of it, the scene's own.
    const Scene* grown() const { return growing_ ? &growing_->scene() : nullptr; }
    /// The node of the particles' grid that is node (0, 0) of the scene that they began with.
    NodeAt origin() const;
    /// As DepthAveraged::open_exits() and close_exits(), with nodes of that scene, also on a part that grows later.
    void open_exits(const NodeBox& nodes, bool leave_now);
    void close_exits();
    /// Frames show these nodes of that scene from now on, whether material comes near or not.
    void show_always(const NodeBox& nodes) {
        if (growing_) growing_->show_always(of_terrain(nodes));
    }

private:
    Simulation& inner() const override {
        if (growing_) return *growing_;
        return *whole_;
    }
    void hold_all(Scene scene, Start start);
    NodeBox of_terrain(const NodeBox& nodes) const {
        return {nodes.i0 + begin_.i0, nodes.j0 + begin_.j0, nodes.nx, nodes.ny};
    }

    NodeBox begin_;                              ///< the scene's bed, of all of the terrain
    Footings footings_;                          ///< of barriers on all of the terrain
    std::unique_ptr<DepthAveraged> whole_;       ///< on all of the terrain
    std::unique_ptr<GrowingParticles> growing_;  ///< or on a part of it
};

}  // namespace frana
