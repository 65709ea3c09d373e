#include "vtk_io/figures/faces_3d.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace frana {

double LoadedFace::longest() const {
    double most = 0.0;
    for (const LoadedPatch& patch : patches) most = std::max(most, right().dot(patch.corners[1] - corner()));
    return most;
}

std::vector<LoadedFace> faces_of(const std::vector<LoadedPatch>& patches, int barrier) {
    std::vector<LoadedFace> faces;
    for (const LoadedPatch& patch : patches) {
        if (patch.barrier != barrier) continue;
        if (faces.empty() || faces.back().patches.front().face != patch.face) faces.emplace_back();
        faces.back().patches.push_back(patch);
    }
    return faces;
}

std::vector<double> smoothed(const LoadedFace& face, const std::function<bool(const LoadedPatch&)>& counts) {
    const Vec3 corner = face.corner(), right = face.right(), up = face.up();
    const double size = face.size();
    const auto place = [&](const LoadedPatch& patch) {
        const Vec3 way = patch.corners[0] - corner;
        return std::pair(std::lround(right.dot(way) / size), std::lround(up.dot(way) / size));
    };
    std::map<std::pair<long, long>, const LoadedPatch*> at;
    for (const LoadedPatch& patch : face.patches)
        if (counts(patch)) at[place(patch)] = &patch;
    std::vector<double> means;
    for (const LoadedPatch& patch : face.patches) {
        const auto [i, j] = place(patch);
        double sum = 0.0, number = 0.0;
        for (long b = j - 1; b <= j + 1; ++b)
            for (long a = i - 1; a <= i + 1; ++a)
                if (const auto found = at.find({a, b}); found != at.end())
                    sum += found->second->pressure, number += 1.0;
        means.push_back(number > 0.0 ? sum / number : 0.0);
    }
    return means;
}

Polyline cut_to_square(Polyline ring, const Vec2& low, const Vec2& high) {
    for (int side = 0; side < 4 && !ring.empty(); ++side) {
        const int axis = side % 2;
        const double limit = side < 2 ? low[axis] : high[axis], sign = side < 2 ? 1.0 : -1.0;
        Polyline kept;
        for (std::size_t k = 0; k < ring.size(); ++k) {
            const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
            const double from = sign * (a[axis] - limit), to = sign * (b[axis] - limit);
            if (from >= 0.0) kept.push_back(a);
            if ((from > 0.0 && to < 0.0) || (from < 0.0 && to > 0.0))
                kept.emplace_back(a + (b - a) * (from / (from - to)));
        }
        ring = std::move(kept);
    }
    return ring;
}

}  // namespace frana
