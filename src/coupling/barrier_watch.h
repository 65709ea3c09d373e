#pragma once
// Forces, run-up and overtopping of barriers by 3D points.
#include <string>
#include <utility>
#include <vector>

#include "coupling/run_up.h"
#include "observe/observer.h"
#include "scene/scene.h"
#include "solid3d/mpm3d.h"

namespace frana {

/// What 3D points do to barriers.
class BarrierWatch {
public:
    /// Barriers are the surfaces of that kind of the flow's scene, in the order of `scene`. Of those outside of the stage's
    /// window no force is known.
    BarrierWatch(const Scene& scene, const Mpm3d& flow, double blur);
    /// Takes what is at the barriers as points begin.
    void note_start(const Mpm3d& flow);
    /// Takes the impulses of the faces, and whether something has come to them.
    void accumulate_loads(const Mpm3d& flow);
    /// A point was split: what is known of it holds for its half.
    void inherit(Index child, Index parent);
    /// Takes run-up, and what came over the barriers from either side.
    void sample(const Mpm3d& flow);
    /// There are no points any more: from now on no force is known.
    void end() { loads_.measures = false; }
    /// Particles adjacent to the points, of which `after` is the watch, `before` its loads before the last round.
    void add(const BarrierLoads& before, const BarrierLoads& after);
    const BarrierLoads& loads() const { return loads_; }
    /// Of what the forces are not, in a stage that begins at `from` [s].
    std::vector<std::string> remarks(double from) const;
    /// The faces with what each of their patches got.
    std::vector<PatchedFace> patched(const Mpm3d& flow) const;
    void serialize(Archive& archive);

private:
    enum Place : std::uint8_t { unknown, below, over };
    bool is_touched(std::size_t n, const Mpm3d& flow);
    /// Elevation of a barrier's top at a place, where it stands out of the ground; minus infinity elsewhere [m].
    double top_above(std::size_t n, const Surface& solid, const Vec2& place) const;
    void remark_thin_over(std::vector<std::string>& remarks) const;
    std::uint8_t& place_of(std::size_t n, Index id);
    std::vector<int> surfaces_;                      ///< of each barrier
    std::vector<std::pair<Vec3, Vec3>> boxes_;       ///< around each
    std::vector<Raster> ground_;                     ///< that each may be buried in
    std::vector<std::string> names_;                 ///< of each
    std::vector<std::vector<std::uint8_t>> places_;  ///< per barrier, by number of the point: where it was so far
    std::vector<double> at_start_;                   ///< volume at each as points begin [m3]
    std::vector<double> due_;          ///< of each: when the first point comes to it, at the speed it came with [s]
    std::vector<double> over_crest_;   ///< of each: largest depth of points on its top [m]
    std::vector<double> points_over_;  ///< of each: volume of what went over it as points [m3]
    BarrierLoads loads_;
    double density_, ramp_, cell_;  ///< ramp: of a barrier for particles; cell: of points [m]
    RunUp reached_;                 ///< at one barrier at a time: elevations
    LayerDepth on_top_;             ///< and what lies above its top
    double placed_ = 0.0;           ///< of points that came to be on top of barriers [m3]
};

}  // namespace frana
