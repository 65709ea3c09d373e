#pragma once
// What the bed law takes of the speeds of four points, whatever the law. A loop takes it by this interface where it would
// otherwise be compiled for each bed law again.
#include <array>
#include <utility>
#include <variant>

#include "law/bed/node_friction.h"
#include "shallow/flow.h"

namespace frana {

/// Friction that nothing depends on: of laws without stress, when the bed brings no momentum.
struct Unfelt {};

/// The bed law below four points.
class DragOfFour {
public:
    DragOfFour() = default;
    DragOfFour(const DragOfFour&) = delete;
    DragOfFour& operator=(const DragOfFour&) = delete;
    virtual ~DragOfFour() = default;
    /// To points at (x, y) [cells].
    virtual void move_to(Double4 x, Double4 y) = 0;
    /// What the law alone takes of their speeds on the map [m/s^2]. It is over a time in which no flow changes much.
    virtual Double4 decelerations(const BedStateOf<Double4>& bed, Double4 speed) const = 0;

protected:
    template <class Law>
    static Double4 by_law(const Law& law, const BedStateOf<Double4>& bed, Double4 speed) {
        constexpr double kShort = 2e-5;  // [s]; shorter, rounding would part mirror particles
        return (speed - speeds_after(law, bed, speed, speed, kShort)) * (1.0 / kShort);
    }
};

/// Of one law for all.
template <class Law>
class DragOfLaw final : public DragOfFour {
public:
    explicit DragOfLaw(const Law& law) : law_(law) {}
    void move_to(Double4, Double4) override {}
    Double4 decelerations(const BedStateOf<Double4>& bed, Double4 speed) const override {
        return by_law(law_, bed, speed);
    }

private:
    Law law_;
};

/// Of the laws of the nodes nearest to the points.
class DragOfNodes final : public DragOfFour {
public:
    explicit DragOfNodes(const Flow& flow) : flow_(flow) {}
    void move_to(Double4 x, Double4 y) override {
        for (int n = 0; n < 4; ++n) nearest_[static_cast<std::size_t>(n)] = flow_.grid.nearest(x[n], y[n]);
    }
    Double4 decelerations(const BedStateOf<Double4>& bed, Double4 speed) const override {
        return by_law(LawsHere<Double4>(*flow_.laws, nearest_), bed, speed);
    }

private:
    const Flow& flow_;
    std::array<Index, 4> nearest_{};
};

/// Calls body(drag) with the flow's friction, which is `law` where all nodes have the same.
template <class Body>
void with_drag(const Flow& flow, const BedLaw& law, Body&& body) {
    if (flow.laws) {
        DragOfNodes drag(flow);
        return body(static_cast<DragOfFour&>(drag));
    }
    std::visit(
        [&](const auto& friction) {
            DragOfLaw<std::decay_t<decltype(friction)>> drag(friction);
            body(static_cast<DragOfFour&>(drag));
        },
        law);
}

}  // namespace frana
