#pragma once
// The depth-averaged material point method (THEORY.md) on steep, curved terrain, or the choices of Fois et al. 2024.
#include <limits>
#include <memory>
#include <optional>

#include "mpm/step_clock.h"
#include "observe/frame_store.h"
#include "run/simulation.h"
#include "shallow/creep_filter.h"
#include "shallow/erosion.h"
#include "shallow/feed.h"
#include "shallow/flow_ledger.h"
#include "shallow/grid_update.h"
#include "shallow/late.h"
#include "shallow/mass_fit.h"
#include "shallow/merge.h"
#include "shallow/node_set.h"
#include "shallow/passages.h"
#include "shallow/peaks.h"
#include "shallow/split.h"
#include "shallow/surface.h"
#include "shallow/transfer.h"

namespace frana {

class DepthAveraged final : public Simulation {
public:
    explicit DepthAveraged(const Scene& scene, Start start = Start::placed);

    void advance(double until) override;
    const Status& status() const override { return status_; }
    double longest_step() const override;
    MovingMass motion(const MotionQuery& query) const override;
    /// What has just entered has not moved yet.
    bool may_rest() const override { return !more_comes() && ((!late_ && mass_added_ == 0.0) || status_.dt > 0.0); }
    bool more_comes() const override {
        return (feed_ && !feed_->over()) || (late_ && late_->next() < std::numeric_limits<double>::infinity());
    }
    Frame frame() override;
    Status frame_status() override;
    std::shared_ptr<const void> give_frame_away() override { return store_.give_away(); }
    std::vector<PhaseTime> timings() const override { return timed_.times(); }
    Sample at(const Vec2& point) const override;
    std::vector<double> passed() const override;
    Extras extras() const override;
    std::vector<std::string> remarks() const override;
    void serialize(Archive& archive) override;
    std::string why_not_add(const Seeds& particles) const override;
    void add(const Seeds& particles) override;

    /// From now on particles leave at these nodes and are noted. With `leave_now` those that stand there leave too, and
    /// are not noted.
    void open_exits(const NodeBox& nodes, bool leave_now);
    /// The particles that left so since the last call, by id.
    std::vector<Departed> take_departed();

    /// Velocities, half a step behind, come to the present. As at a start the next step is half a step of forces. What
    /// has been deposited is of before: take_in() has to follow.
    void catch_up();
    /// Nothing leaves any more at the nodes that open_exits() marked, and particles may sleep again.
    void close_exits();
    /// More particles, between two steps at `time` [s], the particles' own unless there are none. `gradient` is of the
    /// velocity of each, dv_k/dx_l at (k, l) [1/s]. They are recorded as what did not leave after all: mass, momentum
    /// and energy, which is returned [J].
    double take_in(const Seeds& seeds, const std::vector<Mat2>& gradient, double time);
    /// Whether a particle may stand at a place of the map: on ground, and not where particles leave.
    bool may_stand(double x, double y) const;

    /// For the next step: depth of other material on the nodes [m] (row after row from the south). It counts as depth
    /// of the particles everywhere, but for their mass and motion. They are deposited once more, with it. Nothing
    /// sleeps any more. Pressure on points (paper preset) does not feel it.
    void set_adjacent(const std::vector<double>& depth);

    /// From now on frames show these nodes only.
    void show(const NodeBox& box) { shown_ = box; }
    /// The nodes of all tiles on the work list. Some may lie beyond the grid.
    NodeBox worked() const;
    /// The particles, peaks and sums of a run on a part of this grid, which gives them up. This one was made for that
    /// (Start::resumed). Its node (0, 0) is (east, north) here.
    void take_over(DepthAveraged& from, Index east, Index north);

    /// From now on particles that are split are noted.
    void note_parents() {
        splitter_.note_parents();
        births_wanted_ = true;
    }
    /// A particle that another one was split into, and that one, by id.
    struct Birth {
        Index child, parent;
    };
    /// All since the last call, the oldest first.
    std::vector<Birth> take_births();

    const Flow& flow() const { return flow_; }
    /// Nothing when the bed is rock.
    const Erosion* erosion() const { return erosion_ ? &*erosion_ : nullptr; }
    /// timings() tell CPU time too from now on.
    void count_cpu_time() { timed_.count_cpu_time(); }
    /// Memory that grows with the points, sort buffers included [bytes].
    Index particle_bytes() const;
    /// What the fit of initial masses did; nothing when there was none.
    const std::optional<MassFit>& mass_fit() const { return fit_; }

private:
    template <class Real>
    void place(const Seeds& seeds);
    template <class Real>
    void append(const Seeds& seeds, Index first_id);
    void leave_at_exits();
    void level_points(double level);
    void arrive(const PointSums& points);
    NodeSums raise_surface();
    void add_adjacent(const std::vector<double>& depth);
    void serialize_points(Archive& archive);
    void serialize_sums(Archive& archive);
    void serialize_nodes(Archive& archive);
    void serialize_peaks(Archive& archive);
    void serialize_support(Archive& archive);
    void adapt_points(bool due, bool fed);
    bool exchange_is_due(double dt, double until, bool adapts);
    void erode(const Erosion::Step& step);
    void detrain(double dt);
    void settle();
    void note_buried();
    void take_rows();
    std::vector<Index> tiles_of_a_step() const;
    void enter_late();
    void take_late(const std::vector<const LateRelease*>& releases);
    template <class Real>
    double place_late(const LateRelease& release, PointSums& came);
    void enter_added();
    void support_inflows();
    void reach_supports();
    void fold_with_support();
    void leave_support_out(NodeSums& sums);
    double potential_of_support() const;
    struct Supported {
        Index k;
        double own;
    };
    std::optional<std::size_t> supported(Index k) const;
    double own_depth(Index k) const;
    bool is_support(const Supported& node) const;
    bool is_support(Index k) const;
    void put_peaks_aside();
    void put_peaks_back();
    void choose_sleep();
    void make_merger();
    double fastest_signal() const;
    Index split_points();
    bool merge_points();
    double step_length(double until) const;
    double longest_step(double cfl, double signal) const;
    double share_of_ordinary_step() const;
    double next_velocity_dt(double max_depth) const;
    double update_nodes(double dt);
    void accumulate_grid_update(const GridUpdateSums& sums, double velocity_dt);
    void accumulate_points(const PointSums& sums);
    void require_finite(const PointSums& sums) const;

    void account(const FlowLedger& more);
    void close_by_walls(Status& status) const;
    Status catch_up_on_copy();
    double fastest_node() const;
    void particle_fields(Frame& frame);
    double node_fields(Frame& frame);
    void stress_fields(Frame& frame);
    template <class Law>
    void stress_at_points(const Law& law, double* stresses) const;
    void stress_on_nodes(const double* stresses);

    Flow flow_;
    std::unique_ptr<TransferKernel> transfer_;
    std::unique_ptr<GridUpdateKernel> grid_update_;
    CreepFilter creep_filter_;
    Splitter splitter_;
    std::optional<Merger> merger_;    ///< nothing when the scheme does not merge
    std::optional<Erosion> erosion_;  ///< nothing when the bed is rock
    TileSorter sorter_;
    std::optional<Feed> feed_;          ///< nothing without inflows
    std::optional<LateReleases> late_;  ///< nothing without late releases
    Seeds added_;                       ///< from outside, that wait for the next step
    double mass_added_ = 0.0;           ///< that has entered [kg]
    bool aside_ = false;                ///< it comes back to a state that was put aside
    std::optional<NodeSet> supports_;   ///< nodes with depth of what is still to come in; nothing without inflows
    std::vector<Supported> supported_;  ///< the same in that order; the flow's own mass there [kg]
    std::vector<Index> support_tiles_;  ///< scratch
    struct NodePeaks {
        Index k;
        double depth, arrival, speed, pressure, dynamic_pressure;
    };
    std::vector<NodePeaks> peaks_aside_;  ///< of nodes where an inflow is held up
    std::optional<Passages> passages_;    ///< nothing without sections
    bool births_wanted_ = false;
    Index end_of_births_ = 0;  ///< number after that of the last point that a split made
    Peaks peaks_;
    StepClock timed_;
    Status status_;
    Ledger<FlowLedger> since_start_, until_frame_;  ///< the second at the time of the last frame
    std::optional<MassFit> fit_;

    NodeBox shown_;  ///< in frames
    Rheology rheology_;
    bool steep_, curved_, sleeps_;
    double footprint_depth_;
    std::array<double, 2> start_momentum_{};  ///< [kg m/s]
    double signal_ = 0.0;                     ///< largest |v| + sqrt(g_c h) seen in the last step [m/s]
    double velocity_dt_ = 0.0;                ///< time over which the last grid update accelerated the nodes [s]
    double since_split_ = 0.0;                ///< ordinary steps since points were last split
    double drift_ = 0.0;                      ///< largest distance since the last sort [cells]
    double stress_power_ = 0.0;               ///< of the present deposit [W]
    Vec2 centre_{0, 0};                       ///< of the release [cells]

    struct StressSum {
        double stress[3], mass;
    };
    LazyArray<StressSum> stress_sums_;  ///< per node, of the points' stress times mass [Pa kg], and mass [kg]
    TransferKernel::Probe probe_;
    FrameStore store_;
};

}  // namespace frana
