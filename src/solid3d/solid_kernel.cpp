// The loops of the 3D step, one instance for each law and transfer.
#include <Eigen/Geometry>

#include <algorithm>
#include <limits>
#include <type_traits>

#include "base/error.h"
#include "base/touch.h"
#include "solid3d/batch_sums.h"
#include "solid3d/ghost_scatter.h"
#include "solid3d/mirror_batch.h"
#include "solid3d/mpm3d.h"
#include "solid3d/point_batch.h"
#include "solid3d/stencil3d.h"
#include "solid3d/surface_contact.h"

namespace frana {
namespace {

constexpr double kLongestShift = 1.0;  ///< of a point in a step [cells]: the time step allows its cfl

[[gnu::always_inline]] inline Double4 lanes(double m, const Vec3& v) { return Double4{m, v[0], v[1], v[2]}; }

/// What a point gives its nodes: w (base + affine d) + force grad w; lanes are mass and momentum.
struct Contribution {
    Double4 base, affine[3], force[3];
    /// To one of the nodes.
    template <class Stencil>
    [[gnu::always_inline]] Double4 at(const Stencil& s, int i, int j, int k) const {
        return s.w[0][i] * s.w[1][j] * s.w[2][k] *
                   (base + affine[0] * s.d[0][i] + affine[1] * s.d[1][j] + affine[2] * s.d[2][k]) +
               force_at(s, i, j, k);
    }
    template <class Stencil>
    [[gnu::always_inline]] Double4 force_at(const Stencil& s, int i, int j, int k) const {
        return (s.slope[0][i] * s.w[1][j] * s.w[2][k]) * force[0] + (s.w[0][i] * s.slope[1][j] * s.w[2][k]) * force[1] +
               (s.w[0][i] * s.w[1][j] * s.slope[2][k]) * force[2];
    }
};

/// The nodes that the points begin to end - 1 touch.
inline Box3d box_of(const MaterialPoints& q, Index begin, Index end) {
    Box3d box;
    for (int axis = 0; axis < 3; ++axis) {
        const double* const x = q.x[axis].data();
        Double4 low = all(x[begin]), high = low;
        Index p = begin;
        for (; p + 4 <= end; p += 4) low = min(low, load(x + p)), high = max(high, load(x + p));
        for (; p < end; ++p) low = min(low, all(x[p])), high = max(high, all(x[p]));
        const auto first = [](double at) { return static_cast<Index>(at - 0.5); };
        box.first[axis] = first(-largest(-low));
        box.count[axis] = first(largest(high)) - box.first[axis] + 3;
    }
    expect(NodeBlock::holds(box), "3D points strayed from their tile");
    return box;
}

inline void load_all(const Array* arrays, int count, Index p, int lanes, Double4* to) {
    for (int n = 0; n < count; ++n) to[n] = load(arrays[n].data() + p, lanes);
}
inline void store_all(const Double4* from, int count, Index p, int lanes, Array* arrays) {
    for (int n = 0; n < count; ++n) store(arrays[n].data() + p, from[n], lanes);
}

template <class Law>
[[gnu::noinline]] void touch_points(const MaterialPoints& q, Index first, Index last) {
    const auto ahead = [&](const Array* arrays, int count) {
        for (int n = 0; n < count; ++n) touch(arrays[n].data() + first, last - first);
    };
    ahead(q.x.data(), 3), ahead(q.v.data(), 3), ahead(q.gradient.data(), 9), ahead(q.state.data(), Law::kStates);
    ahead(&q.mass, 1), ahead(&q.rest_volume, 1), ahead(&q.j, 1);
}

/// Now and then reads the arrays of the next points ahead (base/touch.h).
template <class Law>
inline void read_ahead(const MaterialPoints& q, Index begin, Index p, Index end) {
    constexpr Index kAhead = 128;
    if ((p - begin) % kAhead == 0) touch_points<Law>(q, p, std::min(p + kAhead, end));
}

/// Where numbers are finite, and points did not run away.
[[gnu::always_inline]] inline Mask4 is_finite(const BatchPoints& now, const Double4* from) {
    const Double4 shift = max(max(abs(now.x[0] - from[0]), abs(now.x[1] - from[1])), abs(now.x[2] - from[2]));
    const Double4 size = abs(now.v[0]) + abs(now.v[1]) + abs(now.v[2]) + abs(now.volume);
    return (size <= std::numeric_limits<double>::max()) & (shift < kLongestShift);
}

[[gnu::always_inline]] inline Mask4 inside_of(const Grid3d& grid, const Double4* x) {
    Mask4 inside = x[0] >= 0.5;
    for (int k = 0; k < 3; ++k) inside &= (x[k] >= 0.5) & (x[k] <= static_cast<double>(grid.geometry().nodes[k]) - 1.5);
    return inside;
}

inline void leave(SolidBody& body, Index p, const BatchPoints& now, int lane, SolidSums& sums) {
    const double mass = now.mass[lane];
    body.gone[static_cast<std::size_t>(p)] = 1;
    sums.left_mass += mass, ++sums.left;
    const Vec3 v(now.v[0][lane], now.v[1][lane], now.v[2][lane]);
    const Vec3 place = body.grid.geometry().origin + body.grid.cell() * position(body, p);
    sums.left_momentum += mass * v;
    sums.left_energy += mass * (0.5 * v.squaredNorm() - body.gravity.dot(place)) + now.stored[lane];
}

/// Checks that points are finite, puts them back before surfaces, and records them.
[[gnu::always_inline]] inline void finish(SolidBody& body, Index p, int lanes, BatchPoints& now, const Double4* from,
                                          Index tile, BatchSums& lane_sums, SolidSums& sums) {
    const Mask4 there = now.mass > 0.0;  // not beyond `lanes`
    const Mask4 bad = there & ~is_finite(now, from);
    if (any(bad)) {
        for (int n = 0; n < lanes; ++n)
            if (bad[n]) sums.bad = p + n;
        return;
    }
    const SurfaceSet near = body.near_points[static_cast<std::size_t>(tile)];
    if (near != 0) {
        Vec3* const impulse = body.point_impulse.data() + tile * static_cast<Index>(body.surfaces.size());
        for (int n = 0; n < lanes; ++n) {
            move_out(body, near & ~body.barriers, p + n, impulse);
            if (near & body.barriers) keep_out(body, tile, p + n, {from[0][n], from[1][n], from[2][n]});
        }
        Double4 gained{};
        for (int k = 0; k < 3; ++k) {
            const auto axis = static_cast<std::size_t>(k);
            const Double4 x = load(body.points.x[axis].data() + p, lanes),
                          v = load(body.points.v[axis].data() + p, lanes);
            gained += 0.5 * (v * v - now.v[k] * now.v[k]) - body.gravity[k] * body.grid.cell() * (x - now.x[k]);
            now.x[k] = x, now.v[k] = v;
        }
        sums.contact_work += sum(select(there, gained * now.mass, Double4{}));
    }
    const Mask4 inside = inside_of(body.grid, now.x), left = there & ~inside;
    if (any(left))
        for (int n = 0; n < lanes; ++n)
            if (left[n]) leave(body, p + n, now, n, sums);
    lane_sums.add(now, from, there & inside);
}

/// Of mirror particles what is the same for all laws.
class MirrorScatter : public Mpm3dKernel {
public:
    /// Mirror particles lie on the far side of surfaces. Tiles that scatter them at once stand two to four apart
    /// (mpm3d.cpp). Those further off, of points deep in a corner or behind a surface, reach no node that material
    /// touches.
    void scatter_mirrors(SolidBody& body, double dt) const override {
        for_each_work_tile(body.active, [&](Index n, Index tile) {
            const SurfaceSet near = body.near_nodes[static_cast<std::size_t>(n)];
            if (near != 0) std::copy_n(&body.nodes[tile * kTileNodes], kTileNodes, &body.real[tile * kTileNodes]);
            if (!(near & body.barriers)) return;
            std::fill_n(&body.mirror_force[tile * kTileNodes], kTileNodes, SolidBody::Node{});
            std::fill_n(&body.on_barriers[tile * kTileNodes], kTileNodes, SolidBody::Node{});
        });
        const double h = body.grid.cell();
        const Vec3& origin = body.grid.geometry().origin;
        for_each_listed(body.mirror_colour, body.active.count() >= kTilesForThreads, [&](Index n) {
            MirrorBatch batch;
            const double sideways = std::min(body.mirror_reach[static_cast<std::size_t>(n)], kFarthestMirror);
            for (Index p = body.active.begin[n]; p < body.active.begin[n + 1]; ++p) {
                const Vec3 x = position(body, p);
                const MirrorParticles mirrors(body.surfaces, body.near_points[static_cast<std::size_t>(n)],
                                              origin + h * x, h);
                if (mirrors.stands_on_barrier()) give_to(body.on_barriers, body, p, dt);
                for (const MirrorParticle& mirror : mirrors) {
                    const Vec3 place = (mirror.place - origin) / h;
                    const Vec3 shift = (place - x).cwiseAbs();
                    const bool far = std::max(shift.x(), shift.y()) > sideways || shift.z() > kFarthestMirror;
                    if (far || !seen(body, place)) continue;
                    if (mirror.of_barrier) {
                        show_before_cuts(body, p, mirror, place, dt);
                        continue;
                    }
                    batch.add(p, place, mirror, h);
                    if (batch.count == 4) show(body, batch, dt);
                }
            }
            if (batch.count > 0) show(body, batch, dt);
        });
    }

private:
    /// Mirror particles give to their nodes, and the batch is empty again.
    virtual void show(SolidBody& body, MirrorBatch& batch, double dt) const = 0;
    /// A point gives its mirror particle in a barrier to those nodes only that the mirror particle shows at.
    virtual void show_before_cuts(SolidBody& body, Index p, const MirrorParticle& mirror, const Vec3& place,
                                  double dt) const = 0;
    /// A point gives its mass and momentum to other sums at its nodes too.
    virtual void give_to(LazyArray<SolidBody::Node>& sums, const SolidBody& body, Index p, double dt) const = 0;
};

/// From nodes to points. flip: points retain their velocities and get the changes of the nodes' ones (mpm3d.h).
template <class Law, bool flip>
class Gather : public MirrorScatter {
public:
    explicit Gather(const Law& law) : law_(law) {}

    void gather(SolidBody& body, double dt) const override {
        for_each_tile(body.active, [&](Index n) {
            Vec3* const impulse = body.point_impulse.data() + n * static_cast<Index>(body.surfaces.size());
            std::fill_n(impulse, body.surfaces.size(), Vec3::Zero());
            if (body.near_points[static_cast<std::size_t>(n)] & body.barriers)
                body.point_impulses[static_cast<std::size_t>(n)].clear();
            const Box3d& box = body.boxes[static_cast<std::size_t>(n)];
            NodeBlock block;
            block.take<flip>(body.grid, box, body.nodes.data(), body.flip_sums.data());
            body.sums[static_cast<std::size_t>(n)] = gather_points(body, n, dt, block);
        });
    }

protected:
    Law law_;

private:
    /// What the nodes give to up to four points, by the shapes of the transfer.
    virtual void take(const NodeBlock& block, const Box3d& box, const Double4* x, int lanes, double h,
                      BatchTaken& taken) const = 0;

    [[gnu::noinline]] SolidSums gather_points(SolidBody& body, Index tile, double dt, const NodeBlock& block) const {
        SolidSums sums;
        BatchSums lane_sums;
        const Index begin = body.active.begin[tile], end = body.active.begin[tile + 1];
        Index p = begin;
        for (; p + 4 <= end; p += 4) {
            read_ahead<Law>(body.points, begin, p, end);
            gather_batch(body, p, 4, dt, tile, block, lane_sums, sums);
        }
        if (p < end) gather_batch(body, p, static_cast<int>(end - p), dt, tile, block, lane_sums, sums);
        lane_sums.add_to(sums);
        return sums;
    }

    [[gnu::always_inline]] void gather_batch(SolidBody& body, Index p, int lanes, double dt, Index tile,
                                             const NodeBlock& block, BatchSums& lane_sums, SolidSums& sums) const {
        MaterialPoints& q = body.points;
        Double4 from[3], state[7];
        load_all(q.x.data(), 3, p, lanes, from);
        BatchTaken taken;
        take(block, body.boxes[static_cast<std::size_t>(tile)], from, lanes, body.grid.cell(), taken);
        DeformationOf<Double4> d;
        d.dt = dt;
        for (int l = 0; l < 3; ++l)
            for (int k = 0; k < 3; ++k) d.gradient(k, l) = taken.slope[l][k + 1];
        Double4 j = load(q.j.data() + p, lanes);
        load_all(q.state.data(), Law::kStates, p, lanes, state);
        if constexpr (Law::kAverages) j += body.averaging * (taken.mean[0] - j);
        BatchPoints now;
        deform(d, load(q.rest_volume.data() + p, lanes), j, state, now);
        for (int k = 0; k < 3; ++k) {
            now.x[k] = from[k] + dt / body.grid.cell() * taken.mean[k + 1];
            now.v[k] = taken.mean[k + 1];
            if constexpr (flip)
                now.v[k] =
                    body.flip_share * load(q.v[static_cast<std::size_t>(k)].data() + p, lanes) + taken.flip_sums[k + 1];
        }
        now.mass = load(q.mass.data() + p, lanes);
        store_all(now.x, 3, p, lanes, q.x.data());
        store_all(now.v, 3, p, lanes, q.v.data());
        store_all(d.gradient.entry, 9, p, lanes, q.gradient.data());
        store_all(state, Law::kStates, p, lanes, q.state.data());
        store(q.j.data() + p, j, lanes);
        finish(body, p, lanes, now, from, tile, lane_sums, sums);
    }

    /// Strain of the step. Laws in rates have dt D. Those that carry a logarithmic one have that of F = I + dt L, to
    /// second order: ln(F F^T) / 2 = dt D + dt^2 (L L^T / 2 - D^2).
    [[gnu::always_inline]] static SymOf<Double4> strain_of(const DeformationOf<Double4>& d) {
        const SymOf<Double4> rate = SymOf<Double4>::of(d.gradient);
        if constexpr (Law::kAverages) {
            return rate * all(d.dt);
        } else {
            const Mat3x4& l = d.gradient;
            const auto row = [&](int i, int j) { return l(i, 0) * l(j, 0) + l(i, 1) * l(j, 1) + l(i, 2) * l(j, 2); };
            const SymOf<Double4> turned{row(0, 0), row(1, 1), row(2, 2), row(0, 1), row(1, 2), row(0, 2)};
            return (rate + (turned * all(0.5) + times(rate, rate) * all(-1.0)) * all(d.dt)) * all(d.dt);
        }
    }

    /// The law's step. Of the work of the mean stress what is not stored is lost to the law. It goes by flow, friction
    /// inside and viscosity.
    [[gnu::always_inline]] void deform(const DeformationOf<Double4>& d, const Double4& rest_volume, Double4& j,
                                       Double4* state, BatchPoints& now) const {
        const SymOf<Double4> before = law_.stress(j, state, d.gradient);
        const Double4 had = law_.stored(j, state);
        law_.update(d, j, state);
        const SymOf<Double4> mean = (before + law_.stress(j, state, d.gradient)) * all(0.5);
        const Double4 has = law_.stored(j, state);
        now.volume = j * rest_volume;
        now.stored = has * rest_volume;
        now.material = (contracted(mean, strain_of(d)) - (has - had)) * rest_volume;
    }
};

/// From points to nodes.
template <class Law, Affine affine, bool flip>
class Kernel final : public Gather<Law, flip> {
    using Gather<Law, flip>::law_;

public:
    using Gather<Law, flip>::Gather;

    double sound_speed(double density) const override { return law_.sound_speed(density); }
    double explicit_viscosity() const override { return law_.explicit_viscosity(); }
    int states() const override { return Law::kStates; }
    double press(double p, double& j, double* state) const override {
        std::fill_n(state, Law::kStates, 0.0);
        if constexpr (Law::kAverages)
            j = 1.0 - p / law_.bulk;
        else
            j = press_solid(elastic_of(law_), p, state);
        return law_.stored(j, state);
    }

    void clear(SolidBody& body) const override {
        for_each_work_tile(body.active, [&](Index, Index tile) {
            std::fill_n(&body.nodes[tile * kTileNodes], kTileNodes, SolidBody::Node{});
            if constexpr (flip)
                std::fill_n(&body.flip_sums[tile * kTileNodes], kTileNodes, SolidBody::Node{});
            else if constexpr (Law::kAverages)
                std::fill_n(&body.mass_j[tile * kTileNodes], kTileNodes, 0.0);
        });
    }

    /// Tile by tile through a block of nodes.
    void scatter(SolidBody& body, double dt) const override {
        for_each_tile_in_turn(body.active, [&](Index n) {
            const Index begin = body.active.begin[n], end = body.active.begin[n + 1];
            const Box3d box = box_of(body.points, begin, end);
            body.boxes[static_cast<std::size_t>(n)] = box;
            NodeBlock block;
            block.clear<Law::kAverages, flip>(box);
            scatter_points(body, begin, end, dt, box, block);
            block.add_to<Law::kAverages, flip>(body.grid, box, body.nodes.data(), body.flip_sums.data(),
                                               body.mass_j.data());
        });
    }

    void scatter_ghosts(SolidBody& body, double time, double dt) const override {
        GhostScatter<affine>::scatter(body, time, dt);
    }
    void scatter_ghost_mirrors(SolidBody& body) const override { GhostScatter<affine>::scatter_mirrors(body); }

    void move_nodes(SolidBody& body) const override { frana::move_nodes(body, flip, Law::kAverages); }

private:
    static const solid::Elastic& elastic_of(const solid::Elastic& law) { return law; }
    static const solid::Elastic& elastic_of(const solid::DruckerPrager& law) { return law.elastic; }
    static const solid::Elastic& elastic_of(const solid::MuI& law) { return law.elastic; }

    /// Logarithmic strain under a pressure: K tr(e) = - J p, J = exp(tr(e)), by turns: each errs p / K less. Returns J.
    static double press_solid(const solid::Elastic& law, double p, double* strain) {
        constexpr int kTurns = 20;
        const double bulk = law.bulk();
        double volume = 0.0;
        for (int turn = 0; turn < kTurns; ++turn) volume = -p / bulk * std::exp(volume);
        std::fill_n(strain, 3, volume / 3.0);
        return std::exp(volume);
    }

    struct Point {
        Vec3 x, v;
        Mat3 gradient;
        Mat3 stress;  ///< Cauchy stress times present volume [J]
        double mass, j;
        Point() = default;
        [[gnu::always_inline]] Point(const Kernel& kernel, const SolidBody& body, Index p) {
            const MaterialPoints& q = body.points;
            for (int k = 0; k < 3; ++k) x[k] = q.x[k][p], v[k] = q.v[k][p];
            for (int l = 0; l < 9; ++l) gradient(l % 3, l / 3) = q.gradient[l][p];
            double state[7];
            for (int s = 0; s < Law::kStates; ++s) state[s] = q.state[s][p];
            mass = q.mass[p], j = q.j[p];
            stress = (kernel.law_.stress(j, state, gradient) * q.rest_volume[p]).matrix();
        }
    };

    [[gnu::always_inline]] static Contribution contribution_of(const Point& point, const Vec3& v, double dt) {
        Contribution contribution;
        contribution.base = lanes(point.mass, point.mass * v);
        for (int l = 0; l < 3; ++l) {
            contribution.affine[l] = lanes(0.0, point.mass * point.gradient.col(l));
            contribution.force[l] = lanes(0.0, -dt * point.stress.col(l));
        }
        return contribution;
    }

    /// The motion and the stress that a mirror particle shows. Forces between a point and it are equal and opposite.
    static Point mirrored(const Point& p, const MirrorParticle& mirror) {
        Point other;
        other.mass = mirror.share * p.mass, other.j = p.j;
        other.gradient = mirror.motion * mirror.without_shear(p.gradient) * mirror.turn.transpose();
        other.stress = mirror.share * (mirror.motion * p.stress * mirror.turn.transpose());
        return other;
    }

    void show_before_cuts(SolidBody& body, Index p, const MirrorParticle& mirror, const Vec3& place,
                          double dt) const override {
        const Point point(*this, body, p);
        const Contribution contribution =
            contribution_of(mirrored(point, mirror), mirror.motion * (point.v + dt * body.gravity), dt);
        const Stencil3d<affine> s(body.grid, place);
        const Vec3& origin = body.grid.geometry().origin;
        for (int n = 0; n < 27; ++n) {
            const int i = n % 3, j = n / 3 % 3, k = n / 9;
            const Vec3 d(s.d[0][i], s.d[1][j], s.d[2][k]);
            if (!mirror.shows_at(origin + body.grid.cell() * place + d)) continue;
            const double w = s.w[0][i] * s.w[1][j] * s.w[2][k];
            const Index at = s.place[0][i] + s.place[1][j] + s.place[2][k];
            const Double4 force = contribution.force_at(s, i, j, k);
            SolidBody::Node *const node = &body.nodes[at], *const pressure = &body.mirror_force[at];
            store(node, load(node) +
                            w * (contribution.base + contribution.affine[0] * d[0] + contribution.affine[1] * d[1] +
                                 contribution.affine[2] * d[2]) +
                            force);
            store(pressure, load(pressure) + force);
        }
    }

    void give_to(LazyArray<SolidBody::Node>& sums, const SolidBody& body, Index p, double dt) const override {
        const Point point(*this, body, p);
        const Contribution contribution = contribution_of(point, point.v + dt * body.gravity, dt);
        const Stencil3d<affine> s(body.grid, point.x);
        for (int n = 0; n < 27; ++n) {
            const int i = n % 3, j = n / 3 % 3, k = n / 9;
            SolidBody::Node* const node = &sums[s.place[0][i] + s.place[1][j] + s.place[2][k]];
            store(node, load(node) + contribution.at(s, i, j, k));
        }
    }

    void show(SolidBody& body, MirrorBatch& batch, double dt) const override {
        batch.fill();
        const BatchContribution contribution = mirrored_contribution<!flip>(law_, body.points, batch, body.gravity, dt);
        const double ahead =
            static_cast<double>(kTile3d);  // places count from here: mirror particles may lie below zero
        const Double4 from_there[3] = {batch.place[0] + ahead, batch.place[1] + ahead, batch.place[2] + ahead};
        const BatchPlace at(from_there);
        const BatchShares<affine, false> shares(at, contribution, body.grid.cell());
        double* const nodes = &body.nodes.data()->m;
        for (int lane = 0; lane < batch.count; ++lane)
            contribute(body.grid, nodes,
                       {at.first[0][lane] - kTile3d, at.first[1][lane] - kTile3d, at.first[2][lane] - kTile3d}, shares,
                       lane);
        batch.count = 0, batch.slides = 0;
    }

    /// Not inlined. In the function that holds the block the compiler would find each node's address anew, two more
    /// instructions a node.
    [[gnu::noinline]] void scatter_points(const SolidBody& body, Index begin, Index end, double dt, const Box3d& box,
                                          NodeBlock& block) const {
        Index p = begin;
        for (; p + 4 <= end; p += 4) {
            read_ahead<Law>(body.points, begin, p, end);
            scatter_batch(body, p, 4, dt, box, block);
        }
        if (p < end) scatter_batch(body, p, static_cast<int>(end - p), dt, box, block);
    }
    [[gnu::always_inline]] void scatter_batch(const SolidBody& body, Index p, int lanes, double dt, const Box3d& box,
                                              NodeBlock& block) const {
        const MaterialPoints& q = body.points;
        Double4 x[3], v[3], state[7];
        Mat3x4 gradient;
        load_all(q.x.data(), 3, p, lanes, x);
        load_all(q.v.data(), 3, p, lanes, v);
        load_all(q.gradient.data(), 9, p, lanes, gradient.entry);
        load_all(q.state.data(), Law::kStates, p, lanes, state);
        const Double4 j = load(q.j.data() + p, lanes), mass = load(q.mass.data() + p, lanes);
        const Double4 impulse_scale = -dt * load(q.rest_volume.data() + p, lanes);
        const Mat3x4 stress = (law_.stress(j, state, gradient) * impulse_scale).matrix();
        BatchContribution contribution;
        contribution.mass = mass, contribution.mass_j = mass * j;
        for (int k = 0; k < 3; ++k) {
            contribution.momentum[k] = mass * (flip ? v[k] : v[k] + dt * body.gravity[k]);
            if constexpr (flip) contribution.weight[k] = mass * (dt * body.gravity[k]);
            for (int l = 0; l < 3; ++l)
                contribution.affine[l][k] = mass * gradient(k, l), contribution.force[l][k] = stress(k, l);
        }
        const BatchPlace place(x);
        const BatchShares<affine, flip> shares(place, contribution, body.grid.cell());
        const Int4 at = place.in_block(box);
        for (int point = 0; point < lanes; ++point) contribute<Law::kAverages>(block, at[point], shares, point);
    }

    void take(const NodeBlock& block, const Box3d& box, const Double4* x, int lanes, double h,
              BatchTaken& taken) const override {
        const BatchPlace place(x);
        const BatchWeights<affine> weights(place, h);
        const Int4 at = place.in_block(box);
        PointTaken one[4];
        for (int point = 0; point < 4; ++point)  // beyond `lanes`: any finite numbers
            one[point] = weights.template take<flip>(block, at[point < lanes ? point : 0], point);
        transpose(one[0].mean, one[1].mean, one[2].mean, one[3].mean, taken.mean);
        for (int l = 0; l < 3; ++l)
            transpose(one[0].slope[l], one[1].slope[l], one[2].slope[l], one[3].slope[l], taken.slope[l]);
        if constexpr (flip)
            transpose(one[0].flip_sums, one[1].flip_sums, one[2].flip_sums, one[3].flip_sums, taken.flip_sums);
    }
};

}  // namespace

std::unique_ptr<Mpm3dKernel> make_mpm3d_kernel(const SolidLaw& law, Affine affine, bool flip) {
    return std::visit(
        [&](const auto& chosen) -> std::unique_ptr<Mpm3dKernel> {
            using Law = std::decay_t<decltype(chosen)>;
            if (affine == Affine::apic) return std::make_unique<Kernel<Law, Affine::apic, false>>(chosen);
            if (flip) return std::make_unique<Kernel<Law, Affine::tpic, true>>(chosen);
            return std::make_unique<Kernel<Law, Affine::tpic, false>>(chosen);
        },
        law);
}

}  // namespace frana
