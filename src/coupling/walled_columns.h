#pragma once
// Columns among barriers: they take them for ground, and what runs up and over is watched.
#include "coupling/barriers.h"
#include "shallow/depth_averaged.h"

namespace frana {

class WalledColumns final : public Simulation {
public:
    explicit WalledColumns(const Scene& scene, Start start = Start::placed);

    void advance(double until) override;
    const Status& status() const override { return columns_->status(); }
    double longest_step() const override { return columns_->longest_step(); }
    MovingMass motion(const MotionQuery& query) const override { return columns_->motion(query); }
    Frame frame() override { return columns_->frame(); }
    std::shared_ptr<const void> give_frame_away() override { return columns_->give_frame_away(); }
    Sample at(const Vec2& point) const override { return columns_->at(point); }
    bool may_rest() const override { return columns_->may_rest(); }
    bool more_comes() const override { return columns_->more_comes(); }
    Extras extras() const override { return columns_->extras(); }
    std::vector<double> passed() const override { return columns_->passed(); }
    /// Without faces: no force is known.
    const BarrierLoads* loads() const override { return &watch_.loads(); }
    std::vector<std::string> remarks() const override { return columns_->remarks(); }
    std::vector<PhaseTime> timings() const override;
    void serialize(Archive& archive) override;
    std::string why_not_add(const Seeds& columns) const override { return columns_->why_not_add(columns); }
    void add(const Seeds& columns) override { columns_->add(columns); }

    const DepthAveraged& columns() const { return *columns_; }

private:
    void sample();

    double density_;
    std::unique_ptr<DepthAveraged> columns_;
    ColumnWatch watch_;
    StepClock timed_;
    double moved_ = 0.0;  ///< farthest way of a column since the last look [m]
};

}  // namespace frana
