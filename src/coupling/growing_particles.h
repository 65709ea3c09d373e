#pragma once
// Particles on a part of a large terrain, which grows before they come near its edge.
#include "coupling/footings.h"
#include "coupling/wrapped_simulation.h"
#include "shallow/depth_averaged.h"
#include "terrain/part_of.h"

namespace frana {

class GrowingParticles final : public WrappedSimulation {
public:
    /// Of a scene that holds a part of its terrain (Scene::wider).
    explicit GrowingParticles(const Scene& scene, Start start = Start::placed);

    void advance(double until) override;
    /// Of the nodes that material has come near to, and of places that are always shown.
    Frame frame() override;
    Status frame_status() override;
    std::vector<std::string> remarks() const override;
    const Raster* ground() const override { return &scene_.bed; }
    const Friction* friction() const override { return scene_.friction.get(); }
    void serialize(Archive& archive) override;
    void add(const Seeds& particles) override;

    const NodeBox& held() const { return held_; }             ///< nodes of the whole terrain that it works on
    DepthAveraged& particles() const { return *particles_; }  ///< others once the part has grown
    /// With the terrain that is held now, without what it began with.
    const Scene& scene() const { return scene_; }
    /// As those of DepthAveraged, with nodes of the whole terrain that the part holds. They stay as it grows.
    void open_exits(const NodeBox& nodes, bool leave_now);
    void close_exits();
    /// Frames show these nodes of the whole terrain from now on.
    void show_always(const NodeBox& nodes) { shown_ = united(shown_, nodes); }

private:
    Simulation& inner() const override { return *particles_; }

    void show_part();
    void find_barriers();
    std::unique_ptr<DepthAveraged> particles_among_walls(Start start);
    std::unique_ptr<DepthAveraged> resumed_particles();
    NodeBox of_part(const NodeBox& nodes) const {
        return {nodes.i0 - held_.i0, nodes.j0 - held_.j0, nodes.nx, nodes.ny};
    }
    void sample();
    NodeBox room_for(const NodeBox& worked, Index clear) const;
    void grow(const NodeBox& box);
    void hold(NodeBox box);
    void take_fields(GroundFields fields);
    Raster read_part(const NodeBox& box) const;

    Scene scene_;
    std::shared_ptr<const WiderTerrain> wider_;
    NodeBox held_;                            ///< the scene's bed, of the whole terrain
    NodeBox shown_;                           ///< nodes of the whole terrain that frames show
    std::vector<BarrierNode> barrier_nodes_;  ///< those of barriers, of the whole terrain
    Footings footings_;                       ///< of the barriers
    std::optional<NodeBox> exits_;            ///< where particles leave, of the whole terrain
    std::unique_ptr<DepthAveraged> particles_;
    Index times_grown_ = 0;
    bool aside_ = false;  ///< it comes back to a state that was put aside: until then there is room enough
};

}  // namespace frana
