// Where a depth-averaged run gives its material to another model, and what it tells of its columns.
#include <omp.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "solver/depth_averaged.h"
#include "solver/sides.h"

namespace frana {

void DepthAveraged::open_exits(const std::vector<std::uint8_t>& marks, bool leave_now) {
    expect(static_cast<Index>(marks.size()) == flow_.grid.geometry().size(),
           "every node of the grid is marked or not");
    for (Index j = 0; j < flow_.grid.ny(); ++j)
        for (Index i = 0; i < flow_.grid.nx(); ++i)
            if (marks[static_cast<std::size_t>(j * flow_.grid.nx() + i)])
                flow_.bed.exit[flow_.grid.at(i, j)] = kNoted;
    flow_.bed.has_exits = true;
    flow_.departed.resize(static_cast<std::size_t>(omp_get_max_threads()));
    if (leave_now) leave_at_exits();
}

/// Drops the points at exits and deposits the others again, booking what left as at other exits.
void DepthAveraged::leave_at_exits() {
    for (const Index tile : flow_.active.tile) flow_.active.quiet[tile] = 0;
    const Columns& c = flow_.columns;
    std::vector<std::uint8_t> gone(static_cast<std::size_t>(c.count()), 0);
    PointSums left;
    double kinetic = 0.0;
    for (Index p = 0; p < c.count(); ++p) {
        const Index k = flow_.grid.at(static_cast<Index>(std::floor(c.x[p] + 0.5)),
                                      static_cast<Index>(std::floor(c.y[p] + 0.5)));
        if (flow_.bed.exit[k] == 0) continue;
        gone[static_cast<std::size_t>(p)] = 1;
        flow_.columns.with_real([&](auto real) {
            const auto& held = c.carried<decltype(real)>();
            const double vx = held.vx[p], vy = held.vy[p];
            const double vz = flow_.steep ? vx * flow_.bed.slope_x[k] + vy * flow_.bed.slope_y[k] : 0.0;
            kinetic += 0.5 * c.mass[p] * (vx * vx + vy * vy + vz * vz);
            leave<decltype(real)>(flow_, p, k, left);
        });
    }
    status_.mass_left += left.left_mass;
    status_.momentum_left[0] += left.left_px;
    status_.momentum_left[1] += left.left_py;
    status_.energy_left += left.left_energy;
    status_.kinetic = std::max(0.0, status_.kinetic - kinetic);  // of nodes, and to the next kick only
    sorter_.drop(flow_.columns, gone, flow_.active);
    arrive(transfer_->deposit(flow_, 0.5 * (status_.dt + longest_step())));
}

std::vector<Departed> DepthAveraged::take_departed() {
    std::vector<Departed> all;
    for (std::vector<Departed>& list : flow_.departed) {
        all.insert(all.end(), list.begin(), list.end());
        list.clear();
    }
    std::sort(all.begin(), all.end(), [](const Departed& a, const Departed& b) { return a.id < b.id; });
    return all;
}

std::vector<DepthAveraged::Birth> DepthAveraged::take_births() {
    std::vector<Birth> births;
    const std::vector<Index> parents = splitter_.take_parents();
    const Index first = splitter_.next_id() - static_cast<Index>(parents.size());
    for (std::size_t n = 0; n < parents.size(); ++n) births.push_back({first + static_cast<Index>(n), parents[n]});
    return births;
}

}  // namespace frana
