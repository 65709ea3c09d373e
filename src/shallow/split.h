#pragma once
#include <limits>
#include <utility>
#include <vector>

#include "mpm/halving.h"
#include "shallow/flow.h"

namespace frana {

/// Splits points whose domain has grown, so that spreading material does not fall apart (numerical fracture).
class Splitter {
public:
    /// `least_mass`: no point lighter than this is split [kg]. `grown_mass`: a heavier one may have taken up more than
    /// its domain holds [kg].
    explicit Splitter(double least_mass, double grown_mass = std::numeric_limits<double>::infinity())
        : least_mass_(least_mass), grown_mass_(grown_mass) {}
    /// Widens domains that have grown far too heavy for their size. Clamps domain edges to one cell (or
    /// scheme.split_length, if longer) and gives strongly sheared domains a rectangle. Then, when scheme.split is on,
    /// halves every point whose longer edge reaches scheme.split_length cells. Where both are equally long it halves both ways.
    /// Children are at +- r/4 along that edge, with the velocity there. Mass and momentum are conserved exactly. New
    /// points are appended; returns how many. The caller sorts afterwards.
    Index split(Flow& flow);
    /// From now on split() tells whose parts the new points are.
    void note_parents() { halves_.notes = true; }
    /// Numbers of the points that were split, for each new one since the last call; theirs end at next_id().
    std::vector<Index> take_parents() { return std::exchange(halves_.parents, {}); }
    /// The same, which stay.
    const std::vector<Index>& parents() const { return halves_.parents; }
    void forget_parents() { halves_.parents.clear(); }
    Index next_id() const { return halves_.next_id; }
    void set_next_id(Index id) { halves_.next_id = id; }

private:
    template <class Real>
    void widen_grown(Flow& flow) const;

    double least_mass_, grown_mass_;
    Halves halves_;
};

}  // namespace frana
