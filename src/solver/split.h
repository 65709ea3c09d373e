#pragma once
#include "solver/flow.h"

namespace frana {

/// Splits points whose domain has grown, so that spreading material does not fall apart (numerical fracture).
class Splitter {
public:
    /// `least_mass`: no point lighter than this is split [kg].
    explicit Splitter(double least_mass) : least_mass_(least_mass) {}
    /// Clamps domain edges to one cell (or scheme.split_length, if longer) and gives strongly sheared domains a
    /// rectangle; then, when scheme.split is on, halves every point whose longer edge reaches scheme.split_length
    /// cells (both ways where both are equally long): children at +- r/4 along that edge, with the velocity there.
    /// Mass and momentum are kept exactly.
    /// New points are appended; returns how many. The caller sorts afterwards.
    Index split(Flow& flow);
    Index next_id() const { return next_id_; }
    void set_next_id(Index id) { next_id_ = id; }

private:
    template <class Real>
    Index split_as(Flow& flow);

    double least_mass_;
    Index next_id_ = 0;
    std::vector<Index> tile_first_;
};

}  // namespace frana
