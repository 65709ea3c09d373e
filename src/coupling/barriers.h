#pragma once
// Barriers as both models see them.
#include <vector>

#include "convert/flow_columns.h"
#include "observe/observer.h"
#include "scene/scene.h"
#include "solid3d/mpm3d.h"

namespace frana {

/// The solid of a barrier for material on cells of that size: walls along a line are thick enough that both
/// of their sides are kept apart. Throws UserError for an outline without area or a line that turns too
/// sharply.
Prism solid_of(const Barrier& barrier, const Raster& bed, double cell);

/// The bed as columns see it: where a node lies in a barrier, or within half a cell of it, as high as its
/// top.
Raster with_barriers(const Scene& scene);

/// A barrier of that scene as a 3D surface. Throws as solid_of().
Surface surface_of(const Barrier& barrier, const Raster& bed, double cell);

/// Elevation of a barrier's top at a place of the map; minus infinity beside it [m].
double top_of(const Surface& barrier, const Vec2& place);

/// Columns within a barrier's outline stand on it, which is ground to them: points inside it would be pushed out and gain
/// what that lifts them.
void stand_on_barriers(FlowColumns& columns, const std::vector<Surface>& surfaces);

/// A column's place in the map [m], and what it reaches up to and holds there.
struct ColumnAt {
    Index id;
    Vec2 place;
    double surface;  ///< elevation of its top [m]
    double volume;   ///< [m3]
};

/// Which columns run up barriers and over them. Nothing tells how hard they push: barriers are ground to them.
class ColumnWatch {
public:
    explicit ColumnWatch(const Scene& scene);
    /// A column was split: what is known of it holds for its part.
    void inherit(Index child, Index parent);
    /// Takes a column's place. It counts when its way from the last place first leads onto a barrier, and once. Of two
    /// that merge the one that keeps its number counts for both from then on.
    void sample(const ColumnAt& column);
    const BarrierLoads& loads() const { return loads_; }
    void serialize(Archive& archive);

private:
    void make_room(std::size_t id);
    enum Seen : std::uint8_t { kNever, kAdjacent, kOver };
    std::vector<Surface> surfaces_;                ///< of each barrier
    std::vector<std::pair<Vec3, Vec3>> boxes_;     ///< around each
    std::vector<std::vector<std::uint8_t>> seen_;  ///< per barrier, by number of the column
    std::vector<double> last_;                     ///< x and y of each column's last place, by its number [m]
    BarrierLoads loads_;
    double cell_;
};

/// What 3D points do to barriers.
class BarrierWatch {
public:
    /// Barriers are the surfaces of that kind of the flow's scene, in the order of `scene`.
    BarrierWatch(const Scene& scene, const Mpm3d& flow, double blur);
    /// Takes the impulses of the faces.
    void accumulate_loads(const Mpm3d& flow);
    /// Takes run-up, and what stands over the barriers.
    void sample(const Mpm3d& flow);
    const BarrierLoads& loads() const { return loads_; }
    /// The faces with what each of their patches got.
    std::vector<PatchedFace> patched(const Mpm3d& flow) const;
    void serialize(Archive& archive);

private:
    std::vector<int> surfaces_;                    ///< of each barrier
    std::vector<std::pair<Vec3, Vec3>> boxes_;     ///< around each
    std::vector<std::vector<std::uint8_t>> over_;  ///< per barrier, by number of the point: was over it
    BarrierLoads loads_;
    double density_;
};

}  // namespace frana
