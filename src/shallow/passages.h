#pragma once
// What passes through lines on the map, by the paths of the points (THEORY.md (66)).
#include "scene/scene.h"
#include "shallow/flow.h"

namespace frana {

/// Every way of a point counts, those of halving and merging too. So between two lines around a place the mass changes by
/// what passes them, to round-off. One thread counts, in the order of the points: sums have the same bits on any number.
class Passages {
public:
    Passages(const std::vector<Section>& sections, const TileGrid& grid);

    /// Notes where the points near the lines are, before something moves them. `order`: the point at each place of the
    /// tiles, where a sort is planned and not carried out.
    void note(const Flow& flow, const std::vector<std::int32_t>* order = nullptr);
    /// They are where they were carried; of those that left the domain their last place counts.
    void count_moved(const Flow& flow);
    /// Some were halved: points from `first` on are new, with the ids of the points they are parts of.
    void count_halved(const Flow& flow, Index first, const std::vector<Index>& parents);
    /// Some went into others; `into` tells which, where `gone` is 1.
    void count_merged(const Flow& flow, const std::vector<std::uint8_t>& gone, const std::vector<std::int32_t>& into);
    /// A mass [kg] that went straight from one place to another [cells].
    void count(const Vec2& from, const Vec2& to, double mass);

    /// Net, in the sense of each section, since the start [kg].
    const std::vector<double>& passed() const { return passed_; }
    std::vector<double>& passed() { return passed_; }
    /// The sums of a run on another grid.
    void take_over(const Passages& from) { passed_ = from.passed_; }

private:
    struct Piece {
        Vec2 a, b;  ///< [cells]
        std::size_t section;
        double sense;  ///< 1: from its left to its right counts; -1: the other way
    };
    struct Noted {
        Index p;
        Vec2 place;   ///< [cells]
        double mass;  ///< [kg]
        Index id;
    };
    bool near(const Vec2& place) const;

    std::vector<Piece> pieces_;
    std::vector<double> passed_;
    std::vector<std::uint8_t> watched_;  ///< per tile: some of its points may come to a line
    std::vector<Noted> noted_;
    std::vector<std::size_t> by_id_;  ///< scratch
};

}  // namespace frana
