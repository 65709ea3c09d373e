#pragma once
// The flow takes up loose material of its bed: a ledger of mass per node, and the exchange of a step (THEORY.md, section 18).
//
// Points know what they want, nodes what there is. So a point gets the share of its demand that the poorest of its nodes can
// give to all that want; what nodes have left over goes to those that want it. Where the supply lasts, each node loses what
// the points that gain deposit there: the surface of flow and bed does not move.
#include <memory>
#include <vector>

#include "base/compensated_sum.h"
#include "run/simulation.h"
#include "shallow/flow.h"

namespace frana {

/// What an exchange changed, of all points and nodes.
struct ExchangeSums {
    double taken = 0.0;         ///< [kg]
    double px = 0.0, py = 0.0;  ///< momentum that came along [kg m/s]
    double lost = 0.0;          ///< kinetic energy that sharing it lost [J]
    double max_shift = 0.0;     ///< that a point was set back [cells]
};

/// The erodible bed of a run, and the passes over it. Numbers of nodes are those of a full node: at walls half of the node
/// lies beyond, as with the flow's own mass.
class Erosion {
public:
    /// Of a scene that has an erodible bed.
    Erosion(const Scene& scene, Flow& flow);

    /// Points gain, the bed loses, in a step of `dt` [s]; after the gather and the sort, before the deposit.
    ExchangeSums exchange(Flow& flow, double dt);
    /// The bed's numbers of a status.
    Status::Bed status() const;

    double eroded_depth(Index k) const { return (initial_[k] - left_[k]) * per_area_; }  ///< along gravity [m]
    double bed_change(Index k) const { return -eroded_depth(k); }                        ///< [m]
    double left(Index k) const { return left_[k]; }                                      ///< [kg]
    bool evolves() const { return evolves_; }
    /// The ledger, and the bed where it has changed; aside those that a step may change, which reaches the tiles `reached`.
    void serialize(Archive& archive, Flow& flow, const std::vector<Index>& reached);

private:
    template <class Law, class Friction, class Real>
    void demand_of_tile(Flow& flow, Index n, double dt, const Law& law, const Friction& friction);
    template <class Real>
    void spread(const Flow& flow, Index n, const Array& masses, LazyArray<double>& into) const;
    template <class Real>
    void take_shares(const Flow& flow, Index n);
    template <class Real>
    void take_left_over(const Flow& flow, Index n);
    template <class Real>
    void grow(Flow& flow, Index n);

    double set_back(Flow& flow, Index p, double dx, double dy) const;
    double speed_left(double gain, double braked) const;
    bool choose(const Flow& flow);
    void make_room(const Flow& flow);
    void find_demand(Flow& flow, double dt);
    bool find_shares(Flow& flow);
    void share_out(Flow& flow);
    void lower(Flow& flow);
    void lower_tile(Flow& flow, Index tile);
    void fold(const Flow& flow, LazyArray<double>& field) const;
    void follow_bed(Flow& flow);
    void smooth_into_path(Flow& flow);
    void list_reached(const TileGrid& grid, Index far);
    double most_pending(const Flow& flow, Index tile) const;
    void count_tile(const Flow& flow, Index tile);
    void status_changed();
    std::vector<Index> tiles_to_keep(const Flow& flow, bool aside, const std::vector<Index>& reached) const;
    template <class Body>
    void for_each_eroding(const Flow& flow, Body&& body) const;
    template <class Body>
    void for_each_eroding_coloured(const Flow& flow, Body&& body) const;

    ErosionLaw law_;
    BedLaw friction_;
    double momentum_, min_depth_, density_;
    double per_area_;  ///< depth of a mass on a node [m/kg]
    bool evolves_, curved_, bent_path_;
    std::vector<double> filter_;  ///< one half of the bed's smoothing, from its middle on

    LazyArray<double> left_, initial_;  ///< [kg]
    LazyArray<double> demand_, taken_;  ///< of the step, on the nodes; zero between steps [kg]
    LazyArray<double> share_;           ///< of the demand that a node can give, then what is left over to give [1]
    LazyArray<double> pending_;         ///< change of z that the smoothed bed does not have yet [m]
    LazyArray<double> tile_pending_;    ///< largest of a tile [m]
    LazyArray<std::uint8_t> holds_;     ///< per tile of the domain: 1, something is left to take
    LazyArray<std::uint8_t> changed_;   ///< 1: something there is no more as the scene has it
    LazyArray<double> tile_mass_, tile_deepest_;  ///< [kg], [m]
    std::vector<Index> ledger_tiles_;             ///< that had something at the start

    std::vector<std::uint8_t> eroding_;  ///< by position in ActiveTiles
    std::vector<std::uint8_t> marked_;   ///< scratch, per tile of the domain
    std::vector<Index> nodes_, next_;    ///< tiles whose nodes the step may change; scratch
    std::vector<ExchangeSums> sums_;     ///< by position in ActiveTiles
    LazyArray<double> tile_energy_;      ///< [J]
    LazyArray<double> rows_;             ///< scratch of smooth_into_path; zero outside of it [m]
    bool scarce_ = false;                ///< some node has less than is wanted of it
    Array wanted_, gained_;              ///< of points; what they wanted they gained, unless something is scarce [kg]
    Array speed_;                        ///< along the bed [m/s]
    Array braked_;                       ///< share of the speed that friction takes in the step [1]
    CompensatedSum eroded_, energy_;
    double initial_mass_ = 0.0, mass_ = 0.0, deepest_ = 0.0;
};

}  // namespace frana
