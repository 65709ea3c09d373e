#pragma once
// A run in stages (Fois, de Falco, Formaggia 2025): particles, from a time on 3D points in a map window. The
// tail that still flows into the window is converted particle by particle, and what flows out becomes particles. Where
// the case says so, all are particles again later.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <optional>

#include "coupling/barrier_watch.h"
#include "coupling/flow_map.h"
#include "coupling/particle_watch.h"
#include "coupling/solid_scene.h"
#include "coupling/spray.h"
#include "coupling/stage_conversion.h"
#include "coupling/terrain_particles.h"
#include "observe/frame_store.h"

namespace frana {

class StagedRun final : public Simulation {
public:
    /// `scene` has a solid stage. Throws UserError when its points would not fit into memory.
    explicit StagedRun(const Scene& scene, Start start = Start::placed);

    void advance(double until) override;
    const Status& status() const override { return status_; }
    /// Known while one model is alone. Where there are both, steps end where they meet, and at output times.
    double longest_step() const override;
    MovingMass motion(const MotionQuery& query) const override;
    bool may_rest() const override;
    /// With 3D points: particles first, then points; "model" is 0 and 1. A point's depth, elevation and surface are
    /// those of the map at its place. Between outputs particles and map may be ahead or behind by a step of the
    /// particles.
    Frame frame() override;
    std::shared_ptr<const void> give_frame_away() override {
        return std::make_shared<const std::array<std::shared_ptr<const void>, 2>>(
            std::array<std::shared_ptr<const void>, 2>{terrain_->give_frame_away(), store_.give_away()});
    }
    Sample at(const Vec2& point) const override;
    const BarrierLoads* loads() const override { return watch_ ? &watch_->loads() : nullptr; }
    const Raster* ground() const override { return terrain_->ground(); }
    const Friction* friction() const override { return terrain_->friction(); }
    std::vector<std::string> remarks() const override;
    Extras extras() const override;
    std::vector<PhaseTime> timings() const override;
    void serialize(Archive& archive) override;

    /// The 3D points; nullptr before their stage.
    const Mpm3d* points() const { return points_.get(); }
    const DepthAveraged& particles() const { return terrain_->particles(); }

private:
    /// What the particles gave away, as they recorded it.
    struct Converted {
        double mass = 0.0, energy = 0.0, mass_later = 0.0;
        /// That points did not get: motion of what is set on barriers, or without `along_bed` up and down [J].
        double lost = 0.0;
        std::array<double, 2> momentum{};
    };

    /// What points gave back: what particles took of it, and the energy that they have no place for. Also what stands
    /// on ground that a barrier or a hole's wall raises, for want of a cell before it.
    struct Returned {
        double mass = 0.0, lost = 0.0, raised = 0.0;
    };

    using Marks = std::vector<std::uint8_t>;  ///< of nodes, 1 or 0
    DepthAveraged& depth_averaged() const { return terrain_->particles(); }
    const Scene& scene_now() const { return terrain_->grown() ? *terrain_->grown() : scene_; }
    void begin_3d(const std::function<FlowParticles(const Scene&, const Marks&)>& particles_at);
    SolidScene space_of_stage() const;
    void begin_watch();
    bool points_alone() const;
    double next_on_the_way_to(double time) const;
    void step_particles(double until);
    void take_departed();
    void step_points(double until);
    void convert_to_3d();
    void note_departed();
    using PlaceOf =
        std::function<Vec2(const DepartedPoint&, const Vec2&)>;  ///< of a particle of a point that has come there
    using Allowed = std::function<bool(Index, Index)>;           ///< of cells of nodes
    void convert_to_2d(const PlaceOf& place);
    void clear_ramps();
    void end_3d();
    void watch_particles(double before, double until);
    void sample_particles();
    void step_particles_alone(double until);
    Vec2 place_of_particle(const DepartedPoint& point, const Vec2& to);
    Vec2 where_allowed(const DepartedPoint& point, const Vec2& to) const;
    bool may_stand(const DepartedPoint& point, const Vec2& x, const Allowed& allowed) const;
    Vec2 in_cell(Index i, Index j, const Vec2& x) const;
    std::optional<Vec2> edge_before(const DepartedPoint& point, const Vec2& x, const Allowed& allowed) const;
    std::optional<Vec2> nearest_before(const DepartedPoint& point, const Vec2& x, const Allowed& allowed) const;
    double share_above_ramp(const DepartedPoint& point, const Vec2& x) const;
    bool is_raised(Index i, Index j) const;
    bool on_raised(const Vec2& x) const;
    void mark_raised();
    bool above_barrier(const Vec2& place) const;
    bool behind_barrier(const Vec3& from, const Vec2& place) const;
    void show_points();
    void show_particles();
    FlowParticles particles_at_edge(std::vector<Mat2>& gradients) const;
    GhostParticles ghosts_of(const FlowParticles& particles, const std::vector<Mat2>& gradients) const;
    SolidSeeds seeds_of_window(const FlowParticles& particles, const std::vector<Surface>& surfaces);
    void require_room(const FlowParticles& particles) const;
    void require_below_top(const FlowParticles& particles) const;
    void sample(double until);
    void find_pieces();
    void remark_walls(std::vector<std::string>& remarks) const;
    void remark_sound(std::vector<std::string>& remarks) const;
    void remark_law(std::vector<std::string>& remarks) const;
    void remark_cells(std::vector<std::string>& remarks) const;
    void remark_cells_at_barriers(std::vector<std::string>& remarks) const;
    double deepest_at(const Surface& barrier) const;
    /// Of particles as they became points, mean by mass [m].
    double depth_of_points() const { return became_points_ > 0.0 ? their_depth_ / became_points_ : 0.0; }
    void remark_pieces(std::vector<std::string>& remarks) const;
    void accumulate(const Status& particles);
    void note_largest();
    void serialize_returning(Archive& archive);
    void particle_fields(Frame& frame);
    void node_fields(Frame& frame);
    bool stands_in_window(Index i, Index j) const;
    double ground_at(Index i, Index j) const;

    std::uint8_t exit_at(Index i, Index j) const;
    NodeBox box_of_frame(const Frame& frame) const;

    /// Of the terrain that the run began with. It holds all that points and barriers do, and stays as it is: points have
    /// the same places, to the last bit, however far particles have come.
    Scene scene_;
    std::unique_ptr<TerrainParticles> terrain_;
    std::unique_ptr<Mpm3d> points_;
    SolidStart start_;
    FlowMap map_;
    std::optional<BarrierWatch> watch_;             ///< when there are barriers, from the stage on
    std::optional<ParticleWatch> particles_watch_;  ///< when there are, of particles before, around and after it
    std::vector<Departed> pending_;                 ///< particles that left into the window, ahead of the points' time
    std::vector<std::uint8_t>
        at_edge_;  ///< nodes in the window, and around its open sides as far as points feel particles
    std::vector<std::uint8_t> raised_;  ///< with barriers: 1 at nodes whose ground they raise for particles
    std::vector<double> points_depth_;  ///< scratch of show_points, on the terrain's nodes [m]
    std::vector<DepartedPoint>
        returning_;  ///< points that left where particles may stand, since the particles' last step
    Converted converted_;
    Returned returned_;
    bool ended_ = false;  ///< the 3D stage is over: its points, none, only have its sums
    bool aside_ = false;  ///< it shows an output between two of its steps, and comes back to the state before
    Status status_;
    /// Of both models in this step, before one was changed: peaks have them already [m], [m/s].
    double deepest_ = 0.0, fastest_ = 0.0;
    StepClock timed_;
    double moved_ = 0.0;  ///< farthest way of a point since the last sample of the map [m]
    PointsApart apart_;
    Spray spray_;
    double largest_mach_ = 0.0;  ///< fastest point over the speed of sound [1]
    double became_points_ = 0.0,
           their_depth_ = 0.0;  ///< mass of particles that did, and the sum of mass times depth [kg, kg m]
    double finest_needed_ =
        std::numeric_limits<double>::infinity();  ///< least resolving_cell() of the points so far [m]
    FrameStore store_;
};

}  // namespace frana
