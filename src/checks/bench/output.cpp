#include "checks/bench/output.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <limits>

#include "base/error.h"
#include "checks/bench/blob.h"
#include "checks/bench/team_clock.h"
#include "shallow/depth_averaged.h"

namespace frana::bench {
namespace {

constexpr int kFrames = 5, kSteps = 6;
constexpr std::size_t kFields = 12;

/// A folder of one's own, removed with all that is in it.
class Folder {
public:
    explicit Folder(const std::filesystem::path& above) : path_(above / fmt::format("frana_bench_{}", ::getpid())) {
        std::error_code failed;
        std::filesystem::create_directories(path_, failed);
        if (failed)
            throw UserError(fmt::format("{}: cannot be made: {}; set TMPDIR to a folder that can be written",
                                        path_.string(), failed.message()));
    }
    ~Folder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

/// Least wall time of some calls [s].
template <class Body>
double least_seconds(int calls, Body&& body) {
    double least = std::numeric_limits<double>::infinity();
    for (int n = 0; n < calls; ++n) {
        const double start = wall_seconds();
        body(n);
        least = std::min(least, wall_seconds() - start);
    }
    return least;
}

Frame part_of(const Frame& frame, const FrameWriter& writer) {
    Frame part = frame;
    if (!writer.nodes) part.nodes.clear();
    if (!writer.particles)
        part.particles.erase(std::remove_if(part.particles.begin(), part.particles.end(),
                                            [](const Field& field) { return field.name != "position"; }),
                             part.particles.end());
    return part;
}

}  // namespace

std::vector<FrameCost> time_frames(Index particles, const std::vector<FrameWriter>& writers,
                                   const std::filesystem::path& folder) {
    const Folder room(folder);
    const TeamClock one(1);
    Blob blob;
    blob.particles = particles;
    DepthAveraged simulation(blob_scene(blob));
    const auto advance = [&] {
        for (int step = 0; step < kSteps; ++step) simulation.advance(std::numeric_limits<double>::max());
    };
    advance();
    const double step = least_seconds(kFrames, [&](int) { advance(); }) / kSteps;
    std::vector<FrameCost> costs;
    const auto accumulate = [&](const std::string& name, std::size_t fields, double seconds) {
        costs.push_back({name, static_cast<Index>(fields), seconds, seconds / step});
    };
    Frame frame;
    const double made = least_seconds(kFrames, [&](int) { frame = simulation.frame(); });
    expect(frame.particles.size() > kFields, "a frame has fewer fields than are to be timed");
    // The last is the effective stress, which depth and stress hold.
    frame.particles.resize(kFields);
    accumulate("fields", frame.particles.size() + frame.nodes.size(), made);
    for (const FrameWriter& writer : writers) {
        const std::filesystem::path own = room.path() / std::to_string(costs.size());
        std::filesystem::create_directory(own);
        const std::unique_ptr<Observer> observer = writer.make(own);
        Frame part = part_of(frame, writer);
        const double seconds = least_seconds(kFrames, [&](int n) {
            part.number = n;
            observer->observe(part);
        });
        const std::size_t node_fields = part.nodes.size(), point_fields = writer.particles ? part.particles.size() : 0;
        accumulate(writer.name, node_fields + point_fields, seconds);
    }
    return costs;
}

double steps_of(const std::vector<FrameCost>& costs, const std::string& writer) {
    double fields = std::numeric_limits<double>::quiet_NaN(), written = fields;
    for (const FrameCost& cost : costs) {
        if (cost.name == "fields") fields = cost.steps;
        if (cost.name == writer) written = cost.steps;
    }
    return fields + written;
}

}  // namespace frana::bench
