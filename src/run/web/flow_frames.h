#pragma once
// The frames of a page, stored while a run goes on.
#include <memory>
#include <vector>

#include "observe/observer.h"
#include "run/web/packed.h"

namespace frana {

/// The outputs of a run in order, not more of them than fit a page. When they become too many every second one goes, so
/// that the rest is evenly spread. The last one always stays.
class FlowFrames {
public:
    /// `footprint_depth`: what is thinner than a hundredth of it is not stored [m]. `most`: bytes of all frames.
    explicit FlowFrames(double footprint_depth, std::size_t most = 14'000'000)
        : wet_(footprint_depth / 100.0), most_(most) {}
    /// `lying`: volume of what has become bed, which is a part of the flow's depth [m3].
    void add(Index number, double time, const FlowFields& flow, double lying = 0.0);
    const std::vector<PackedFrame>& frames() const { return frames_; }
    Index every() const { return every_; }  ///< outputs for one that is stored: 1, 2, 4, ...
    void serialize(Archive& archive);

private:
    double wet_;
    std::size_t most_;
    Index every_ = 1;
    std::vector<PackedFrame> frames_;
};

/// Volume of a depth that lies on nodes [m3].
double volume_on(const GridGeometry& grid, const double* depth);

/// Adds each output to `into`, which outlives it.
std::unique_ptr<Observer> make_frame_keeper(FlowFrames& into);

}  // namespace frana
