#pragma once
// Columns among barriers: they take them for ground, and what runs up and over is watched.
#include "coupling/barriers.h"
#include "coupling/growing_columns.h"

namespace frana {

class WalledColumns final : public Simulation {
public:
    explicit WalledColumns(const Scene& scene, Start start = Start::placed);

    void advance(double until) override;
    const Status& status() const override { return run_->status(); }
    double longest_step() const override { return run_->longest_step(); }
    MovingMass motion(const MotionQuery& query) const override { return run_->motion(query); }
    Frame frame() override { return run_->frame(); }
    std::shared_ptr<const void> give_frame_away() override { return run_->give_frame_away(); }
    Sample at(const Vec2& point) const override { return run_->at(point); }
    bool may_rest() const override { return run_->may_rest(); }
    bool more_comes() const override { return run_->more_comes(); }
    Extras extras() const override { return run_->extras(); }
    std::vector<double> passed() const override { return run_->passed(); }
    const Raster* ground() const override { return run_->ground(); }
    /// Without faces: no force is known.
    const BarrierLoads* loads() const override { return &watch_.loads(); }
    std::vector<std::string> remarks() const override { return run_->remarks(); }
    std::vector<PhaseTime> timings() const override;
    void serialize(Archive& archive) override;
    std::string why_not_add(const Seeds& columns) const override { return run_->why_not_add(columns); }
    void add(const Seeds& columns) override { run_->add(columns); }

    const DepthAveraged& columns() const { return growing_ ? growing_->columns() : *whole_; }

private:
    DepthAveraged& solver() { return growing_ ? growing_->columns() : *whole_; }
    void sample();

    double density_;
    std::unique_ptr<DepthAveraged> whole_;     ///< on all of the terrain
    std::unique_ptr<GrowingColumns> growing_;  ///< or on a part of it
    Simulation* run_ = nullptr;                ///< the one that there is
    ColumnWatch watch_;
    StepClock timed_;
    double moved_ = 0.0;  ///< farthest way of a column since the last look [m]
};

}  // namespace frana
