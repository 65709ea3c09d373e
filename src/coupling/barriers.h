#pragma once
// Barriers in both models.
#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "convert/flow_particles.h"
#include "coupling/run_up.h"
#include "observe/observer.h"
#include "scene/scene.h"
#include "shallow/depth_averaged.h"
#include "solid3d/mpm3d.h"

namespace frana {

/// The solid of a barrier for material on cells of that size. Walls along a line are so thick that both of their sides
/// are separate. Throws UserError for an outline without area or a line that turns too sharply.
Prism solid_of(const Barrier& barrier, const Raster& bed, double cell);

/// A node within a barrier, or within half a cell of it (nodes_of_outline()).
struct BarrierNode {
    Index i, j;
    double top;  ///< of the highest barrier there [m]
};

/// All of them, row after row. A barrier may lie below the bed, and then raises nothing.
std::vector<BarrierNode> barrier_nodes(const Scene& scene);

/// What barriers stand on.
struct Footings {
    double firm = 0.0;       ///< ground that was loose [m3]
    double cleared = 0.0;    ///< where trees stood [m2]
    double displaced = 0.0;  ///< of a lake, in whose room they stand [m3]
};

/// Puts barriers into a scene whose first node is (i0, j0) of the one that their nodes were found in. The bed rises to their
/// tops, and no tree stands there or a cell around. Ground below a top, under it and a cell around, is firm from then
/// on. A barrier that stands has a footing that holds.
Footings stand_in(Scene& scene, const std::vector<BarrierNode>& nodes, Index i0, Index j0);

/// What a report says of them; nothing without any.
std::vector<std::string> remarks_on(const Footings& footings);

/// A barrier of that scene as a 3D surface. Throws as solid_of().
Surface surface_of(const Barrier& barrier, const Raster& bed, double cell);

/// The same as particles meet it. It holds the ground around itself alone: terrains are large, and barriers many.
Surface surface_around(const Barrier& barrier, const Scene& scene);

/// Lowest and highest corner of the box around a barrier; of a shape without the room around it [m].
std::pair<Vec3, Vec3> box_around(const Surface& barrier);

/// Elevation of a barrier's top at a place of the map; minus infinity outside of it [m].
double top_of(const Surface& barrier, const Vec2& place);

/// Particles within a barrier's outline stand on it, which is ground to them. Points inside it would be forced out and
/// gain what that lifts them.
void stand_on_barriers(FlowParticles& particles, const std::vector<Surface>& surfaces);

/// A particle's place in the map [m], and what it reaches up to and holds there.
struct ParticleAt {
    Index id;
    Vec2 place;
    double surface;   ///< elevation of its top [m]
    double volume;    ///< [m3]
    bool on_barrier;  ///< barriers raise all of the ground around
};

/// Which barriers are near a place, told by squares of some cells: the cost does not grow with barriers elsewhere.
class BarrierTiles {
public:
    BarrierTiles() = default;
    /// Of boxes of barriers, each widened by `margin` [m].
    BarrierTiles(const GridGeometry& grid, const std::vector<std::pair<Vec3, Vec3>>& boxes, double margin);
    /// The numbers of the barriers there, ascending: first and end; nullptr twice without any.
    std::pair<const Index*, const Index*> barriers_at(const Vec2& place) const {
        const auto i = static_cast<Index>(std::clamp((place.x() - x0_) / size_, 0.0, last_i_));
        const auto j = static_cast<Index>(std::clamp((place.y() - y0_) / size_, 0.0, last_j_));
        const auto tile = static_cast<std::size_t>(j * across_ + i);
        if (begin_[tile] == begin_[tile + 1]) return {nullptr, nullptr};
        return {numbers_.data() + begin_[tile], numbers_.data() + begin_[tile + 1]};
    }

private:
    double x0_ = 0.0, y0_ = 0.0, size_ = 1.0;  ///< south-west corner, side of a tile [m]
    double last_i_ = 0.0, last_j_ = 0.0;       ///< of the last tile; places beyond count as in the outer ones
    Index across_ = 1;
    std::vector<Index> numbers_;            ///< tile after tile
    std::vector<std::size_t> begin_{0, 0};  ///< of each tile in `numbers_`, and the end
};

/// Which particles run up barriers and over them. Their force on barriers is not known: barriers are ground to them.
class ParticleWatch {
public:
    explicit ParticleWatch(const Scene& scene);
    /// A particle was split: what is known of it holds for its part.
    void inherit(Index child, Index parent);
    /// Samples of all particles near barriers follow. Between two rounds none goes as far as two cells.
    void begin_round() { ++round_; }
    /// Whether a barrier may be within two cells of a place: elsewhere there is nothing to sample.
    bool is_near(const Vec2& place) const { return tiles_.barriers_at(place).first != nullptr; }
    /// Takes a particle's place, once a round where it is near. It counts when its way from the last place first leads
    /// onto a barrier, and once. A particle that was not near before has no way yet. Of two that merge the one whose
    /// number remains counts for both from then on.
    void sample(const ParticleAt& particle);
    /// After a step of particles, which note their parents, from the time `before` on: whether a round is due. It is
    /// when one may have moved by half a cell, and at `until`, an output time.
    bool is_due(DepthAveraged& particles, double before, double until);
    /// A round over all particles, of a material of that density [kg/m3].
    void sample_particles(const DepthAveraged& particles, double density);
    const BarrierLoads& loads() const { return loads_; }
    /// Of what a scene places on barriers, or lets in there.
    std::vector<std::string> remarks() const;
    void serialize(Archive& archive);

private:
    struct Entering {
        std::string inflow;
        double volume;  ///< on top of barriers, by the end of the run [m3]
    };
    void make_room(std::size_t id);
    void note_inflows(const Scene& scene);
    /// Whether a place is on top of a barrier, which stands out of the ground there; of that one.
    bool is_on_top(const Vec2& place) const;
    bool is_on(std::size_t n, const Vec2& place) const;
    /// Whether a barrier raises the bed at a node.
    bool is_raised(const Vec2& node) const;
    /// Elevation of the top of what stands at a place [m]. It is of the nodes around it that no barrier raises.
    /// Otherwise half of the barrier's height would count as run up. Not a number where barriers raise all that are
    /// wet.
    double adjacent_surface(const DepthAveraged& particles, const Vec2& place) const;
    void sample_at(std::size_t n, const ParticleAt& particle, const Vec2* from);
    std::vector<Surface> surfaces_;             ///< of each barrier
    std::vector<std::pair<Vec3, Vec3>> boxes_;  ///< around each
    std::vector<Raster> ground_;                ///< that each may be buried in
    BarrierTiles tiles_;
    Index round_ = 0;
    std::vector<Index> near_;  ///< by number of the particle: the last round in which it was near a barrier; 0: none
    std::map<Index, std::vector<Index>> over_;  ///< barriers that a particle has been over, by its number; few have
    std::vector<double> last_;                  ///< x and y of each particle's place in that round, by its number [m]
    BarrierLoads loads_;
    GridGeometry grid_;          ///< that barriers were found on; that of the particles may have grown
    std::vector<Index> raised_;  ///< nodes of it that barriers raise, ascending
    double cell_;
    double placed_ = 0.0;          ///< of releases, on top of barriers [m3]
    std::vector<Entering> enter_;  ///< of inflows that enter there
    double moved_ = 0.0;           ///< farthest way of a particle since the last round [m]
};

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
    std::vector<double> inside_;                     ///< share of each in the stage's window [1]
    std::vector<std::string> names_;                 ///< of each
    std::vector<std::vector<std::uint8_t>> places_;  ///< per barrier, by number of the point: where it was so far
    std::vector<double> at_start_;                   ///< volume at each as points begin [m3]
    std::vector<double> due_;         ///< of each: when the first point comes to it, at the speed it came with [s]
    std::vector<double> over_crest_;  ///< of each: largest depth of points on its top [m]
    BarrierLoads loads_;
    RunUp reached_, on_top_;        ///< at one barrier at a time: elevations, and heights over its top
    double density_, ramp_, cell_;  ///< ramp: of a barrier for particles; cell: of points [m]
    double placed_ = 0.0;           ///< of points that came to be on top of barriers [m3]
};

}  // namespace frana
