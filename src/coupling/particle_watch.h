#pragma once
// Run-up and overtopping of barriers by depth-averaged particles.
#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "observe/observer.h"
#include "scene/scene.h"
#include "shallow/depth_averaged.h"
#include "solid3d/surfaces.h"

namespace frana {

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
    /// Takes a particle's place, once a round where it is near. It counts when its way from the last place first leads
    /// onto a barrier's crest or over it, and once. What is in an outline and not at the crest is still on its way. A
    /// particle that was not near before has no way yet. Of two that merge the one whose number remains counts for both
    /// from then on.
    void sample(const DepthAveraged& particles, const ParticleAt& particle);
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
    /// `from`: nullptr without a way. Returns whether the particle is on its way up the barrier, in its outline.
    bool sample_at(std::size_t n, const DepthAveraged& particles, const ParticleAt& particle, const Vec2* from);
    /// Whether a place on barrier n is at its crest by the ground that particles feel, or what is there reaches above the
    /// crest. That ground rises over a cell or two, a part of it in the outline. What is there may go back, or round a corner.
    bool on_crest(std::size_t n, const DepthAveraged& particles, const Vec2& place) const;
    /// Whether a way between two places beside a barrier leads over its crest, and not round a corner of its outline.
    bool goes_over(std::size_t n, const DepthAveraged& particles, const Vec2& from, const Vec2& to) const;
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

}  // namespace frana
