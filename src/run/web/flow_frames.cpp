#include "run/web/flow_frames.h"

#include <algorithm>

namespace frana {
namespace {

constexpr Index kMostPixels = 1'000'000;  // of a frame: what a graphics card and an eye still make use of

class FrameKeeper final : public Observer {
public:
    explicit FrameKeeper(FlowFrames& into) : into_(into) {}
    std::string name() const override { return "web"; }
    void observe(const Frame& frame) override {
        const Field *depth = frame.node("depth"), *speed = frame.node("speed");
        if (depth == nullptr) return;
        const double* shown = depth->data;
        double lying = 0.0;
        if (const Field* bed = frame.node("deposited_depth")) {  // what has become bed would vanish from the film
            with_bed_.resize(static_cast<std::size_t>(depth->count));
            for (std::size_t n = 0; n < with_bed_.size(); ++n)
                with_bed_[n] = depth->data[n] + (bed->data[n] > 0.0 ? bed->data[n] : 0.0);
            shown = with_bed_.data();
            lying = volume_on(frame.grid, bed->data);
        }
        into_.add(frame.number, frame.status.time, {frame.grid, shown, speed ? speed->data : nullptr}, lying);
    }
    void serialize(Archive& archive) override { into_.serialize(archive); }

private:
    FlowFrames& into_;
    std::vector<double> with_bed_;  ///< depth and deposit [m]
};

}  // namespace

double volume_on(const GridGeometry& grid, const double* depth) {
    double sum = 0.0;
    for (Index k = 0; k < grid.size(); ++k)
        if (depth[k] > 0.0) sum += depth[k];
    return sum * grid.cell * grid.cell;
}

void FlowFrames::add(Index number, double time, const FlowFields& flow, double lying) {
    const auto between = [&](const PackedFrame& frame) { return frame.number % every_ != 0; };
    frames_.erase(std::remove_if(frames_.begin(), frames_.end(), between), frames_.end());
    frames_.push_back(packed(flow, wet_, kMostPixels));
    frames_.back().number = number;
    frames_.back().time = time;
    frames_.back().lying = lying;
    const auto bytes = [&] {
        std::size_t sum = 0;
        for (const PackedFrame& frame : frames_) sum += frame.bytes.size();
        return sum;
    };
    while (bytes() > most_ && frames_.size() > 2) {
        every_ *= 2;
        frames_.erase(std::remove_if(frames_.begin(), frames_.end() - 1, between), frames_.end() - 1);
    }
}

void FlowFrames::serialize(Archive& archive) {
    auto count = static_cast<Index>(frames_.size());
    archive.number("every", every_);
    archive.number("frames", count);
    if (archive.loading()) frames_.assign(static_cast<std::size_t>(count), {});
    std::vector<double> numbers;  // of all frames, and their bytes one after the other
    std::vector<std::uint8_t> bytes;
    for (const PackedFrame& f : frames_) {
        for (const double number : {static_cast<double>(f.number), f.time, static_cast<double>(f.grid.nx),
                                    static_cast<double>(f.grid.ny), f.grid.x0, f.grid.y0, f.grid.cell, f.deepest,
                                    f.fastest, f.has_speed ? 1.0 : 0.0, static_cast<double>(f.bytes.size()), f.lying})
            numbers.push_back(number);
        bytes.insert(bytes.end(), f.bytes.begin(), f.bytes.end());
    }
    archive.array("numbers", numbers);
    archive.array("bytes", bytes);
    if (!archive.loading()) return;
    constexpr std::size_t kNumbers = 12;
    if (numbers.size() != kNumbers * frames_.size())
        Archive::wrong_length("numbers", numbers.size(), kNumbers * frames_.size());
    std::size_t used = 0;
    for (std::size_t k = 0; k < frames_.size(); ++k) {
        const double* n = numbers.data() + kNumbers * k;
        const auto whole = [&](std::size_t i) { return static_cast<Index>(n[i]); };
        const auto size = static_cast<std::size_t>(n[10]);
        if (used + size > bytes.size()) Archive::wrong_length("bytes", bytes.size(), used + size);
        const auto first = bytes.begin() + static_cast<std::ptrdiff_t>(used);
        frames_[k] = {whole(0),
                      n[1],
                      {whole(2), whole(3), n[4], n[5], n[6]},
                      n[7],
                      n[8],
                      n[9] != 0.0,
                      {first, first + static_cast<std::ptrdiff_t>(size)},
                      n[11]};
        used += size;
    }
}

std::unique_ptr<Observer> make_frame_keeper(FlowFrames& into) { return std::make_unique<FrameKeeper>(into); }

}  // namespace frana
