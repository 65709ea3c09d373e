#pragma once
// What material adjacent to the points gives to their nodes (SolidBody::Ghosts), itself and its mirror particles.
#include <algorithm>
#include <cmath>
#include <vector>

#include "solid3d/stencil3d.h"

namespace frana {

template <Affine affine>
class GhostScatter {
public:
    /// One thread: it is a thin layer. Nodes store apart what the points alone gave them.
    static void scatter(SolidBody& body, double time, double dt) {
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

    static void scatter_mirrors(SolidBody& body) {
        for (const auto& shown : body.ghosts.seeds)
            if (shown.on_barrier) add_ghost(body, shown, body.on_barriers);
        for (const auto& shown : body.ghosts.mirrors) add_ghost(body, shown, body.nodes);
    }

private:
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
};

}  // namespace frana
