// The loops of the 3D step, one instance for each law and transfer.
#include <Eigen/Geometry>

#include <algorithm>
#include <limits>
#include <type_traits>

#include "base/error.h"
#include "base/touch.h"
#include "solid3d/batch_sums.h"
#include "solid3d/mirror_batch.h"
#include "solid3d/mpm3d.h"
#include "solid3d/point_batch.h"

namespace frana {
namespace {

constexpr double kRounding = 1e-9;     ///< of sums over points, a generous share
constexpr double kLongestShift = 1.0;  ///< of a point in a step [cells]: the time step allows its cfl

/// A point's 27 nodes in the grid, for mirror particles: they lie anywhere.
template <Affine affine>
struct Stencil3d {
    Index place[3][3];  ///< shares of the nodes' storage indices
    double w[3][3], slope[3][3], d[3][3];

    [[gnu::always_inline]] Stencil3d(const Grid3d& grid, const Vec3& x) {
        for (int axis = 0; axis < 3; ++axis) {
            const double first = std::floor(x[axis] - 0.5);
            const Spline<affine, double> s(x[axis] - first, grid.cell());
            std::copy_n(grid.place(axis, static_cast<Index>(first)), 3, place[axis]);
            std::copy_n(s.w, 3, w[axis]), std::copy_n(s.slope, 3, slope[axis]), std::copy_n(s.d, 3, d[axis]);
        }
    }
};

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

/// flip: points retain their velocities and get the changes of the nodes' ones (mpm3d.h).
template <class Law, Affine affine, bool flip>
class Kernel final : public Mpm3dKernel {
public:
    explicit Kernel(const Law& law) : law_(law) {}

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

    /// One thread: it is a thin layer. Nodes store apart what the points alone gave them.
    void scatter_ghosts(SolidBody& body, double time, double dt) const override {
        SolidBody::Ghosts& ghosts = body.ghosts;
        ghosts.reaches.assign(body.active.work.size(), 0);
        ghosts.tile_impulse.assign(body.active.work.size(), Vec3::Zero());
        list_ghosts(body, time, dt);
        for (const auto* list : {&ghosts.seeds, &ghosts.mirrors})
            for (const auto& shown : *list) mark_reached(body, shown.place, ghosts.reaches);
        const auto copy = [&](LazyArray<SolidBody::Node>& to) {
            for_each_work_tile(body.active, [&](Index n, Index tile) {
                if (ghosts.reaches[static_cast<std::size_t>(n)])
                    std::copy_n(&body.nodes[tile * kTileNodes], kTileNodes, &to[tile * kTileNodes]);
            });
        };
        copy(ghosts.own);
        for (const auto& shown : ghosts.seeds) add_ghost(body, shown, body.nodes);
        copy(body.real);
    }

    void scatter_ghost_mirrors(SolidBody& body) const override {
        for (const auto& shown : body.ghosts.seeds)
            if (shown.on_barrier) add_ghost(body, shown, body.on_barriers);
        for (const auto& shown : body.ghosts.mirrors) add_ghost(body, shown, body.nodes);
    }

    void move_nodes(SolidBody& body) const override {
        for_each_work_tile(body.active, [&](Index n, Index tile) {
            const SurfaceSet near = body.near_nodes[static_cast<std::size_t>(n)];
            const Index first = tile * kTileNodes;
            Vec3* const impulse = body.tile_impulse.data() + n * static_cast<Index>(body.surfaces.size());
            std::fill_n(impulse, body.surfaces.size(), Vec3::Zero());
            const Given given{impulse,
                              near & body.barriers ? &body.node_impulses[static_cast<std::size_t>(n)] : nullptr,
                              &body.tile_work[static_cast<std::size_t>(n)]};
            *given.work = {};
            if (given.faces) given.faces->clear();
            if (!body.ghosts.reaches.empty() && body.ghosts.reaches[static_cast<std::size_t>(n)])
                return move_nodes_near_ghosts(body, n, tile, given);
            for (Index k = first; k < first + kTileNodes; ++k) {
                auto& node = body.nodes[k];
                const double real = near ? body.real[k].m : node.m;
                if (!(real > 0.0)) {
                    node = {};
                    if constexpr (flip) body.flip_sums[k] = {};
                    continue;
                }
                double mean_j = 0.0;
                if constexpr (Law::kAverages) mean_j = (flip ? body.flip_sums[k].m : body.mass_j[k]) / real;
                Vec3 v = Vec3(node.x, node.y, node.z) / node.m;
                if (near)
                    v = meet(body, near, k, place_of(body.grid, tile, k - first), body.real[k], v, had2(body, k),
                             given);
                node = {mean_j, v[0], v[1], v[2]};
                if constexpr (flip) {
                    SolidBody::Node& had = body.flip_sums[k];
                    const double share = body.flip_share / real;
                    had = {0.0, v[0] - share * had.x, v[1] - share * had.y, v[2] - share * had.z};
                }
            }
        });
    }

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

private:
    static const solid::Elastic& elastic_of(const solid::Elastic& law) { return law; }
    static const solid::Elastic& elastic_of(const solid::DruckerPrager& law) { return law.elastic; }

    /// Logarithmic strain under a pressure: K tr(e) = - J p, J = exp(tr(e)), by turns: each errs p / K less. Returns J.
    static double press_solid(const solid::Elastic& law, double p, double* strain) {
        constexpr int kTurns = 20;
        const double bulk = law.lambda + 2.0 / 3.0 * law.shear;
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

    /// A point gives its mirror particle in a barrier to those nodes only that the mirror particle shows at.
    [[gnu::noinline]] void show_before_cuts(SolidBody& body, Index p, const MirrorParticle& mirror, const Vec3& place,
                                            double dt) const {
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

    /// A point gives its mass and momentum to other sums at its nodes too.
    [[gnu::noinline]] void give_to(LazyArray<SolidBody::Node>& sums, const SolidBody& body, Index p, double dt) const {
        const Point point(*this, body, p);
        const Contribution contribution = contribution_of(point, point.v + dt * body.gravity, dt);
        const Stencil3d<affine> s(body.grid, point.x);
        for (int n = 0; n < 27; ++n) {
            const int i = n % 3, j = n / 3 % 3, k = n / 9;
            SolidBody::Node* const node = &sums[s.place[0][i] + s.place[1][j] + s.place[2][k]];
            store(node, load(node) + contribution.at(s, i, j, k));
        }
    }

    /// What material adjacent to the points gives at `time`: itself, and its mirror particles in surfaces. Only where
    /// points may be.
    static void list_ghosts(SolidBody& body, double time, double dt) {
        SolidBody::Ghosts& ghosts = body.ghosts;
        const SolidSeeds& seeds = ghosts.material.seeds;
        const Vec3& origin = body.grid.geometry().origin;
        const double h = body.grid.cell();
        ghosts.seeds.clear(), ghosts.mirrors.clear();
        for (std::size_t p = 0; p < seeds.mass.size(); ++p) {
            const Vec3 x = seeds.position[p] + (time - ghosts.material.time) * seeds.velocity[p];
            const Vec3 momentum = seeds.mass[p] * (seeds.velocity[p] + dt * body.gravity);
            const Mat3 motion = seeds.mass[p] * ghosts.material.gradient[p];
            const Mat3 force = dt * seeds.pressure[p] * seeds.mass[p] / body.density * Mat3::Identity();
            const Vec3 place = (x - origin) / h;
            const MirrorParticles mirrors(body.surfaces, ghosts.near[p], x, h);
            if (felt(body, place))
                ghosts.seeds.push_back(
                    {place, seeds.mass[p], momentum, motion, force, {}, mirrors.stands_on_barrier()});
            for (const MirrorParticle& mirror : mirrors) {
                const Vec3 shown = (mirror.place - origin) / h;
                if ((shown - place).cwiseAbs().maxCoeff() > kFarthestMirror || !felt(body, shown)) continue;
                ghosts.mirrors.push_back(
                    {shown, mirror.share * seeds.mass[p], mirror.share * (mirror.motion * momentum),
                     mirror.share * (mirror.motion * mirror.without_shear(motion) * mirror.turn.transpose()),
                     mirror.share * (mirror.motion * force * mirror.turn.transpose()), mirror, false});
            }
        }
    }

    /// Whether points have given to a node of a stencil in this step. What other tiles hold is old.
    static bool felt(const SolidBody& body, const Vec3& place) {
        if (!seen(body, place)) return false;
        const Index* at[3];
        for (int axis = 0; axis < 3; ++axis)
            at[axis] = body.grid.place(axis, static_cast<Index>(std::floor(place[axis] - 0.5)));
        for (int n = 0; n < 27; ++n) {
            const Index node = at[0][n % 3] + at[1][n / 3 % 3] + at[2][n / 9];
            if (body.active.in_work[static_cast<std::size_t>(node / kTileNodes)] && body.nodes[node].m > 0.0)
                return true;
        }
        return false;
    }

    /// Tiles of the work list that have nodes of a stencil.
    static void mark_reached(const SolidBody& body, const Vec3& place, std::vector<std::uint8_t>& marks) {
        const auto& work = body.active.work;
        for (int corner = 0; corner < 8; ++corner) {
            Index first[3];
            for (int axis = 0; axis < 3; ++axis)
                first[axis] = static_cast<Index>(std::floor(place[axis] - 0.5)) + Index{2} * (corner >> axis & 1);
            const Index tile = body.grid.tile_of(first[0], first[1], first[2]);
            if (body.active.in_work[tile])
                marks[static_cast<std::size_t>(std::lower_bound(work.begin(), work.end(), tile) - work.begin())] = 1;
        }
    }

    static void add_ghost(SolidBody& body, const SolidBody::Ghosts::Shown& shown, LazyArray<SolidBody::Node>& nodes) {
        const Stencil3d<affine> s(body.grid, shown.place);
        const Vec3& origin = body.grid.geometry().origin;
        for (int n = 0; n < 27; ++n) {
            const int i = n % 3, j = n / 3 % 3, k = n / 9;
            const Vec3 d(s.d[0][i], s.d[1][j], s.d[2][k]);
            if (!shown.mirror.shows_at(origin + body.grid.cell() * shown.place + d)) continue;
            const double w = s.w[0][i] * s.w[1][j] * s.w[2][k];
            const Vec3 slope(s.slope[0][i] * s.w[1][j] * s.w[2][k], s.w[0][i] * s.slope[1][j] * s.w[2][k],
                             s.w[0][i] * s.w[1][j] * s.slope[2][k]);
            const Index at = s.place[0][i] + s.place[1][j] + s.place[2][k];
            SolidBody::Node& node = nodes[at];
            const Vec3 force = shown.force * slope, given = w * (shown.momentum + shown.affine * d) + force;
            if (shown.mirror.of_barrier) {
                SolidBody::Node& pressure = body.mirror_force[at];
                pressure.x += force[0], pressure.y += force[1], pressure.z += force[2];
            }
            node.m += w * shown.mass, node.x += given[0], node.y += given[1], node.z += given[2];
        }
    }

    /// Mirror particles give to their nodes, and the batch is empty again.
    [[gnu::noinline]] void show(SolidBody& body, MirrorBatch& batch, double dt) const {
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

    /// Whether any tile that a mirror particle's stencil touches is on the work list.
    static bool seen(const SolidBody& body, const Vec3& place) {
        std::array<Index, 3> first;
        for (int axis = 0; axis < 3; ++axis) first[axis] = static_cast<Index>(std::floor(place[axis] - 0.5));
        if (!body.grid.holds(first)) return false;
        bool listed = false;
        for (int corner = 0; corner < 8; ++corner)
            listed |= body.active.in_work[body.grid.tile_of(first[0] + Index{2} * (corner & 1), first[1] + (corner & 2),
                                                            first[2] + (corner & 4) / 2)] != 0;
        return listed;
    }

    static Vec3 place_of(const Grid3d& grid, Index tile, Index within) {
        const std::array<Index, 3> t = grid.tile_place(tile);
        const Index i = within % kTile3d, j = within / kTile3d % kTile3d, k = within / (kTile3d * kTile3d);
        const Vec3 node(static_cast<double>(grid.first_node(t[0]) + i), static_cast<double>(grid.first_node(t[1]) + j),
                        static_cast<double>(grid.first_node(t[2]) + k));
        return grid.geometry().origin + grid.cell() * node;
    }

    /// A surface that a node's material meets, and how it changes the node's velocity.
    struct Touch {
        int surface;
        Contact contact;
        double least;                ///< speed away from the surface that it requires [m/s]
        double normal_change = 0.0;  ///< along its normal, never below zero [m/s]
        Vec3 brake{0, 0, 0};         ///< along the surface [m/s]
    };
    static constexpr int kMostTouched = 6;

    /// Surfaces that mirror particles of points at `x` can reach, with the speeds they require. That is what points and
    /// mirror particles together have along the normal (`mixed`), and behind a surface none into it.
    static int touched(const SolidBody& body, SurfaceSet near, Index node, const Vec3& x, const Vec3& mixed,
                       Touch* list) {
        int count = 0;
        const bool all_on_barriers =
            (near & body.barriers) && body.on_barriers[node].m >= (1.0 - kRounding) * body.real[node].m;
        for (; near != 0 && count < kMostTouched; near &= near - 1) {
            const int s = __builtin_ctz(near);
            if (body.barriers >> s & 1) {
                count = touched_barrier(body, s, node, x, mixed, list, count);
                continue;
            }
            const Contact c = contact(body.surfaces[static_cast<std::size_t>(s)], x);
            if (c.distance > 0.5 * mirror_reach(c.normal) * body.grid.cell()) continue;
            if (all_on_barriers && is_floor(c.normal)) continue;
            const double asked = mixed.dot(c.normal);
            list[count++] = {s, c, c.distance <= 0.0 ? std::max(asked, 0.0) : asked};
        }
        return count;
    }

    /// Where the ground and the top of a low barrier reach a node both, it meets them as one. How much each of them
    /// gives is not told by their normals. It follows from what the material needs that stands on each.
    struct Shared {
        int ground = -1, top = -1;  ///< in the list of touches; top: -1 where there is none
        double of_top = 0.0;        ///< [1]
        Touch apart_ground{}, apart_top{};
    };
    static Vec3 momentum(const SolidBody::Node& node) { return {node.x, node.y, node.z}; }

    static Shared ground_and_top(const SolidBody& body, const Touch* list, int count) {
        Shared shared;
        for (int n = 0; n < count; ++n)
            if (!(body.barriers >> list[n].surface & 1) && is_floor(list[n].contact.normal)) shared.ground = n;
        double nearest = kSameFace;
        for (int n = 0; n < count && shared.ground >= 0; ++n) {
            const double along = list[n].contact.normal.dot(list[shared.ground].contact.normal);
            if ((body.barriers >> list[n].surface & 1) && along > nearest) shared.top = n, nearest = along;
        }
        return shared;
    }

    [[gnu::noinline]] static Shared share_ground(const SolidBody& body, Index node, const SolidBody::Node& real,
                                                 Touch* list, int& count) {
        const SolidBody::Node& on = body.on_barriers[node];
        Shared shared;
        if (on.m > 0.0) shared = ground_and_top(body, list, count);
        if (shared.top < 0) return shared;
        expect(shared.ground < shared.top, "floors come before barriers");
        Touch &ground = list[shared.ground], &top = list[shared.top];
        shared.apart_ground = ground, shared.apart_top = top;
        ground.least = std::max(ground.least, top.least);
        const auto needed = [&](double mass, const Vec3& has, const Touch& from) {
            return std::max(0.0, mass * ground.least - has.dot(from.contact.normal));
        };
        const double by_top = needed(on.m, momentum(on), top),
                     by_ground = needed(real.m - on.m, momentum(real) - momentum(on), ground);
        const double s = by_top + by_ground > 0.0 ? by_top / (by_top + by_ground) : std::min(1.0, on.m / real.m);
        shared.of_top = s;
        ground.contact.normal = ((1.0 - s) * ground.contact.normal + s * top.contact.normal).normalized();
        top = list[--count];
        return shared;
    }

    /// Both again, each with its share of the impulse.
    [[gnu::noinline]] static void give_each(const Shared& shared, Touch* list, int& count) {
        if (shared.top < 0) return;
        const double s = shared.of_top, given = list[shared.ground].normal_change;
        Touch ground = shared.apart_ground, top = shared.apart_top;
        const double length = ((1.0 - s) * ground.contact.normal + s * top.contact.normal).norm();
        ground.normal_change = (1.0 - s) * given / length, top.normal_change = s * given / length;
        list[shared.ground] = ground;
        list[count++] = list[shared.top];
        list[shared.top] = top;
    }

    /// The same for the faces of a barrier. In one so thin that material of both sides shares a node, the sides' mirror
    /// particles are not told apart. Nothing goes into either side. At an edge a node carries some of the pressure
    /// of faces that it is not before. They require no more than the impulse of their mirror particles' pressure. With
    /// their motion too they would brake what passes the edge.
    [[gnu::noinline]] static int touched_barrier(const SolidBody& body, int s, Index node, const Vec3& x,
                                                 const Vec3& mixed, Touch* list, int count) {
        Contact found[kMostContacts];
        const Surface& barrier = body.surfaces[static_cast<std::size_t>(s)];
        const int faces = contacts(barrier, x, body.grid.cell(), found);
        bool thin = false;
        for (int n = 1; n < faces; ++n) thin |= found[0].normal.dot(found[n].normal) < kOpposite;
        thin = thin && found[0].distance <= 0.0;
        const MetFaces met =
            thin ? MetFaces{faces, faces} : faces_at_edge(body.surfaces, barrier, x, body.grid.cell(), found, faces);
        const SolidBody::Node &real = body.real[node], &pressure = body.mirror_force[node];
        const Vec3 pressed = Vec3(real.x + pressure.x, real.y + pressure.y, real.z + pressure.z) / real.m;
        for (int n = 0; n < met.all && count < kMostTouched; ++n) {
            const Contact& c = found[n];
            if (c.distance > 0.5 * mirror_reach(c.normal) * body.grid.cell()) continue;
            const double asked = thin ? 0.0 : mixed.dot(c.normal);
            const double least = n >= met.faced      ? std::min(asked, pressed.dot(c.normal))
                                 : c.distance <= 0.0 ? std::max(asked, 0.0)
                                                     : asked;
            list[count++] = {s, c, least};
        }
        return count;
    }

    /// Normal impulses that give each surface its speed, or none where the material leaves it faster. They are found by
    /// turns (projected Gauss-Seidel), at once where surfaces are perpendicular to each other.
    static void separate(Touch* list, int count, Vec3& v) {
        constexpr int kTurns = 20;  // a corner of 60 degrees errs by a quarter of the turn before: 1e-12 of the start
        for (int turn = 0; turn < (count > 1 ? kTurns : 1); ++turn)
            for (Touch* t = list; t < list + count; ++t) {
                const double change = std::max(t->least - v.dot(t->contact.normal), -t->normal_change);
                t->normal_change += change;
                v += change * t->contact.normal;
            }
    }

    /// Surfaces at rest do no work: no normal force gives a node more energy than it had. What mirror particles require
    /// beyond that is not the material's. In corners, and where few points shear, they show motion that is not there.
    /// The answer lies between v and what is left where no force makes anything leave a surface. That is no faster than
    /// what came. In oblique corners and where the ground bends only: elsewhere the same would take from what rebounds,
    /// and from what spreads along a surface.
    [[gnu::noinline]] static Vec3 without_gain(const SolidBody& body, const Vec3& x, Touch* list, int count,
                                               const Vec3& came, const Vec3& v, double most2) {
        if (!oblique(list, count) && !bent(body, x, list, count)) return v;
        Touch soft[kMostTouched];
        for (int n = 0; n < count; ++n) {
            soft[n] = list[n];
            soft[n].normal_change = 0.0;
            soft[n].least = std::min(soft[n].least, 0.0);
        }
        Vec3 slow = came;
        separate(soft, count, slow);
        // |slow + s (v - slow)|^2 = most2
        const Vec3 more = v - slow;
        const double a = more.squaredNorm(), b = slow.dot(more), c = most2 - slow.squaredNorm();
        const double root = std::sqrt(b * b + a * std::max(0.0, c));  // both forms are without cancellation
        const double s = c > 0.0 && a > 0.0 ? std::min(1.0, b > 0.0 ? c / (b + root) : (root - b) / a) : 0.0;
        for (int n = 0; n < count; ++n)
            list[n].normal_change = soft[n].normal_change + s * (list[n].normal_change - soft[n].normal_change);
        return slow + s * more;
    }

    /// Whether the ground turns so far within the reach of a node's points that it is a corner.
    static bool bent(const SolidBody& body, const Vec3& x, const Touch* list, int count) {
        constexpr double kBend = 0.707;  // cosine of 45 degrees
        const double reach = 1.5 * body.grid.cell();
        for (const Touch* t = list; t < list + count; ++t) {
            const Surface& surface = body.surfaces[static_cast<std::size_t>(t->surface)];
            if (surface.kind != Surface::Kind::ground) continue;
            for (const auto& [dx, dy] : {std::pair{reach, 0.0}, {-reach, 0.0}, {0.0, reach}, {0.0, -reach}})
                if (contact(surface, x + Vec3(dx, dy, 0.0)).normal.dot(t->contact.normal) < kBend) return true;
        }
        return false;
    }

    struct Touches {
        const Touch *begin, *end;
    };
    /// v, held by a stuck surface: along it, what points and mirror particles have, and nothing into others. Also
    /// behind it, where mirror particles turn velocities round. With nodes at rest, material would stand still above a
    /// surface that lies between them. It would lose more to it at each step. But in a barrier mirror particles end
    /// halfway. Points that retain their velocities would have each turn added to the one before.
    static Vec3 held(const SolidBody& body, const Vec3& mixed, const Vec3& v, const Touch* by, const Touches& all) {
        const bool still = by->contact.distance <= 0.0 && (flip || (body.barriers >> by->surface & 1));
        Vec3 kept = along_of(still ? Vec3::Zero() : mixed, v, by->contact.normal);
        for (const Touch* t = all.begin; t < all.end; ++t)
            if (t != by) kept += std::max(0.0, t->least - kept.dot(t->contact.normal)) * t->contact.normal;
        return kept;
    }

    /// Whether two surfaces there are not perpendicular to each other.
    static bool oblique(const Touch* list, int count) {
        constexpr double kSquare = 1e-9;  // round-off of normals
        for (int n = 0; n < count; ++n)
            for (int m = 0; m < n; ++m)
                if (std::abs(list[n].contact.normal.dot(list[m].contact.normal)) > kSquare) return true;
        return false;
    }

    /// v, or as much of it as has no more than that square of the speed.
    static Vec3 no_faster(const Vec3& v, double most2) {
        const double speed2 = v.squaredNorm();
        return speed2 > most2 ? Vec3(std::sqrt(most2 / speed2) * v) : v;
    }

    /// Square of a node's speed before the step's impulses, where points that retain their velocities tell it; else
    /// zero. Stress next to a surface presses a node into it in the step, and the surface takes that back.
    static double had2(const SolidBody& body, Index k) {
        if constexpr (!flip) return 0.0;
        const SolidBody::Node& had = body.flip_sums[k];
        return Vec3(had.x, had.y, had.z).squaredNorm() / (body.real[k].m * body.real[k].m);
    }

    /// The same of what points and adjacent material share. Of that its motion after the step's impulses is known only.
    static double had2_in_common(const SolidBody& body, Index k) {
        if constexpr (!flip) return 0.0;
        const SolidBody::Node &had = body.flip_sums[k], &own = body.ghosts.own[k], &both = body.real[k];
        const Vec3 of_other(both.x - own.x, both.y - own.y, both.z - own.z);
        return (Vec3(had.x, had.y, had.z) + of_other).squaredNorm() / (both.m * both.m);
    }

    /// Where impulses on the nodes of a tile are recorded.
    struct Given {
        Vec3* impulse;                    ///< per surface
        std::vector<FaceImpulse>* faces;  ///< of barriers, where some are near
        SurfaceWork* work;                ///< of all surfaces
    };

    /// The velocity of a node near surfaces. `mixed` is what points and mirror particles gave it. Free surfaces take
    /// from it only what it has along their normal. Along themselves mirror particles would brake material that shears.
    /// Contact is unilateral: normal forces are compressive. Friction follows from the normal force. Records each
    /// surface's impulse on the real material.
    static Vec3 meet(const SolidBody& body, SurfaceSet near, Index node, const Vec3& x, const SolidBody::Node& real,
                     const Vec3& mixed, double had2, const Given& given) {
        Touch list[kMostTouched];
        int count = touched(body, near, node, x, mixed, list);
        Vec3 v = Vec3(real.x, real.y, real.z) / real.m;
        const Vec3 came = v;
        const double most2 = std::max(came.squaredNorm(), had2);
        const Shared shared = near & body.barriers ? share_ground(body, node, real, list, count) : Shared{};
        separate(list, count, v);
        if (v.squaredNorm() > most2) v = without_gain(body, x, list, count, came, v, most2);
        give_each(shared, list, count);
        const Vec3 contact_work = v;
        for (Touch* t = list; t < list + count; ++t) {
            const Surface& surface = body.surfaces[static_cast<std::size_t>(t->surface)];
            const Vec3& normal = t->contact.normal;
            if (t->normal_change > 0.0) {
                const Vec3 before = v;
                if (surface.hold == Hold::stuck)
                    v = no_faster(held(body, mixed, v, t, {list, list + count}),
                                  oblique(list, count) ? most2 : std::numeric_limits<double>::infinity());
                else if (surface.law)
                    v = braked(v, normal, surface.law->coefficient(x) * t->normal_change);
                else if (surface.friction > 0.0)
                    v = braked(v, normal, surface.friction * t->normal_change);
                t->brake = v - before;
            }
            if (body.barriers >> t->surface & 1)
                list_impulse(body, t->surface, t->contact,
                             {real.m, x, 0.5 * body.grid.cell(), t->normal_change * normal + t->brake, Vec3::Zero(),
                              Vec3::Zero()},
                             *given.faces);
            else
                given.impulse[t->surface] += real.m * (t->normal_change * normal + t->brake);
        }
        // At the speed after the step, as the work of stress and weight. With that before them a surface would lose
        // what it undoes of both at once.
        given.work->contact_work += real.m * (contact_work - came).dot(v);
        given.work->friction -= real.m * (v - contact_work).dot(v);
        return v;
    }

    /// What a barrier does to a node or a point. It changes its speed, and moves it at the speed it then has.
    struct ImpulseAt {
        double mass;
        Vec3 place;
        double reach;  ///< of the material that it stands for, along the face [m]
        Vec3 change, shift, v;
    };
    /// Records it with the face. Not inlined, like all that barriers need, so that scenes without them have the
    /// bits they had. In place, it would share sums with other code, and so change what is fused there.
    [[gnu::noinline]] static void list_impulse(const SolidBody& body, int surface, const Contact& c,
                                               const ImpulseAt& source, std::vector<FaceImpulse>& list) {
        const Vec3 impulse = source.mass * source.change;
        if (impulse.isZero(0.0) && source.shift.isZero(0.0)) return;
        const int face = body.ledger.first(surface) + c.face;
        const Patches& patches = body.ledger.faces()[static_cast<std::size_t>(face)].patches;
        list.push_back(
            {face, patches.around(source.place - c.distance * c.normal, source.reach, body.surfaces), impulse,
             (source.place - body.grid.geometry().origin).cross(impulse) + source.mass * source.shift.cross(source.v)});
    }

    /// The same as move_nodes, where material adjacent to the points gave to the nodes. It and they have one velocity,
    /// on which surfaces then act. Of all impulses the points get the share of their mass. What came to them from the
    /// other material is recorded apart. Sums of J are of points alone.
    [[gnu::noinline]] static void move_nodes_near_ghosts(SolidBody& body, Index n, Index tile, const Given& given) {
        const SurfaceSet near = body.near_nodes[static_cast<std::size_t>(n)];
        for (Index k = tile * kTileNodes; k < (tile + 1) * kTileNodes; ++k) {
            SolidBody::Node& node = body.nodes[k];
            const SolidBody::Node &own = body.ghosts.own[k], &both = body.real[k];
            if (!(own.m > 0.0)) {
                node = {};
                if constexpr (flip) body.flip_sums[k] = {};
                continue;
            }
            const Vec3 shared = Vec3(both.x, both.y, both.z) / both.m;
            Vec3 v = shared;
            if (near) {
                const Vec3 mixed = Vec3(node.x, node.y, node.z) / node.m;
                v = meet_in_part(body, near, k, place_of(body.grid, tile, k - tile * kTileNodes), both, mixed,
                                 own.m / both.m, given);
            }
            const Vec3 impulse = own.m * shared - Vec3(own.x, own.y, own.z);
            body.ghosts.tile_impulse[static_cast<std::size_t>(n)] += impulse;
            given.work->contact_work += impulse.dot(v);
            double mean_j = 0.0;
            if constexpr (Law::kAverages) mean_j = (flip ? body.flip_sums[k].m : body.mass_j[k]) / own.m;
            node = {mean_j, v[0], v[1], v[2]};
            if constexpr (flip) {
                SolidBody::Node& had = body.flip_sums[k];
                const double share = body.flip_share / own.m;
                had = {0.0, v[0] - share * had.x, v[1] - share * had.y, v[2] - share * had.z};
            }
        }
    }

    /// The same as meet, of which `share` is recorded.
    static Vec3 meet_in_part(const SolidBody& body, SurfaceSet near, Index node, const Vec3& x,
                             const SolidBody::Node& real, const Vec3& mixed, double share, const Given& given) {
        std::array<Vec3, kMostSurfaces> impulse;
        impulse.fill(Vec3::Zero());
        SurfaceWork work{};
        const std::size_t before = given.faces ? given.faces->size() : 0;
        Vec3 v =
            meet(body, near, node, x, real, mixed, had2_in_common(body, node), {impulse.data(), given.faces, &work});
        for (std::size_t s = 0; s < body.surfaces.size(); ++s) given.impulse[s] += share * impulse[s];
        given.work->contact_work += share * work.contact_work, given.work->friction += share * work.friction;
        if (given.faces)
            for (std::size_t f = before; f < given.faces->size(); ++f)
                (*given.faces)[f].impulse *= share, (*given.faces)[f].moment *= share;
        return v;
    }

    /// v across the surface, `along` along it.
    static Vec3 along_of(const Vec3& along, const Vec3& v, const Vec3& normal) {
        return along + (v - along).dot(normal) * normal;
    }

    /// Less speed along a surface by `brake`, or none at all.
    static Vec3 braked(const Vec3& v, const Vec3& normal, double brake) {
        const Vec3 across = v.dot(normal) * normal, along = v - across;
        const double speed = along.norm();
        return across + along * (speed > brake ? 1.0 - brake / speed : 0.0);
    }

    static Vec3 position(const SolidBody& body, Index p) {
        return {body.points.x[0][p], body.points.x[1][p], body.points.x[2][p]};
    }

    /// The nodes that the points begin to end - 1 touch.
    static Box3d box_of(const MaterialPoints& q, Index begin, Index end) {
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

    static void load_all(const Array* arrays, int count, Index p, int lanes, Double4* to) {
        for (int n = 0; n < count; ++n) to[n] = load(arrays[n].data() + p, lanes);
    }
    static void store_all(const Double4* from, int count, Index p, int lanes, Array* arrays) {
        for (int n = 0; n < count; ++n) store(arrays[n].data() + p, from[n], lanes);
    }

    /// Now and then reads the arrays of the next points ahead (base/touch.h).
    static void read_ahead(const MaterialPoints& q, Index begin, Index p, Index end) {
        constexpr Index kAhead = 128;
        if ((p - begin) % kAhead == 0) touch_points(q, p, std::min(p + kAhead, end));
    }
    [[gnu::noinline]] static void touch_points(const MaterialPoints& q, Index first, Index last) {
        const auto ahead = [&](const Array* arrays, int count) {
            for (int n = 0; n < count; ++n) touch(arrays[n].data() + first, last - first);
        };
        ahead(q.x.data(), 3), ahead(q.v.data(), 3), ahead(q.gradient.data(), 9), ahead(q.state.data(), Law::kStates);
        ahead(&q.mass, 1), ahead(&q.rest_volume, 1), ahead(&q.j, 1);
    }

    /// Not inlined. In the function that holds the block the compiler would find each node's address anew, two more
    /// instructions a node.
    [[gnu::noinline]] void scatter_points(const SolidBody& body, Index begin, Index end, double dt, const Box3d& box,
                                          NodeBlock& block) const {
        Index p = begin;
        for (; p + 4 <= end; p += 4) {
            read_ahead(body.points, begin, p, end);
            scatter_batch(body, p, 4, dt, box, block);
        }
        if (p < end) scatter_batch(body, p, static_cast<int>(end - p), dt, box, block);
    }
    [[gnu::noinline]] SolidSums gather_points(SolidBody& body, Index tile, double dt, const NodeBlock& block) const {
        SolidSums sums;
        BatchSums lane_sums;
        const Index begin = body.active.begin[tile], end = body.active.begin[tile + 1];
        Index p = begin;
        for (; p + 4 <= end; p += 4) {
            read_ahead(body.points, begin, p, end);
            gather_batch(body, p, 4, dt, tile, block, lane_sums, sums);
        }
        if (p < end) gather_batch(body, p, static_cast<int>(end - p), dt, tile, block, lane_sums, sums);
        lane_sums.add_to(sums);
        return sums;
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

    /// Checks that points are finite, puts them back before surfaces, and records them.
    [[gnu::always_inline]] static void finish(SolidBody& body, Index p, int lanes, BatchPoints& now,
                                              const Double4* from, Index tile, BatchSums& lane_sums, SolidSums& sums) {
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

    static void take(const NodeBlock& block, const Box3d& box, const Double4* x, int lanes, double h,
                     BatchTaken& taken) {
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

    /// Points that came to lie behind a surface are put back on it, without their speed into it. It rarely happens.
    static void move_out(SolidBody& body, SurfaceSet near, Index p, Vec3* impulse) {
        MaterialPoints& q = body.points;
        const double h = body.grid.cell();
        for (; near != 0; near &= near - 1) {
            const int s = __builtin_ctz(near);
            const Contact c = contact(body.surfaces[static_cast<std::size_t>(s)],
                                      body.grid.geometry().origin + h * position(body, p));
            if (!(c.distance < 0.0)) continue;
            const double inward = q.v[0][p] * c.normal[0] + q.v[1][p] * c.normal[1] + q.v[2][p] * c.normal[2];
            const Vec3 change = -std::min(0.0, inward) * c.normal;
            for (int k = 0; k < 3; ++k) q.x[k][p] -= c.distance / h * c.normal[k], q.v[k][p] += change[k];
            impulse[s] += q.mass[p] * change;
        }
    }

    /// Points stay outside of barriers. If a point's way from its last place crosses a face, it is put back on that
    /// face. It then lies a hair before the face so that it never starts inside. Where there is no such place, it is
    /// put back where it was.
    [[gnu::noinline]] static void keep_out(SolidBody& body, Index tile, Index p, const Vec3& from) {
        constexpr int kTurns = 8;
        const SurfaceSet near = body.near_points[static_cast<std::size_t>(tile)] & body.barriers;
        const Vec3& origin = body.grid.geometry().origin;
        const double h = body.grid.cell();
        const Vec3 start = origin + h * from;
        bool free = false;
        for (int turn = 0; turn < kTurns && !free; ++turn) {
            free = true;
            for (SurfaceSet left = near; left != 0; left &= left - 1)
                free = !put_before(body, tile, p, __builtin_ctz(left), start) && free;
        }
        if (free) return;
        MaterialPoints& q = body.points;
        for (int k = 0; k < 3; ++k) q.x[k][p] = from[k];
    }

    /// Puts a point before the face of a barrier that it crossed, without its speed into it. Returns whether
    /// it did. A point that lay inside from the start comes out by the nearest face.
    [[gnu::noinline]] static bool put_before(SolidBody& body, Index tile, Index p, int s, const Vec3& start) {
        constexpr double kHair = 1e-9;  // of a cell: above round-off of places, below all that matters
        const Surface& surface = body.surfaces[static_cast<std::size_t>(s)];
        MaterialPoints& q = body.points;
        const double h = body.grid.cell();
        const Vec3& origin = body.grid.geometry().origin;
        const Vec3 x = origin + h * position(body, p);
        Contact c;
        Entry entry;
        if (enters(surface, start, x, entry)) {
            const Vec3 crossing = start + entry.share * (x - start);
            c = {entry.normal.dot(x - crossing), entry.normal, entry.face};
        } else if (surface.inside(x)) {
            c = contact(surface, x);
        } else {
            return false;
        }
        const Vec3 v(q.v[0][p], q.v[1][p], q.v[2][p]);
        const Vec3 change = -std::min(0.0, v.dot(c.normal)) * c.normal;
        for (int k = 0; k < 3; ++k) {
            q.x[k][p] += (kHair - c.distance / h) * c.normal[k];
            q.v[k][p] += change[k];
        }
        list_impulse(body, s, c, {q.mass[p], x, 0.0, change, (kHair * h - c.distance) * c.normal, v + change},
                     body.point_impulses[static_cast<std::size_t>(tile)]);
        return true;
    }

    /// Where numbers are finite, and points did not run away.
    [[gnu::always_inline]] static Mask4 is_finite(const BatchPoints& now, const Double4* from) {
        const Double4 shift = max(max(abs(now.x[0] - from[0]), abs(now.x[1] - from[1])), abs(now.x[2] - from[2]));
        const Double4 size = abs(now.v[0]) + abs(now.v[1]) + abs(now.v[2]) + abs(now.volume);
        return (size <= std::numeric_limits<double>::max()) & (shift < kLongestShift);
    }

    [[gnu::always_inline]] static Mask4 inside_of(const Grid3d& grid, const Double4* x) {
        Mask4 inside = x[0] >= 0.5;
        for (int k = 0; k < 3; ++k)
            inside &= (x[k] >= 0.5) & (x[k] <= static_cast<double>(grid.geometry().nodes[k]) - 1.5);
        return inside;
    }

    static void leave(SolidBody& body, Index p, const BatchPoints& now, int lane, SolidSums& sums) {
        const double mass = now.mass[lane];
        body.gone[static_cast<std::size_t>(p)] = 1;
        sums.left_mass += mass, ++sums.left;
        const Vec3 v(now.v[0][lane], now.v[1][lane], now.v[2][lane]);
        const Vec3 place = body.grid.geometry().origin + body.grid.cell() * position(body, p);
        sums.left_momentum += mass * v;
        sums.left_energy += mass * (0.5 * v.squaredNorm() - body.gravity.dot(place)) + now.stored[lane];
    }

    Law law_;
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
