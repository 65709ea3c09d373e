#pragma once
// Columns on a part of a large terrain, which grows before they come near its edge.
#include "shallow/depth_averaged.h"

namespace frana {

class GrowingColumns final : public Simulation {
public:
    /// Of a scene that holds a part of its terrain (Scene::wider).
    explicit GrowingColumns(const Scene& scene, Start start = Start::placed);

    void advance(double until) override;
    const Status& status() const override { return columns_->status(); }
    double longest_step() const override { return columns_->longest_step(); }
    MovingMass motion(const MotionQuery& query) const override { return columns_->motion(query); }
    /// Of the nodes that material has come near to, and of places that are always shown.
    Frame frame() override;
    std::shared_ptr<const void> give_frame_away() override { return columns_->give_frame_away(); }
    Sample at(const Vec2& point) const override { return columns_->at(point); }
    bool may_rest() const override { return columns_->may_rest(); }
    bool more_comes() const override { return columns_->more_comes(); }
    Extras extras() const override { return columns_->extras(); }
    std::vector<double> passed() const override { return columns_->passed(); }
    std::vector<std::string> remarks() const override;
    std::vector<PhaseTime> timings() const override { return columns_->timings(); }
    const Raster* ground() const override { return &scene_.bed; }
    void serialize(Archive& archive) override;
    std::string why_not_add(const Seeds& columns) const override { return columns_->why_not_add(columns); }
    void add(const Seeds& columns) override;

    const NodeBox& held() const { return held_; }   ///< nodes of the whole terrain that it works on
    DepthAveraged& columns() { return *columns_; }  ///< others once the part has grown
    const DepthAveraged& columns() const { return *columns_; }

private:
    /// A node of the whole terrain that a barrier raises for columns.
    struct Raised {
        Index i, j;
        double top;  ///< [m]
    };

    void find_raised();
    std::unique_ptr<DepthAveraged> columns_among_walls(Start start) const;
    void sample();
    NodeBox room_for(const NodeBox& worked, Index clear) const;
    void grow(const NodeBox& box);
    void hold(NodeBox box);
    Raster read_part(const NodeBox& box) const;

    Scene scene_;
    std::shared_ptr<const WiderTerrain> wider_;
    NodeBox held_;   ///< the scene's bed, of the whole terrain
    NodeBox shown_;  ///< nodes of the whole terrain that frames show
    std::vector<Raised> raised_;
    std::unique_ptr<DepthAveraged> columns_;
    Index times_grown_ = 0;
    bool aside_ = false;  ///< it comes back to a state that was put aside: until then there is room enough
};

}  // namespace frana
