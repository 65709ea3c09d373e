#pragma once
// 3D points that have more energy than the release could give them.
#include <optional>
#include <string>

#include "base/types.h"

namespace frana {

class Archive;
class Mpm3d;
struct Scene;

/// No material can be faster at an elevation than what falls there from the highest head of its release. So V
/// <= sqrt(2 g (available - z)). Some points of fluids may pass it, as spray does that the rest drives. Those that do
/// by more than one per cent of that speed are counted, with what the others did.
class Spray {
public:
    /// Of a scene with its particles.
    explicit Spray(const Scene& scene);

    void sample(const Mpm3d& flow);
    /// Nothing when no point had more.
    std::optional<std::string> remark() const;
    void serialize(Archive& archive);

    double available() const { return available_; }    ///< highest surface plus v^2 / 2g of the release [m]
    double most_share() const { return most_share_; }  ///< of the points' mass above it, at the worst sample [1]
    double fastest() const { return fastest_; }        ///< of the points that stay below it, of all samples [m/s]

private:
    double gravity_, available_ = 0.0;
    double most_share_ = 0.0, time_ = 0.0;  ///< [1], [s]
    double head_ = 0.0;                     ///< largest z + V^2 / 2g of a point [m]
    double fastest_ = 0.0, highest_ = 0.0;  ///< of points within what is available [m/s], [m]
};

}  // namespace frana
