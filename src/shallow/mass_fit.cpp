#include "shallow/mass_fit.h"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/compensated_sum.h"
#include "mpm/domain.h"
#include "mpm/stencil.h"
#include "shallow/surface.h"
#include "shallow/transfer.h"

namespace frana {
namespace {

/// The nodes that a particle's mass goes to and their weights, walls folded in: one row of B^T.
struct Reach {
    static constexpr int kMost = 64;  // four sub-points, 4 x 4 nodes of a cubic
    int count = 0;
    Index node[kMost];
    double weight[kMost];
};

/// Node index with walls mirrored; wall nodes count their own mirror part too.
struct Folded {
    Index k;
    double factor;
};

Folded folded(const Flow& flow, Index i, Index j) {
    double factor = 1.0;
    if (flow.walls) {
        const auto fold = [&](Index& n, Index last) {
            if (n < 0)
                n = -n;
            else if (n > last)
                n = 2 * last - n;
            if (n == 0 || n == last) factor *= 2.0;
        };
        fold(i, flow.grid.nx() - 1);
        fold(j, flow.grid.ny() - 1);
    }
    return {flow.grid.at(i, j), factor};
}

template <class S>
Reach reach_with(const Flow& flow, Index p) {
    const Particles& c = flow.particles;
    const Edges edges = c.with_real([&](auto real) { return edges_of(c.carried<decltype(real)>(), p); });
    Reach reach;
    const double sub_reach = flow.scheme.sub_point_reach;
    for (int sub = 0; sub < 4; ++sub) {
        const double s1 = sub & 1 ? sub_reach : -sub_reach, s2 = sub & 2 ? sub_reach : -sub_reach;
        double x = c.x[p] + s1 * edges.r1x + s2 * edges.r2x, y = c.y[p] + s1 * edges.r1y + s2 * edges.r2y;
        if (!flow.walls) {
            x = std::clamp(x, 0.0, static_cast<double>(flow.grid.nx() - 1));
            y = std::clamp(y, 0.0, static_cast<double>(flow.grid.ny() - 1));
        }
        const S sx(x), sy(y);
        for (int j = 0; j < S::kNodes; ++j)
            for (int i = 0; i < S::kNodes; ++i) {
                const Folded to = folded(flow, sx.base + i, sy.base + j);
                reach.node[reach.count] = to.k;
                reach.weight[reach.count++] = 0.25 * to.factor * sx.w[i] * sy.w[j];
            }
    }
    return reach;
}

Reach reach_of(const Flow& flow, Index p) {
    return flow.scheme.shape == Shape::cubic ? reach_with<Cubic>(flow, p) : reach_with<Quadratic>(flow, p);
}

/// B on the chosen rows, a column for each point.
class FitSystem {
public:
    using Numbers = Eigen::VectorXd;

    explicit FitSystem(const Flow& flow) : row_(flow.grid.size()) {
        reach_.reserve(static_cast<std::size_t>(flow.particles.count()));
        for (Index p = 0; p < flow.particles.count(); ++p) reach_.push_back(reach_of(flow, p));
    }
    void set_rows(const std::vector<Index>& nodes) {
        for (std::size_t r = 0; r < nodes.size(); ++r) row_[nodes[r]] = static_cast<Index>(r) + 1;
        std::vector<Eigen::Triplet<double>> entries;
        for (std::size_t p = 0; p < reach_.size(); ++p)
            for (int n = 0; n < reach_[p].count; ++n)
                if (const Index r = row_[reach_[p].node[n]])
                    entries.emplace_back(static_cast<int>(r - 1), static_cast<int>(p), reach_[p].weight[n]);
        deposit_.resize(static_cast<Index>(nodes.size()), static_cast<Index>(reach_.size()));
        deposit_.setFromTriplets(entries.begin(), entries.end());
    }
    /// B m on the rows.
    Numbers collect(const Numbers& mass) const { return deposit_ * mass; }
    /// Least change of the masses, each over its weight, whose B is `rhs`: W^1/2 x of the shortest x with B W^1/2 x = rhs.
    /// More rows than points with weight may have no solution, then the nearest counts. Adds to the iterations.
    Numbers change(const Numbers& weight, const Numbers& rhs, Index& iterations) const {
        const Numbers root = weight.cwiseSqrt();
        // Without a preconditioner: with one x would be the shortest by another measure.
        Eigen::LeastSquaresConjugateGradient<Eigen::SparseMatrix<double>, Eigen::IdentityPreconditioner> solver;
        solver.setMaxIterations(1000);
        const Eigen::SparseMatrix<double> matrix = deposit_ * root.asDiagonal();
        solver.compute(matrix);
        // Beyond round-off the method may divide nothing by nothing.
        for (const double tolerance : {1e-15, 1e-12, 1e-9}) {
            solver.setTolerance(tolerance);
            const Numbers x = solver.solve(rhs);
            iterations += solver.iterations();
            if (x.allFinite()) return root.cwiseProduct(x);
        }
        return Numbers::Zero(root.size());
    }

private:
    std::vector<Reach> reach_;
    LazyArray<Index> row_;  ///< row number + 1 of a node, 0: none
    Eigen::SparseMatrix<double> deposit_;
};

/// Deposits the particles' mass alone and finds wetness and margin.
void deposit_particles(Flow& flow) {
    start_deposit(flow, 1, 3);
    reach_all(flow);
    for (Index p = 0; p < flow.particles.count(); ++p) {
        const Reach reach = reach_of(flow, p);
        for (int n = 0; n < reach.count; ++n)
            flow.nodes.column_mass[reach.node[n]] += flow.particles.mass[p] * reach.weight[n];
    }
    depth_pass(flow, {0.0, Vec2(0, 0)});
}

/// Whether material can hold a node to the level. It cannot on ground that is higher, such as a barrier within the lake, and
/// within a cell of an open side, beyond which nothing is.
bool holds_level(const Flow& flow, Index i, Index j, double level) {
    const Index edge = flow.walls ? 0 : 2;
    return i >= edge && j >= edge && i < flow.grid.nx() - edge && j < flow.grid.ny() - edge &&
           flow.bed.z[flow.grid.at(i, j)] < level;
}

}  // namespace

double off_level(const Flow& flow, double level) {
    double most = 0.0;
    for (const Index tile : flow.active.work)
        for_each_node_of(flow.grid, tile, flow.in_reach[tile], [&](Index k, Index i, Index j) {
            const bool inside = i >= 0 && j >= 0 && i < flow.grid.nx() && j < flow.grid.ny();
            if (inside && flow.nodes.flags[k] & kWet) most = std::max(most, std::abs(flow.nodes.surface[k] - level));
        });
    return most;
}

MassFit fit_masses(Flow& flow, double level) {
    MassFit fit;
    using Numbers = FitSystem::Numbers;
    const Numbers start = Numbers::Map(flow.particles.mass.data(), flow.particles.count());
    // A mass that meets its limits stays there, with no weight of its own, and the others are fitted again.
    Numbers from = start, weight = start;
    FitSystem system(flow);
    const double column = flow.density * flow.area;

    deposit_particles(flow);
    mark_margin(flow);
    std::vector<Index> rows;
    const auto gather_rows = [&](bool margin, double below) {
        std::size_t added = 0;
        for (const Index tile : flow.active.work)
            for_each_node_of(flow.grid, tile, [&](Index k, Index i, Index j) {
                if (!holds_level(flow, i, j, level) || !(flow.nodes.flags[k] & kWet)) return;
                if (static_cast<bool>(flow.nodes.flags[k] & kMargin) != margin) return;
                if (margin && !(flow.nodes.depth[k] + flow.bed.z[k] < below)) return;
                if (margin && std::find(rows.begin(), rows.end(), k) != rows.end()) return;
                rows.push_back(k);
                ++added;
            });
        return added;
    };
    gather_rows(false, 0.0);
    for (const Index tile : flow.active.work)
        for_each_node_of(flow.grid, tile, [&](Index k, Index i, Index j) {
            if ((flow.nodes.flags[k] & (kWet | kMargin)) == kWet && !holds_level(flow, i, j, level)) ++fit.left_free;
        });
    for (int round = 0, refits = 0; round < 4;) {
        system.set_rows(rows);
        Numbers rhs = -system.collect(from);
        for (std::size_t r = 0; r < rows.size(); ++r)
            rhs[static_cast<Index>(r)] += column * (level - flow.bed.z[rows[r]]);
        const Numbers change = system.change(weight, rhs, fit.iterations);
        fit.largest_change = 0.0;
        Index clipped = 0;
        for (Index p = 0; p < start.size(); ++p) {
            const double wanted = from[p] + change[p];
            flow.particles.mass[p] = std::clamp(wanted, 0.03 * start[p], 5.0 * start[p]);
            if (flow.particles.mass[p] != wanted) {
                from[p] = flow.particles.mass[p];
                weight[p] = 0.0;
                ++clipped;
            }
            fit.largest_change = std::max(fit.largest_change, std::abs(flow.particles.mass[p] / start[p] - 1.0));
        }
        fit.clipped += clipped;
        if (clipped > 0 && ++refits < 20) continue;
        ++round;
        deposit_particles(flow);
        mark_margin(flow);
        // A margin node that would stand below the level lowers the surface (the margin takes a minimum).
        if (gather_rows(true, level - 1e-13 * std::max(1.0, std::abs(level))) == 0) break;
    }
    fit.rows = static_cast<Index>(rows.size());
    CompensatedSum before, after;  // Eigen's sums depend on where an array begins
    for (Index p = 0; p < start.size(); ++p) before.add(start[p]), after.add(flow.particles.mass[p]);
    fit.volume_change = after.value() / before.value() - 1.0;
    return fit;
}

std::string remark_on(const MassFit& fit, double cell) {
    constexpr double kLevel = 1e-6;         // [cells]; far above round-off, and currents of it are slow
    constexpr double kNoticeable = 0.0005;  // of the volume: as percents are rounded
    std::string text = fmt::format(
        "masses fitted to the still level: {} nodes, {} iterations, largest change of a point {:.2g}, {} points at "
        "their "
        "limits; level within {:.2g} m",
        fit.rows, fit.iterations, fit.largest_change, fit.clipped, fit.level_error);
    if (std::abs(fit.volume_change) > kNoticeable)
        text += fmt::format("; the lake has {:.1f} % {} than what was given", 100.0 * std::abs(fit.volume_change),
                            fit.volume_change > 0.0 ? "more" : "less");
    if (fit.level_error <= kLevel * cell) return text;
    return text + (fit.left_free > 0 ? "; nothing holds it at open sides and on ground above the level, so it does not "
                                       "rest there"
                                     : ", so the lake does not rest; give more points (particles.per_cell) or a finer "
                                       "grid.cell");
}

}  // namespace frana
