#pragma once
// One moment of a run that has 3D points, and what several moments show in common.
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "vtk_io/figures/barriers_3d.h"
#include "vtk_io/reader.h"

namespace frana {

struct Moment3d {
    double time = 0.0;  ///< [s]
    struct Piece {
        Vec3 place{0, 0, 0};  ///< of a particle on its surface [m]
        double size = 0.0;    ///< edge of a cube as large as a point, width of a particle [m]
        double speed = 0.0;   ///< [m/s]
        double ground = 0.0;  ///< elevation of the bed below [m]
        bool is_particle = false;
    };
    std::vector<Piece> material;
    Vec3 momentum{0, 0, 0};     ///< of the 3D points, for a density of 1 [m4/s]
    Vec3 middle{0, 0, 0};       ///< of their volume [m]
    double typical_size = 0.0;  ///< median of the points' sizes; 0 without any [m]
    std::vector<BarrierSolid> barriers;
    /// The barrier with the largest load, nullptr where none has any.
    const BarrierSolid* most_loaded() const;
};

/// Needs position, volume and a speed or velocity; without "model" all are points. UserError when one is
/// missing.
Moment3d moment_3d(const LoadedParticles& particles, std::vector<BarrierSolid> barriers);

/// What pictures of one run have in common, so that they can be compared by eye.
struct View3d {
    std::array<double, 4> box{};  ///< shown: xmin, ymin, xmax, ymax [m]
    double fastest = 1.0;         ///< of the colours [m/s]
    double pressure = 0.0;        ///< of the colours [Pa]; 0: there is never a load
    Vec2 flow{1, 0};              ///< where the flow goes, unit length
    Vec2 through{0, 0};           ///< a place in the middle of what happens [m]
};

/// Collects moments. What they have in common: all points but the outermost per cent of each direction, and the
/// barriers. None is further from the most loaded barrier than three times its length. Also the 99.5th percentile of
/// the speeds and the largest pressure, rounded up. The flow's direction is that of its force on the most loaded
/// barrier. Without one it is that of the points' momentum when it is largest.
class Shared3d {
public:
    void add(const Moment3d& moment);
    bool empty() const { return !seen_; }
    View3d view() const;

private:
    using Box = std::array<double, 4>;
    std::optional<Box> seen_, struck_;
    double reach_ = 0.0, fastest_ = 0.0, pressure_ = 0.0, load_ = 0.0, momentum_ = -1.0;
    Vec2 force_{0, 0}, at_load_{0, 0}, motion_{1, 0}, middle_{0, 0};
};

/// The same with its box drawn in around the most loaded barrier of the moment. It extends three times that barrier's
/// height about it. The wall is what has to be seen. Without a load nothing changes.
View3d close_view(View3d shared, const Moment3d& moment);

}  // namespace frana
