#pragma once
// The flow takes up loose material of its bed, and leaves some behind (THEORY.md, sections 18, 20, 21). Here are the
// ledger of mass per node, and the exchange of a step. Later releases are cut out of the bed (section 17).
//
// Points have the demand, nodes the supply. So a point gets the share of its demand that the poorest of its nodes can
// give to all demands. What nodes have left over goes to the points with unmet demand. Where the supply lasts, each
// node loses what the points that gain deposit there. The surface of flow and bed does not move.
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "base/compensated_sum.h"
#include "mpm/node_groups.h"
#include "run/simulation.h"
#include "shallow/rest_clocks.h"
#include "shallow/tile_box.h"

namespace frana {

class MeansOfFour;

/// What an exchange changed, of all points and nodes.
struct ExchangeSums {
    double taken = 0.0;         ///< [kg]
    double gained = 0.0;        ///< mass before it, of the points that gained [kg]
    double px = 0.0, py = 0.0;  ///< momentum that came along [kg m/s]
    double lost = 0.0;          ///< kinetic energy that sharing it lost [J]
    double max_shift = 0.0;     ///< that a point was set back [cells]
};

/// The erodible bed of a run, and the passes over it. Numbers of nodes are those of a full node. At walls half of the
/// node lies beyond, as with the flow's own mass.
class Erosion {
public:
    /// Of a scene whose bed is erodible, or rock on which material is left behind, or out of which releases are cut.
    Erosion(const Scene& scene, Flow& flow);

    /// A step, and what is known of those to come.
    struct Step {
        double dt;                 ///< [s]
        double velocity_dt = 0.0;  ///< time over which its grid update accelerated the nodes; nothing: not known [s]
        double left = 0.0;         ///< until the run ends or something else enters [s]
        double sorted = 3.0;       ///< steps until points are sorted again
    };
    /// A step of `dt` [s] begins.
    void wait(double dt) { waited_ += dt; }
    /// Material came that has taken nothing yet. `alone`: there was none.
    void start_anew(bool alone) {
        share_rate_ = std::numeric_limits<double>::infinity();
        if (alone) waited_ = ahead_ = 0.0;
    }
    /// Points have come, from the one numbered `first` on. That others have moved where they are does not tell of them;
    /// nor, with `anew`, that others have rested.
    void begin(const Flow& flow, Index first, bool anew);
    /// Whether this step ends with an exchange. `adapts`: its points are sorted before they are deposited. `last`: after
    /// it the run ends, or something else enters.
    bool is_due(double dt, bool adapts, bool last) const;
    /// Points gain, the bed loses; after the gather and the sort, before the deposit. In one step, for all that waited, and
    /// some that follow.
    ExchangeSums exchange(Flow& flow, const Step& step);
    /// In the step that `now` has ended, points that have been at rest for long enough become bed. Returns what the
    /// flow got by it, below zero, or nothing where none did. After the gather, before anything comes in or points are
    /// sorted. The caller drops those marked in gone().
    std::optional<ExchangeSums> settle(Flow& flow, const Status& now);
    const std::vector<std::uint8_t>& gone() const { return gone_; }
    /// What trees take of the flow in a step of `dt` [s]; after the exchange, before the deposit. Sums are those of the flow:
    /// below zero. Where any_gone(), the caller drops the points marked in gone().
    ExchangeSums detrain(Flow& flow, double dt);
    bool any_gone() const { return any_gone_; }
    /// A release that stands in the bed goes: the bed falls, and its slopes and curvature follow at once. What is loose
    /// below it can be taken from now on. The caller wakes what sleeps.
    void cut(Flow& flow, const std::vector<ScarNode>& scar);
    /// The bed's numbers of a status.
    Status::Bed status() const;

    double eroded_depth(Index k) const { return (initial_[k] - left_[k]) * per_area_; }  ///< along gravity [m]
    double deposited_depth(Index k) const { return fresh(k) * per_area_of_flow_; }       ///< that lies there now [m]
    double bed_change(Index k) const {                                                   ///< [m]
        return deposited_depth(k) - eroded_depth(k) - (cut_ ? cut_[k] : 0.0);
    }
    double left(Index k) const { return left_[k]; }                      ///< of the original bed [kg]
    double fresh(Index k) const { return deposits_ ? fresh_[k] : 0.0; }  ///< deposit on top of it [kg]
    bool evolves() const { return evolves_; }
    bool deposits() const { return deposits_; }
    /// Something there is no more as the scene has it.
    bool has_changed(Index tile) const { return changed_[tile] != 0; }
    /// Those with nodes that have got a deposit in this step.
    const std::vector<Index>& raised_tiles() const { return raised_tiles_; }
    /// The ledger, and the bed where it has changed. Aside, it is those that a step may change, which reaches the tiles
    /// `reached`.
    void serialize(Archive& archive, Flow& flow, const std::vector<Index>& reached);
    /// Ledger and bed of a run on a part of this grid; its node (0, 0) is (east, north) here.
    void take_over(const Erosion& from, const Flow& old, Flow& flow, Index east, Index north);

private:
    struct SharedNode;
    /// Time that an exchange stands for [s].
    struct Stretch {
        double whole;        ///< all of it
        double owed;         ///< its part that has passed
        double middle;       ///< that had passed in the middle of the last step
        double step;         ///< the last step
        double velocity_dt;  ///< Step::velocity_dt
    };
    Stretch next_stretch(const Step& step);
    Erosion(const Scene& scene, const ErodibleBed& bed, Flow& flow);
    template <class Law, class Drag, class Real, bool kFresh>
    void demand_of_tile(Flow& flow, Index n, const Stretch& stretch, const Law& law, Drag& drag);
    template <class Law, bool kFresh>
    void see_layer(const MeansOfFour& means, Double4 cosine, erosion::StateOf<Double4>& state) const;
    template <class Real>
    void spread(Flow& flow, Index n, const Array& masses, LazyArray<double>& into);
    template <class Real>
    void take_shares(Flow& flow, Index n);
    template <class Real>
    void take_left_over(Flow& flow, Index n);
    template <class Real>
    void grow(Flow& flow, Index n);

    Double4 set_back(Flow& flow, Index p, int lanes, Mask4 chosen, Double4 dx, Double4 dy);
    void return_part(Flow& flow, Index p, double got);
    Double4 speeds_left(Double4 gain, Double4 braked) const;
    template <class Real>
    Real there_is(Index k) const;
    template <class Real>
    Real can_give(Index k) const;
    void prepare_deposition(const Scene& scene, const Flow& flow);
    void note_slowest(const Flow& flow, const Status& now);
    void unmark_raised(const Flow& flow);
    bool find_settled(Flow& flow);
    template <class Real>
    bool choose_settled(const Flow& flow, Index n);
    template <class Real>
    bool lies_on_rest(const Flow& flow, Index p) const;
    void prepare_forest(const Scene& scene, const Flow& flow);
    void prepare_scars(const Scene& scene, const Flow& flow);
    bool choose_wooded(const Flow& flow);
    template <class Real>
    void lose(Flow& flow, Index n, double dt);
    void give(Flow& flow);
    void list_given(const Flow& flow);
    void raise_tile(Flow& flow, Index tile);
    void list_ledger(Index tile);
    std::vector<SharedNode> changed_nodes(const Flow& flow, const TileGrid& to, Index east, Index north) const;
    void take_node(const Erosion& from, const Flow& old, Flow& flow, const SharedNode& node);
    void bend_taken_over(const Erosion& from, Flow& flow, const std::vector<SharedNode>& nodes,
                         const std::vector<Index>& tiles);
    void serialize_deposition(Archive& archive, const Flow& flow);
    bool choose(const Flow& flow);
    void make_room(const Flow& flow);
    void find_demand(Flow& flow, const Stretch& stretch);
    void find_gained(const Flow& flow);
    bool find_shares(Flow& flow);
    void share_out(Flow& flow);
    void lower(Flow& flow);
    void lower_tile(Flow& flow, Index tile);
    void collect_reach(const Flow& flow);
    void fold(const Flow& flow, LazyArray<double>& field) const;
    void follow_bed(Flow& flow);
    TileBox near_moved(const TileGrid& grid, Index tile) const;
    void refresh_moved(Flow& flow, const std::vector<Index>& tiles);
    void list_around(const TileGrid& grid, const std::vector<Index>& tiles);
    void refresh_taken_up(Flow& flow, const std::vector<Index>& tiles, const std::vector<std::uint8_t>& bent);
    void smooth_into_path(Flow& flow);
    void list_reached(const TileGrid& grid, Index far);
    double most_pending(const Flow& flow, Index tile) const;
    void count_tile(const Flow& flow, Index tile);
    void status_changed();
    std::vector<Index> tiles_to_keep(const Flow& flow, bool aside, const std::vector<Index>& reached) const;
    template <class Body>
    void for_each_eroding(const Flow& flow, Body&& body) const;
    template <class Body>
    void for_each_eroding_in_turn(const Flow& flow, Body&& body) const;

    ErosionLaw law_;
    BedLaw friction_;
    double momentum_, min_depth_, density_;
    double per_area_, per_area_of_flow_;  ///< depth of a mass on a node, of the original bed and of a deposit [m/kg]
    double fresh_crumb_;                  ///< of a deposit, that stays [kg]
    bool takes_, evolves_, curved_, bent_path_;
    std::vector<double> filter_;  ///< one half of the bed's smoothing, from its middle on

    LazyArray<double> left_, initial_;  ///< [kg]
    LazyArray<double> demand_, taken_;  ///< of the step, on the nodes; zero between steps [kg]
    LazyArray<Pair> gained_;            ///< of velocity, in the step's grid update [m/s]
    LazyArray<double> share_;           ///< of the demand that a node can give, then what is left over to give [1]
    LazyArray<double> pending_;         ///< change of z that the smoothed bed does not have yet [m]
    LazyArray<double> tile_pending_;    ///< largest of a tile [m]
    LazyArray<std::uint8_t> holds_;     ///< per tile of the domain: 1, something is left to take
    LazyArray<std::uint8_t> changed_;   ///< 1: something there is no more as the scene has it
    LazyArray<double> tile_mass_, tile_deepest_;  ///< [kg], [m]
    std::vector<Index> ledger_tiles_;             ///< that had something at the start, or got something, ascending

    bool deposits_ = false;            ///< material can be left behind
    std::optional<double> rest_time_;  ///< after which what rests becomes bed [s]; nothing: never
    LazyArray<double> fresh_;          ///< deposit, of the flow's density [kg]
    RestClocks clocks_;                ///< when there is such a time
    double rest_fraction_ = 0.0;       ///< time.rest_fraction
    double peak_mean_speed_ = 0.0;     ///< of all that was released, so far [m/s]
    double slowest_ = 0.0;             ///< what is no faster rests, and takes nothing [m/s]
    LazyArray<double> raised_;         ///< 1: has got a deposit in this step, and gives nothing; else 0
    std::vector<Index> raised_tiles_;  ///< that have such nodes, some twice
    std::vector<std::uint8_t> gone_;   ///< points that have become bed

    LazyArray<double> cut_;     ///< depth of releases that were cut out; no array where none ever are [m]
    LazyArray<double> buried_;  ///< so many releases still stand on the node: what is loose below is not taken

    Detrainment forest_;
    LazyArray<double> trees_;           ///< K of the nodes; no array without a forest [Pa]
    std::vector<std::uint8_t> wooded_;  ///< per tile of the domain: 1, its points may be among trees
    double least_mass_ = 0.0;           ///< of a point that goes on after it lost some [kg]
    bool any_gone_ = false;

    std::vector<std::uint8_t> eroding_;  ///< by position in ActiveTiles
    std::vector<std::uint8_t> marked_;   ///< scratch, per tile of the domain
    LazyArray<TileBox> moved_;           ///< per tile: nodes whose bed the pass at hand moved; none between passes
    std::vector<Index> nodes_, next_;    ///< tiles whose nodes the step may change; scratch
    std::vector<ExchangeSums> sums_;     ///< by position in ActiveTiles
    std::vector<TileReach> spread_to_;   ///< what the points of each tile gave something to, by position in ActiveTiles
    LazyArray<NodeGroups> in_reach_;     ///< the same by tile, of `nodes_`
    LazyArray<double> tile_energy_;      ///< [J]
    LazyArray<double> rows_;             ///< scratch of smooth_into_path; zero outside of it [m]
    bool scarce_ = false;                ///< some node has less than is demanded of it
    Array wanted_;                       ///< of points; in the end what they get [kg]
    Array missed_;                       ///< of it, for their poorest nodes' sake; when something is scarce [kg]
    Array speed_;                        ///< along the bed [m/s]
    Array from_x_, from_y_;              ///< where points with a demand were before they were set back [cells]
    Array extra_x_, extra_y_;            ///< what an exchange adds to velocities besides [m/s]
    Array braked_;                       ///< share of the speed that friction takes in the time of the exchange [1]
    CompensatedSum eroded_, deposited_, energy_;
    double initial_mass_ = 0.0, mass_ = 0.0, deepest_ = 0.0;
    double waited_ = 0.0;  ///< since the last exchange [s]
    double ahead_ = 0.0;   ///< the last exchange stands for so much time that followed it [s]
    /// What it took, of the mass of those that gained; none yet is beyond any [1/s].
    double share_rate_ = std::numeric_limits<double>::infinity();
};

template <class Body>
void Erosion::for_each_eroding(const Flow& flow, Body&& body) const {
    for_each_tile(flow.active, [&](Index n) {
        if (eroding_[static_cast<std::size_t>(n)]) body(n);
    });
}

template <class Body>
void Erosion::for_each_eroding_in_turn(const Flow& flow, Body&& body) const {
    for_each_tile_in_turn(flow.active, [&](Index n) {
        if (eroding_[static_cast<std::size_t>(n)]) body(n);
    });
}

}  // namespace frana
