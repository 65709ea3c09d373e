// The loops of a step of free water. Each tile is copied with three cells around it, and what goes through its faces is
// computed there. WaterFaces between two tiles are computed twice, from the same numbers to the same bits.
#include <algorithm>
#include <cmath>

#include "water/face_flux.h"
#include "water/held_side.h"
#include "water/water_block.h"
#include "water/water_brake.h"

namespace frana {
namespace {

/// The largest change of depth over four cells. Water that is thin against its fall there keeps half of it at each face. A
/// film that ends on a slope would be all on its upper side. It stayed, and went on to speed up. THEORY, section 3.
[[gnu::always_inline]] inline Double4 most_change(Double4 h, Double4 of_surface) {
    constexpr double kThin = 1.0 / 8;  // of its fall, from where on it is so
    return max(h, 2.0 * h - kThin * abs(of_surface));
}

/// Changes of depth and surface over four cells. The ground that they make of it lies at each face between the ground of
/// both cells, give or take an eighth of the depth. Limited by themselves they raise a crest to the surface of the water
/// before it. What is left on a crest they put all on its upper side. At the foot of a slope they lower the surface to dry
/// ground behind. Nothing would pass, however high it stood, and the slope would go on to speed it up. `most`: of the change
/// of depth. `before`, `behind`: the change of the ground from the cell before, and to the one behind. THEORY, section 3.
[[gnu::always_inline]] inline void keep_ground(Double4 h, Double4 surface, Double4 most, Double4 before, Double4 behind,
                                               Double4& of_depth, Double4& of_surface) {
    constexpr double kRoundOff = 1e-13;  // of the elevation; a lake on rough ground is left to the last bit
    constexpr double kOfDepth = 0.25;    // over the cell; leaves resolved crests under water to second order
    const Double4 none = {}, slack = kOfDepth * h + kRoundOff * (abs(surface) + abs(before) + abs(behind));
    const Double4 falls = 2.0 * min(before, none) - slack, rises = 2.0 * max(before, none) + slack,
                  falls_on = 2.0 * min(behind, none) - slack, rises_on = 2.0 * max(behind, none) + slack;
    const Double4 made = of_surface - of_depth;
    if (!any((made < max(falls, falls_on)) | (made > min(rises, rises_on)))) return;
    // Too high at a face: it is lowered under the surface.
    const Mask4 high = (made < falls) | (made > rises_on);
    const Double4 lowered = min(max(made, falls), rises_on), depth = min(max(of_surface - lowered, -most), most);
    of_depth = select(high, depth, of_depth), of_surface = select(high, depth + lowered, of_surface);
    // Too low: it is raised with what is on it.
    const Double4 left = of_surface - of_depth;
    const Mask4 low = (left < falls_on) | (left > rises);
    of_surface = select(low, of_depth + min(max(left, falls_on), rises), of_surface);
}

/// Changes along one axis, whose cells are `step` places apart, of the groups of four from `first` on.
void find_slopes(const WaterBlock& block, const double* along, const double* across, Index first, Index step,
                 double theta, WaterSlopes& to) {
    const auto change = [&](const double* of, Index k) {
        const Double4 here = load(of + k);
        return limited<Double4>(here - load(of + k - step), load(of + k + step) - here, theta);
    };
    for (Index n = 0; n < kGroups; ++n) {
        const Index k = first + 4 * n;
        const Double4 h = load(block.depth + k), surface = load(block.surface + k), ground = surface - h;
        const Double4 per = select(h > 0.0, 0.5 / h, Double4{});
        Double4 of_depth = change(block.depth, k), of_surface = change(block.surface, k);
        const Double4 most = most_change(h, of_surface);
        of_depth = min(max(of_depth, -most), most);
        const Double4 before = ground - (load(block.surface + k - step) - load(block.depth + k - step));
        const Double4 behind = (load(block.surface + k + step) - load(block.depth + k + step)) - ground;
        keep_ground(h, surface, most, before, behind, of_depth, of_surface);
        store(to.depth + k, of_depth), store(to.surface + k, of_surface);
        store(to.along + k, per * change(along, k)), store(to.across + k, per * change(across, k));
    }
}

/// A cell's water at its high face (sign 1) or at its low one (-1). It is linear in the cell, its momentum the cell's.
[[gnu::always_inline]] inline FaceSide<Double4> at_face(const WaterBlock& block, const double* along,
                                                        const double* across, const WaterSlopes& slopes, Index k,
                                                        double sign) {
    const Double4 h = load(block.depth + k), rise = (0.5 * sign) * load(slopes.depth + k);
    const Double4 here = h + rise, other = sign * (h - rise);
    const Double4 surface = load(block.surface + k) + (0.5 * sign) * load(slopes.surface + k);
    return {here, surface - here, load(along + k) + other * load(slopes.along + k),
            load(across + k) + other * load(slopes.across + k)};
}

/// Water that stands on higher ground than the next cell's surface falls into it. That is so whatever limited slopes
/// make of the ground at the face between them. On rough ground they put a step there that thin water would not pass.
/// It would go on to speed up behind that.
[[gnu::always_inline]] inline void let_fall(const WaterBlock& block, Index before, Index behind, FaceSide<Double4>& low,
                                            FaceSide<Double4>& high) {
    const Double4 surface_low = load(block.surface + before), surface_high = load(block.surface + behind);
    const auto down = surface_high < surface_low - load(block.depth + before),
               up = surface_low < surface_high - load(block.depth + behind);
    const Double4 least = min(low.ground, high.ground);
    high.ground = select(down, least, high.ground), low.ground = select(up, least, low.ground);
}

/// Fluxes through the faces between the places k - step and k of the groups of four from `first` on.
void find_fluxes(const WaterBlock& block, const double* along, const double* across, const WaterSlopes& slopes,
                 Index first, Index step, WaterFaces& to) {
    for (Index n = 0; n < kGroups; ++n) {
        const Index k = first + 4 * n;
        FaceFlux<Double4> f{};
        if (any((load(block.depth + k) > 0.0) | (load(block.depth + k - step) > 0.0))) {
            auto low = at_face(block, along, across, slopes, k - step, 1.0);
            auto high = at_face(block, along, across, slopes, k, -1.0);
            let_fall(block, k - step, k, low, high);
            f = face_flux<Double4>(low, high,
                                   0.5 * (load(block.normal_gravity + k) + load(block.normal_gravity + k - step)));
        }
        store(to.mass + k, f.mass), store(to.along + k, f.along), store(to.across + k, f.across);
        store(to.low + k, f.low), store(to.high + k, f.high);
    }
}

/// A face at a side of the grid lets nothing in but of a lake beyond it. Through a wall nothing goes out. `inside`: the
/// last cell.
void close(const WaterBody& body, const WaterBlock& block, WaterFaces& faces, Index k, Index inside, std::size_t side,
           double outward) {
    const bool leaves = body.sides[side] != WaterSide::wall && outward * faces.mass[k] > 0.0;
    if (leaves || meets_lake(body, block, inside, side)) return;
    faces.mass[k] = faces.along[k] = faces.across[k] = 0.0;
}

/// Change of a quantity over a cell, from neighbours that have water.
double change_at(const WaterBlock& block, const double* of, Index k, Index step) {
    const bool up = block.depth[k + step] > 0.0, down = block.depth[k - step] > 0.0;
    if (up && down) return 0.5 * (of[k + step] - of[k - step]);
    return up ? of[k + step] - of[k] : down ? of[k] - of[k - step] : 0.0;
}

/// All that is known of a tile in a stage.
struct Stage {
    WaterBlock block;
    WaterSlopes across_x, across_y;
    WaterFaces x, y;               ///< the low faces of cells
    alignas(32) BlockCells drain;  ///< share of what would flow out of a cell that there is
    Index first;                   ///< storage index of the block's first place
};

/// WaterFaces of the part's cells and of those next to them.
void find_faces(const WaterBody& body, const TilePart& part, Stage& s) {
    const WaterBlock& block = s.block;
    const Index last = kHalo + body.grid.nx() - part.i0, top = kHalo + body.grid.ny() - part.j0;
    for (Index b = kHalo - 1; b <= part.rows; ++b) {
        find_slopes(block, block.u, block.v, b * kRow + 1, 1, body.theta, s.across_x);
        s.across_x.depth[b * kRow + 21] = s.across_x.surface[b * kRow + 21] = 0.0;
        s.across_x.along[b * kRow + 21] = s.across_x.across[b * kRow + 21] = 0.0;
        find_fluxes(block, block.u, block.v, s.across_x, b * kRow + 2, 1, s.x);
        const Index low = b * kRow + kHalo, high = b * kRow + last;
        if (part.i0 == 0) close(body, block, s.x, low, low, 0, -1.0);
        if (last <= kHalo + kTile + 1) close(body, block, s.x, high, high - 1, 1, 1.0);
    }
    for (Index b = kHalo - 2; b <= part.rows + 1; ++b)
        find_slopes(block, block.v, block.u, b * kRow + 2, kRow, body.theta, s.across_y);
    for (Index b = kHalo - 1; b <= part.rows + 1; ++b) {
        find_fluxes(block, block.v, block.u, s.across_y, b * kRow + 2, kRow, s.y);
        for (Index a = kHalo - 1; a <= kHalo + kTile; ++a) {
            const Index k = b * kRow + a;
            if (part.j0 == 0 && b == kHalo) close(body, block, s.y, k, k, 2, -1.0);
            if (b == top) close(body, block, s.y, k, k - kRow, 3, 1.0);
        }
    }
}

/// No more leaves a cell than is in it. Beyond that its outflow is cut short (Bollermann et al. 2011,
/// doi:10.4208/cicp.220210.020710a). A part stays, so that round-off does not make it negative.
void find_drains(const TilePart& part, double cells, Stage& s) {
    constexpr double kKept = 1e-9;
    for (Index b = kHalo - 1; b <= part.rows; ++b)
        for (Index a = kHalo - 1; a <= kHalo + kTile; ++a) {
            const Index k = b * kRow + a;
            const double out = cells * (std::max(0.0, s.x.mass[k + 1]) - std::min(0.0, s.x.mass[k]) +
                                        std::max(0.0, s.y.mass[k + kRow]) - std::min(0.0, s.y.mass[k]));
            const double there = (1.0 - kKept) * s.block.depth[k];
            s.drain[k] = out > there ? there / out : 1.0;
        }
    const auto cut = [&](WaterFaces& faces, Index k, Index step) {
        const double share = faces.mass[k] > 0.0 ? s.drain[k - step] : s.drain[k];
        faces.mass[k] *= share, faces.along[k] *= share, faces.across[k] *= share;
    };
    for (Index b = kHalo; b <= part.rows; ++b)
        for (Index a = kHalo; a <= part.columns; ++a) {
            if (b < part.rows) cut(s.x, b * kRow + a, 1);
            if (a < part.columns) cut(s.y, b * kRow + a, kRow);
        }
}

/// A face through which viscosity acts.
struct ViscousFace {
    const double *along, *across;  ///< velocities of the block through it and along it [m/s]
    Index step;                    ///< from the cell before it to the one behind it
    bool at_side, counts;          ///< of the grid; among those whose energy the tile records
};

/// Products of the confined mass's gradient of share and the slip of the water over it, over a face's cell.
struct GradientStress {
    double normal = 0.0, tangent = 0.0;  ///< [m/s]
};

/// (30) of van den Bout et al. (2021): grad alpha_c (u_u - u_c) + its transpose, mobility alpha_u. Where only one side has
/// confined mass the slip is that side's.
GradientStress gradient_stress(const WaterBody& body, const Stage& s, const ViscousFace& of, Index k) {
    const Index stride = body.grid.stride(), at = s.first + k / kRow * stride + k % kRow;
    const bool in_x = of.step == 1;
    const Index back = in_x ? 1 : stride, aside = in_x ? stride : 1;
    const double *bound_along = (in_x ? body.bound_x : body.bound_y).data(),
                 *bound_across = (in_x ? body.bound_y : body.bound_x).data();
    double slip_along = 0.0, slip_across = 0.0, change = 0.0, sides = 0.0;
    const auto take = [&](Index cell, Index node) {
        change +=
            0.25 * (body.share[node + aside] - body.share[node - aside]);  // of both, half of a central difference
        if (!(body.share[node] > 0.0)) return;
        slip_along += of.along[cell] - bound_along[node], slip_across += of.across[cell] - bound_across[node], ++sides;
    };
    take(k - of.step, at - back), take(k, at);
    if (sides == 0.0) return {};
    const double rise = body.share[at] - body.share[at - back];
    return {rise * slip_along / sides, (rise * slip_across + change * slip_along) / sides};
}

/// Viscous stress through a face over density: h nu (grad u + grad u^T)
/// (Pudasaini 2012, averaged over the depth). h is the harmonic mean of both cells', which is none next to dry ground.
/// Water at a wall slides along it. Returns the energy lost in a time of cell^2, of those faces that belong to
/// the tile. They are the low ones of its cells. At the side of the grid it is half of what its mirror would have.
double add_viscous(const WaterBody& body, const Stage& s, const ViscousFace& of, Index k, WaterFaces& faces) {
    const Index back = k - of.step, aside = of.step == 1 ? kRow : 1;
    const double low = s.block.depth[back], high = s.block.depth[k];
    if (!(low > 0.0 && high > 0.0)) return 0.0;
    const double conducts = body.viscosity.kinematic / body.grid.cell() * 2.0 * low * high / (low + high);
    const double du = of.along[k] - of.along[back], dv = of.across[k] - of.across[back];
    const double shear = 0.5 * (change_at(s.block, of.along, k, aside) + change_at(s.block, of.along, back, aside));
    double normal = 2.0 * conducts * du, tangent = of.at_side ? 0.0 : conducts * (dv + shear);
    if (body.share && !of.at_side) {
        const GradientStress gradient = gradient_stress(body, s, of, k);
        normal -= 2.0 * conducts * gradient.normal, tangent -= conducts * gradient.tangent;
    }
    faces.low[k] -= normal, faces.high[k] -= normal, faces.across[k] -= tangent;
    return of.counts ? (of.at_side ? 0.5 : 1.0) * (normal * du + tangent * dv) : 0.0;
}

/// The same of all faces of a tile's cells; after drains, which are of what water carries.
double add_viscosity(const WaterBody& body, const TilePart& part, Stage& s) {
    const Index last = kHalo + body.grid.nx() - part.i0, top = kHalo + body.grid.ny() - part.j0;
    double lost = 0.0;
    for (Index b = kHalo; b <= part.rows; ++b)
        for (Index a = kHalo; a <= part.columns; ++a) {
            const Index k = b * kRow + a;
            const bool east = a == last, west = part.i0 == 0 && a == kHalo;
            const bool north = b == top, south = part.j0 == 0 && b == kHalo;
            if (b < part.rows)
                lost += add_viscous(body, s, {s.block.u, s.block.v, 1, east || west, a < part.columns || east}, k, s.x);
            if (a < part.columns)
                lost +=
                    add_viscous(body, s, {s.block.v, s.block.u, kRow, north || south, b < part.rows || north}, k, s.y);
        }
    return lost;
}

/// What one stage changes in a cell.
struct Change {
    double h, qx, qy;
    Vec2 pressure_force;  ///< of it, what is not carried
};

Change change_of(const Stage& s, Index k, double cells) {
    const WaterFaces &x = s.x, &y = s.y;
    const double weight = s.block.normal_gravity[k] * s.block.depth[k];
    const Vec2 pressure_force = -cells * Vec2(x.low[k + 1] - x.high[k] + weight * s.across_x.surface[k],
                                              y.low[k + kRow] - y.high[k] + weight * s.across_y.surface[k]);
    return {-cells * (x.mass[k + 1] - x.mass[k] + y.mass[k + kRow] - y.mass[k]),
            pressure_force.x() - cells * (x.along[k + 1] - x.along[k] + y.across[k + kRow] - y.across[k]),
            pressure_force.y() - cells * (x.across[k + 1] - x.across[k] + y.along[k + kRow] - y.along[k]),
            pressure_force};
}

/// Energy over mass of water that leaves [m^2/s^2]. It is of its surface's height, which is pressure below it, and of
/// motion along the ground.
double head_of(const WaterBody& body, const WaterBlock& block, Index k) {
    const double u = block.u[k], v = block.v[k];
    const auto ground = [&](Index at) { return block.surface[at] - block.depth[at]; };
    const double up = body.steep ? 0.5 / body.grid.cell() *
                                       (u * (ground(k + 1) - ground(k - 1)) + v * (ground(k + kRow) - ground(k - kRow)))
                                 : 0.0;
    return body.gravity * block.surface[k] + 0.5 * (u * u + v * v + up * up);
}

/// One side of the grid in a tile's ledger: `k` is the face, `inside` the cell at it. What enters has the energy of the
/// lake beyond.
void accumulate_side(const WaterBody& body, const Stage& s, const WaterFaces& faces, const WaterSlopes& slopes, Index k,
                     Index inside, int axis, double outward, double cells, WaterLedger& ledger) {
    const double h = s.block.depth[inside] + 0.5 * outward * slopes.depth[inside];
    const double force = (outward > 0.0 ? faces.low[k] : faces.high[k]) + 0.5 * s.block.normal_gravity[inside] * h * h;
    const double out = outward * cells * faces.mass[k];
    ledger.walls[axis] -= outward * cells * force;
    (out > 0.0 ? ledger.left : ledger.entered) += std::abs(out);
    ledger.momentum_left[axis] += outward * cells * faces.along[k];
    ledger.momentum_left[1 - axis] += outward * cells * faces.across[k];
    const Index step = static_cast<Index>(outward) * (axis == 0 ? 1 : kRow);
    ledger.energy_out += out * head_of(body, s.block, out > 0.0 ? inside : inside + step);
}

/// All sides of the grid that a tile touches; in cells of unit area.
void accumulate_sides(const WaterBody& body, const TilePart& part, const Stage& s, double cells, WaterLedger& ledger) {
    const TileGrid& grid = body.grid;
    for (Index b = kHalo; b < part.rows; ++b) {
        const Index low = b * kRow + kHalo, high = b * kRow + part.columns;
        if (part.i0 == 0) accumulate_side(body, s, s.x, s.across_x, low, low, 0, -1.0, cells, ledger);
        if (part.i0 + kTile >= grid.nx())
            accumulate_side(body, s, s.x, s.across_x, high, high - 1, 0, 1.0, cells, ledger);
    }
    for (Index a = kHalo; a < part.columns; ++a) {
        const Index low = kHalo * kRow + a, high = part.rows * kRow + a;
        if (part.j0 == 0) accumulate_side(body, s, s.y, s.across_y, low, low, 1, -1.0, cells, ledger);
        if (part.j0 + kTile >= grid.ny())
            accumulate_side(body, s, s.y, s.across_y, high, high - kRow, 1, 1.0, cells, ledger);
    }
}

/// Slope of the bed at a node.
Vec2 bed_slope(const WaterBody& body, Index k) {
    const double per = 0.5 / body.grid.cell();
    return per *
           Vec2(body.bed[k + 1] - body.bed[k - 1], body.bed[k + body.grid.stride()] - body.bed[k - body.grid.stride()]);
}

/// The force on water of depth h and velocity v over steep ground that fluxes leave out, over the density [m^2/s^2].
/// THEORY, section 2. Where water would fly, its weight is none. `slope`: of the surface, as limited.
Vec2 steep_force(const WaterBody& body, Index k, double h, const Vec2& v, const Vec2& slope) {
    const double weight = std::max(0.0, body.gravity + body.curvature[k].rise(v));
    const double climbs = std::max(0.0, bed_slope(body, k).dot(slope));
    return h * (body.normal_gravity[k] - weight / (1.0 + climbs)) * slope;
}

/// Water of one cell.
struct Water {
    double h, qx, qy;
};

/// A cell among those around it, as a stage found them.
struct Place {
    const WaterBlock& block;
    Index k;
};

/// Bound of the speed on the map after a stage [m/s]. Nothing that reaches the cell is faster than a dam break's front, or
/// than its fall makes it.
double fastest_around(const WaterBody& body, const Place& of) {
    const WaterBlock& block = of.block;
    double most = 0.0;
    for (const Index at : {of.k, of.k - 1, of.k + 1, of.k - kRow, of.k + kRow}) {
        const double front =
            std::hypot(block.u[at], block.v[at]) + 2.0 * std::sqrt(block.normal_gravity[at] * block.depth[at]);
        const double fall = std::abs(block.surface[at] - block.surface[of.k]);
        most = std::max(most, front * front + 2.0 * body.gravity * fall);
    }
    return std::sqrt(most);
}

/// More than half of a cell's water has left in a stage.
[[gnu::always_inline]] inline bool runs_out(const Place& of, const Water& w) {
    return w.h < 0.5 * of.block.depth[of.k];
}

/// THEORY, section 3. Where nearly all of a cell's water leaves, the force of its pressure stays with what is left. `own`:
/// speed that the cell has had in this step already [m/s]. Returns the momentum that goes beyond the bound, over density
/// and area [m^2/s].
Vec2 bound_speed(const WaterBody& body, const Place& of, double own, Water& w) {
    const Vec2 before(w.qx, w.qy);
    const double most = w.h * std::max(own, fastest_around(body, of)), discharge = before.norm();
    if (discharge <= most) return Vec2(0, 0);
    const Vec2 after = most / discharge * before;
    w.qx = after.x(), w.qy = after.y();
    return before - after;
}

/// Runs a stage from fields on a tile: each(storage index, i, j, change, place) for its cells, and the half of what it
/// records.
template <class Each>
void run_stage(const WaterBody& body, const WaterFields& from, Index tile, double dt, WaterLedger& ledger,
               Each&& each) {
    const TilePart part = part_of(body.grid, tile);
    const double cells = dt / body.grid.cell();
    Stage s;
    s.first = body.grid.at(part.i0 - kHalo, part.j0 - kHalo);
    const bool moves = load_block(body, from, part, s.block);
    WaterLedger tile_ledger;
    if (moves) {
        find_faces(body, part, s);
        find_drains(part, cells, s);
        if (body.viscosity.kinematic > 0.0) tile_ledger.sheared += cells * add_viscosity(body, part, s);
        accumulate_sides(body, part, s, cells, tile_ledger);
    }
    for (Index b = kHalo; b < part.rows; ++b)
        for (Index a = kHalo; a < part.columns; ++a) {
            const Index i = part.i0 + a - kHalo, j = part.j0 + b - kHalo;
            const Index k = b * kRow + a;
            Change change = moves ? change_of(s, k, cells) : Change{0.0, 0.0, 0.0, Vec2(0, 0)};
            if (moves && body.curvature) {
                const Vec2 slope = 1.0 / body.grid.cell() * Vec2(s.across_x.surface[k], s.across_y.surface[k]);
                const Vec2 turned = dt * steep_force(body, body.grid.at(i, j), s.block.depth[k],
                                                     Vec2(s.block.u[k], s.block.v[k]), slope);
                change.qx += turned.x(), change.qy += turned.y(), change.pressure_force += turned;
            }
            tile_ledger.ground += change.pressure_force;
            each(body.grid.at(i, j), i, j, change, Place{s.block, k});
        }
    tile_ledger.ground -= tile_ledger.walls;
    ledger.add(tile_ledger, 0.5 * body.grid.cell() * body.grid.cell());
}

/// Something slows water at the bed.
bool brakes_of(const WaterBody& body) {
    return body.bed_laws || body.friction != WaterFriction::Law::none || body.viscosity.kinematic > 0.0;
}

/// Velocity at the start of the step, none of a film.
Vec2 velocity_before(const WaterBody& body, Index k) {
    const double h = body.now.h[k];
    return h > body.film ? Vec2(Vec2(body.now.qx[k], body.now.qy[k]) / h) : Vec2(0, 0);
}

/// A bed law's input of a cell that flows in a direction at a speed, on the map [m/s].
BedState seen_by_law(const WaterBody& body, Index k, double h, const Vec2& direction, double speed) {
    const double cosine = body.steep ? std::sqrt(body.normal_gravity[k] / body.gravity) : 1.0;
    const double along = body.steep ? direction.dot(bed_slope(body, k)) : 0.0, kappa = std::sqrt(1.0 + along * along);
    double weight = body.gravity;
    if (body.curvature) weight = std::max(0.0, weight + body.curvature[k].rise(speed * direction));
    return {weight * cosine / kappa, std::max(h * cosine, 1e-9), kappa, cosine, body.gravity, body.density};
}

/// Friction over a step, exact for a constant drive (law/friction_step.h), on water deeper than a film. Viscosity shears all
/// that stands on the bed, confined mass as well.
void brake(const WaterBody& body, Index k, double dt, Water& w) {
    const Vec2 q(w.qx, w.qy);
    const double discharge = q.norm();
    if (!brakes_of(body) || discharge == 0.0) return;
    const Vec2 direction = q / discharge;
    const double start = std::max(0.0, velocity_before(body, k).dot(direction));
    if (body.bed_laws) {
        const BedState seen = seen_by_law(body, k, w.h, direction, start);
        const double left = std::visit(
            [&](const auto& laws) { return laws[body.bed_law[k]].speed_after(seen, start, discharge / w.h, dt); },
            *body.bed_laws);
        w.qx = left * w.h * direction.x(), w.qy = left * w.h * direction.y();
        return;
    }
    WaterBed bed{body.gravity, w.h, 1.0};
    double whole = w.h + body.confined[k];
    if (body.steep) {
        const double along = direction.dot(bed_slope(body, k)),
                     cosine = std::sqrt(body.normal_gravity[k] / body.gravity);
        bed.thickness *= cosine, whole *= cosine, bed.kappa = std::sqrt(1.0 + along * along);
    }
    const double speed = braked_speed(start, discharge / w.h, linear_drag(body.viscosity, whole),
                                      quadratic_drag({body.friction, body.coefficient[k]}, bed), dt);
    w.qx = speed * w.h * direction.x(), w.qy = speed * w.h * direction.y();
}

/// Product of two velocities along the ground [m^2/s^2].
double along_ground(const WaterBody& body, Index k, const Vec2& a, const Vec2& b) {
    if (!body.steep) return a.dot(b);
    const Vec2 slope = bed_slope(body, k);
    return a.dot(b) + slope.dot(a) * slope.dot(b);
}

/// Energy of a depth that joins a cell with velocity v, recorded in cells of unit area. The depth comes onto the
/// surface, and both then share their momentum.
void join(const WaterBody& body, Index k, double added, const Vec2& v, Water& w, WaterLedger& ledger) {
    const double before = w.h;
    w.h += added;
    ledger.energy_out -= body.gravity * added * (body.bed[k] + body.confined[k] + before + 0.5 * added);
    if (before > body.film) {
        const Vec2 slip = Vec2(w.qx, w.qy) / before - v;
        ledger.braked += 0.5 * before * added / w.h * along_ground(body, k, slip, slip);
    }
}

/// What sources bring in the step. All of it comes on top. So the flux of a step is that of the water that was there.
void take_from_sources(const WaterBody& body, Index k, Water& w, WaterLedger& ledger) {
    const double added = body.fed[k];
    if (!(added > 0.0)) return;
    const Vec2 brought(body.fed_x[k], body.fed_y[k]), v = brought / added;
    join(body, k, added, v, w, ledger);
    w.qx += brought.x(), w.qy += brought.y();
    ledger.fed += added, ledger.momentum_left -= brought;
    ledger.energy_out -= 0.5 * added * along_ground(body, k, v, v);
}

/// Sources, rain and infiltration, recorded in cells of unit area. Rain falls onto the surface and takes up the speed of what
/// it falls into.
void feed_and_soak(const WaterBody& body, Index k, double dt, Water& w, WaterLedger& ledger) {
    if (body.fed) take_from_sources(body, k, w, ledger);
    if (body.rain) {
        const double rained = dt * body.rain[k];
        join(body, k, rained, Vec2(0, 0), w, ledger);
        ledger.rained += rained;
    }
    if (body.infiltration && w.h > 0.0) {
        const double taken = std::min(w.h, dt * body.infiltration[k]), kept = 1.0 - taken / w.h;
        const Vec2 v = w.h > body.film ? Vec2(Vec2(w.qx, w.qy) / w.h) : Vec2(0, 0);
        ledger.infiltrated += taken, ledger.momentum_infiltrated += (1.0 - kept) * Vec2(w.qx, w.qy);
        ledger.energy_out += taken * (body.gravity * (body.bed[k] + body.confined[k] + w.h - 0.5 * taken) +
                                      0.5 * along_ground(body, k, v, v));
        w.h -= taken, w.qx *= kept, w.qy *= kept;
    }
}

/// Friction's work is its impulse times the mean of the velocities at the start and at the end. What it holds at rest or at
/// one speed loses no more than it falls. In cells of unit area.
void record_friction(const WaterBody& body, Index k, const Vec2& taken, const Water& w, WaterLedger& ledger) {
    const Vec2 after = w.h > body.film ? Vec2(Vec2(w.qx, w.qy) / w.h) : Vec2(0, 0);
    ledger.friction -= taken;
    ledger.braked += 0.5 * along_ground(body, k, taken, velocity_before(body, k) + after);
}

/// Sources, rain, infiltration and friction at the end of a step, recorded in cells of unit area.
void finish_cell(const WaterBody& body, Index k, double dt, Water& w, WaterLedger& ledger) {
    if (body.rain || body.infiltration || body.fed) feed_and_soak(body, k, dt, w, ledger);
    const Vec2 driven(w.qx, w.qy);
    if (w.h > body.film)
        brake(body, k, dt, w);
    else
        w.qx = w.qy = 0.0;
    const Vec2 taken = driven - Vec2(w.qx, w.qy);
    if (taken.x() != 0.0 || taken.y() != 0.0) record_friction(body, k, taken, w, ledger);
}

/// Which tiles water in cell (i, j) of a tile is near: it reaches two cells in a step.
std::uint16_t near_of(Index i, Index j) {
    constexpr Index kReach = 3;
    const auto towards = [](Index n) { return n < kReach ? -1 : n >= kTile - kReach ? 1 : 0; };
    const int di = towards(i), dj = towards(j);
    const auto bit = [](int x, int y) { return static_cast<std::uint16_t>(1 << (3 * (y + 1) + x + 1)); };
    return static_cast<std::uint16_t>(bit(0, 0) | bit(di, 0) | bit(0, dj) | bit(di, dj));
}

/// Speed of the waves that come in from the lakes beyond the sides that a cell is at [m/s]. Those of water that flows in
/// run on it.
double waves_of_lakes(const WaterBody& body, Index k, Index i, Index j, const Water& w) {
    const double g = body.normal_gravity[k], per = w.h > body.film ? 1.0 / w.h : 0.0;
    double fastest = 0.0;
    const auto from = [&](std::size_t side, bool here, double out) {
        if (!here || body.sides[side] == WaterSide::wall) return;
        const double lake = body.lakes[side] - body.bed[k];
        if (!(lake > 0.0)) return;
        const bool held = body.sides[side] == WaterSide::level;
        const AtSide comes = held ? at_side(per > 0.0 ? w.h : 0.0, per * out, lake, g) : AtSide{lake, 0.0};
        fastest = std::max({fastest, std::sqrt(g * lake), std::sqrt(g * comes.depth) - comes.out});
    };
    from(0, i == 0, -w.qx), from(1, i == body.grid.nx() - 1, w.qx);
    from(2, j == 0, -w.qy), from(3, j == body.grid.ny() - 1, w.qy);
    return fastest;
}

/// Counts the cell at node (i, j), stored at k.
void count(const WaterBody& body, Index k, Index i, Index j, const Water& w, WaterSums& sums) {
    sums.signal = std::max(sums.signal, waves_of_lakes(body, k, i, j, w));
    if (!(w.h > 0.0)) {
        if (w.h != 0.0) sums.bad = k;  // negative, or not a number
        return;
    }
    sums.volume += w.h;
    sums.near |= std::uint16_t{1} << 4;
    sums.momentum += Vec2(w.qx, w.qy);  // of films too, which columns may have given some
    if (w.h <= body.film) return;
    const double u = w.qx / w.h, v = w.qy / w.h, c = std::sqrt(body.normal_gravity[k] * w.h);
    if (!std::isfinite(u + v + w.h)) sums.bad = k;
    sums.kinetic += 0.5 * (w.qx * u + w.qy * v);
    sums.max_speed2 = std::max(sums.max_speed2, u * u + v * v);
    sums.signal = std::max(sums.signal, std::max(std::abs(u), std::abs(v)) + c);
    sums.near |= near_of(i % kTile, j % kTile);
}

void scale(WaterSums& sums, double area) { sums.volume *= area, sums.momentum *= area, sums.kinetic *= area; }

template <class Body>
void for_each_listed_tile(const WaterBody& body, Body&& each) {
    const Index count = static_cast<Index>(body.work.size());
#pragma omp parallel for schedule(dynamic, 1) if (count >= kTilesForThreads)
    for (Index n = 0; n < count; ++n) each(static_cast<std::size_t>(n), body.work[static_cast<std::size_t>(n)]);
}

/// Of a cell's speeds at the start of a step and after the first stage, before friction [m/s].
double fastest_so_far(const WaterBody& body, Index k, const Vec2& driven) {
    const double h = body.half.h[k];
    return std::max(velocity_before(body, k).norm(), h > body.film ? driven.norm() / h : 0.0);
}

}  // namespace

/// The second stage's fluxes are those of water that friction has slowed. On a slope it would otherwise run too far, by
/// half of what gravity gives it in a step.
void first_stage(WaterBody& body, double dt) {
    const bool brakes = brakes_of(body);
    const double area = body.grid.cell() * body.grid.cell();
    for_each_listed_tile(body, [&](std::size_t n, Index tile) {
        body.sums[n] = WaterSums{};
        WaterLedger beyond;
        const auto each = [&](Index k, Index, Index, const Change& change, const Place& place) {
            Water w{body.now.h[k] + change.h, body.now.qx[k] + change.qx, body.now.qy[k] + change.qy};
            if (runs_out(place, w)) {
                const Vec2 taken = bound_speed(body, place, velocity_before(body, k).norm(), w);
                record_friction(body, k, taken, w, beyond);
            }
            if (brakes) {
                body.driven_x[k] = w.qx, body.driven_y[k] = w.qy;
                if (w.h > body.film) brake(body, k, dt, w);
            }
            body.half.h[k] = w.h, body.half.qx[k] = w.qx, body.half.qy[k] = w.qy;
        };
        run_stage(body, body.now, tile, dt, body.sums[n].ledger, each);
        body.sums[n].ledger.add(beyond, 0.5 * area);
    });
}

void second_stage(WaterBody& body, double dt) {
    const bool brakes = brakes_of(body);
    const double *driven_x = (brakes ? body.driven_x : body.half.qx).data(),
                 *driven_y = (brakes ? body.driven_y : body.half.qy).data();
    const double area = body.grid.cell() * body.grid.cell();
    for_each_listed_tile(body, [&](std::size_t n, Index tile) {
        WaterSums& sums = body.sums[n];
        WaterLedger ends;
        const auto each = [&](Index k, Index i, Index j, const Change& change, const Place& place) {
            const auto mean = [&](double start, double half, double by) { return 0.5 * (start + (half + by)); };
            Water w{mean(body.now.h[k], body.half.h[k], change.h), mean(body.now.qx[k], driven_x[k], change.qx),
                    mean(body.now.qy[k], driven_y[k], change.qy)};
            if (runs_out(place, w)) {
                const Vec2 taken = bound_speed(body, place, fastest_so_far(body, k, {driven_x[k], driven_y[k]}), w);
                record_friction(body, k, taken, w, ends);
            }
            finish_cell(body, k, dt, w, ends);
            count(body, k, i, j, w, sums);
            body.now.h[k] = w.h, body.now.qx[k] = w.qx, body.now.qy[k] = w.qy;
        };
        run_stage(body, body.half, tile, dt, sums.ledger, each);
        sums.ledger.add(ends, area);
        scale(sums, area);
    });
}

WaterSums tile_sums(const WaterBody& body, Index tile) {
    WaterSums sums;
    const Index i0 = body.grid.tile_i(tile), j0 = body.grid.tile_j(tile);
    for (Index j = j0; j < std::min(j0 + kTile, body.grid.ny()); ++j)
        for (Index i = i0; i < std::min(i0 + kTile, body.grid.nx()); ++i) {
            const Index k = body.grid.at(i, j);
            count(body, k, i, j, {body.now.h[k], body.now.qx[k], body.now.qy[k]}, sums);
        }
    scale(sums, body.grid.cell() * body.grid.cell());
    return sums;
}

}  // namespace frana
