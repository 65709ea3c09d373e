#include "checks/verify/box_mesh.h"

#include <cmath>

#include "terrain/mesh_distance.h"

namespace frana::verify {

DistanceField box_as_mesh(const Vec3& low, const Vec3& high, double cell) {
    TriangleMesh mesh;
    for (int c = 0; c < 8; ++c)
        mesh.points.emplace_back(c & 1 ? high.x() : low.x(), c & 2 ? high.y() : low.y(), c & 4 ? high.z() : low.z());
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    DistanceField field;
    field.spacing = 0.5 * cell;
    constexpr double kBeyond = 6.0;  // [cells]: more than kLongestReach
    field.origin = low - Vec3::Constant(kBeyond * cell);
    std::size_t count = 1;
    for (int k = 0; k < 3; ++k) {
        const Index nodes = 1 + std::lround((high[k] - low[k] + 2.0 * kBeyond * cell) / field.spacing);
        field.nodes[static_cast<std::size_t>(k)] = nodes, count *= static_cast<std::size_t>(nodes);
    }
    field.distance.resize(count);
    measure_distances(mesh, field);
    return field;
}

}  // namespace frana::verify
