#pragma once
// What a structured solid has come apart into: for tests and pictures, between steps.
#include "structured/structured_flow.h"

namespace frana {

/// Particles that were neighbours when this was made. A pair may be torn apart while neither particle is half broken.
/// It has lost contact by the discretisation, not by the material. That is numerical fracture.
class Neighbours {
public:
    /// Pairs nearer than `reach` [m].
    Neighbours(const StructuredFlow& flow, double reach);
    void serialize(Archive& archive);
    Index pairs() const { return static_cast<Index>(pairs_.size()); }

    struct Torn {
        Index all = 0, numerical = 0;
    };
    /// Pairs that are now farther apart than `distance` [m].
    Torn torn(const StructuredFlow& flow, double distance) const;

private:
    std::vector<std::pair<std::int64_t, std::int64_t>> pairs_;  ///< of ids
};

/// What counts as one piece: particles linked over less than `link` [m], of a damage below `damage`. Together they have
/// more than `share` of all mass.
struct PieceRule {
    double link = 1.0, damage = 2.0, share = 0.02;
};
/// Shares of the mass [1] in pieces, the largest first.
std::vector<double> pieces(const StructuredFlow& flow, const PieceRule& rule);

}  // namespace frana
