#include "coupling/solid_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "base/error.h"
#include "coupling/barriers.h"
#include "coupling/bed_friction.h"
#include "scene/stage_reach.h"

namespace frana {
namespace {

/// Lowest and highest ground in the window and two nodes around it, where points still are.
std::pair<double, double> ground_of(const Scene& scene) {
    const std::array<Index, 4>& w = scene.solid->window;
    const GridGeometry& g = scene.bed.geometry;
    double low = INFINITY, high = -INFINITY;
    for (Index j = std::max<Index>(0, w[1] - 2); j <= std::min(g.ny - 1, w[3] + 2); ++j)
        for (Index i = std::max<Index>(0, w[0] - 2); i <= std::min(g.nx - 1, w[2] + 2); ++i)
            if (const double z = scene.bed.at(i, j); std::isfinite(z)) low = std::min(low, z), high = std::max(high, z);
    expect(low <= high, "a window has ground");
    return {low, high};
}

/// Ground where it is unknown, outside the window. It is that of the neighbour before it in the row or the column. For
/// what is left it is that behind it.
Raster without_gaps(Raster bed) {
    const Index nx = bed.geometry.nx, ny = bed.geometry.ny;
    const auto take = [&](Index i, Index j, Index di, Index dj) {
        if (std::isfinite(bed.at(i, j)) || i + di < 0 || j + dj < 0 || i + di >= nx || j + dj >= ny) return;
        if (std::isfinite(bed.at(i + di, j + dj))) bed.at(i, j) = bed.at(i + di, j + dj);
    };
    for (int round = 0; round < 2; ++round) {
        for (Index j = 0; j < ny; ++j)
            for (Index i = 0; i < nx; ++i) take(i, j, -1, 0), take(i, j, 0, -1);
        for (Index j = ny - 1; j >= 0; --j)
            for (Index i = nx - 1; i >= 0; --i) take(i, j, 1, 0), take(i, j, 0, 1);
    }
    return bed;
}

/// As stiff as makes sound so fast; sand by the bed as strong as the bed's friction.
SolidLaw law_of(const SolidStage& stage, double density, const SolidStart& start) {
    const double modulus = density * start.sound_speed * start.sound_speed;
    constexpr double kPoisson = 0.3;  // as sand by its own keys has
    SolidLaw law = stage.law;
    std::visit(
        [&](auto& chosen) {
            if constexpr (std::decay_t<decltype(chosen)>::kAverages)  // fluids
                chosen.bulk = modulus;
        },
        law);
    if (auto* grains = std::get_if<solid::MuI>(&law)) {
        grains->density = density;
        if (stage.of_bed) grains->elastic = solid::Elastic::of_sound(modulus, kPoisson);
        return law;
    }
    if (!stage.of_bed) return law;
    return solid::DruckerPrager::of(solid::Elastic::of_sound(modulus, kPoisson), std::atan(start.friction), 0.0);
}

/// Cells that a 3D grid has beyond a side. At walls the nodes of points and mirror particles then exist. At open
/// sides they are as many as a point needs, so that it leaves where the side is (solid_kernel.cpp).
constexpr double kBehindWalls = 3.0, kAtOpenSides = 0.5;

}  // namespace

std::array<double, 4> window_of(const Scene& scene) {
    const GridGeometry& g = scene.bed.geometry;
    const std::array<Index, 4>& w = scene.solid->window;
    const double half = 0.5 * g.cell;
    return {std::max(g.x0, g.x(w[0]) - half), std::max(g.y0, g.y(w[1]) - half), std::min(g.x_max(), g.x(w[2]) + half),
            std::min(g.y_max(), g.y(w[3]) + half)};
}

std::array<double, 4> reach_of(const Scene& scene) {
    std::array<double, 4> reach = window_of(scene);
    for (std::size_t side = 0; side < 4; ++side)
        if (!scene.solid->closed[side]) reach[side] += (side < 2 ? -0.5 : 0.5) * scene.bed.geometry.cell;
    return reach;
}

namespace {

/// 1 at nodes i0, j0 to i1, j1 of the terrain.
std::vector<std::uint8_t> marked(const GridGeometry& g, const std::array<Index, 4>& box) {
    std::vector<std::uint8_t> marks(static_cast<std::size_t>(g.size()), 0);
    for (Index j = std::max<Index>(0, box[1]); j <= std::min(g.ny - 1, box[3]); ++j)
        for (Index i = std::max<Index>(0, box[0]); i <= std::min(g.nx - 1, box[2]); ++i)
            marks[static_cast<std::size_t>(j * g.nx + i)] = 1;
    return marks;
}

}  // namespace

std::vector<std::uint8_t> nodes_in_window(const Scene& scene) {
    return marked(scene.bed.geometry, scene.solid->window);
}

std::vector<std::uint8_t> nodes_at_edge(const Scene& scene) {
    const Index more = reach_around(*scene.solid, scene.bed.geometry.cell);
    std::array<Index, 4> box = scene.solid->window;
    for (std::size_t side = 0; side < 4; ++side)
        if (!scene.solid->closed[side]) box[side] += side < 2 ? -more : more;
    return marked(scene.bed.geometry, box);
}

namespace {

/// Of a particle along the bed [m^2/s^2].
double squared_speed(const FlowParticles& particles, std::size_t k) {
    const double climb = particles.vx[k] * particles.slope_x[k] + particles.vy[k] * particles.slope_y[k];
    return particles.vx[k] * particles.vx[k] + particles.vy[k] * particles.vy[k] + climb * climb;
}

/// The square of the speed that a particle has once it has fallen to the lowest ground, `low`.
double squared_speed_below(const Scene& scene, const FlowParticles& particles, std::size_t k, double low) {
    return squared_speed(particles, k) +
           2.0 * scene.gravity * std::max(0.0, particles.bed[k] + particles.depth[k] - low);
}

/// What brakes the particles at the bed, or will as they speed up: until friction is the slope, or until they are down. It
/// is a mean by mass. A film at the margin, which drag brakes most, says nothing of what the flow needs inside.
double mean_friction(const Scene& scene, const FlowParticles& particles, double low) {
    constexpr double kSteepest = 1.0;  // no sand stands steeper than 45 degrees
    double sum = 0.0, mass = 0.0;
    for (std::size_t k = 0; k < particles.count(); ++k) {
        const double slope = std::hypot(particles.slope_x[k], particles.slope_y[k]);
        const Vec2 place{particles.x[k], particles.y[k]};
        FlowMap::Mean flow{particles.depth[k], std::sqrt(squared_speed(particles, k)), 1.0 / std::hypot(1.0, slope)};
        const double now = friction_of_flow(scene, place, flow);
        flow.speed = std::sqrt(squared_speed_below(scene, particles, k, low));
        const double later = std::min(slope, friction_of_flow(scene, place, flow));
        sum += particles.mass[k] * std::min(std::max(now, later), kSteepest);
        mass += particles.mass[k];
    }
    return mass > 0.0 ? sum / mass : 0.0;
}

/// The largest friction at rest of a node in the window. Where the bed brakes more than sand does inside, sand would
/// shear above the bed, whatever friction a zone has.
double largest_at_rest(const Scene& scene) {
    if (!scene.bed_laws()) return friction_at_rest(scene.bed_law);
    const std::array<Index, 4>& w = scene.solid->window;
    double largest = 0.0;
    for (Index j = w[1]; j <= w[3]; ++j)
        for (Index i = w[0]; i <= w[2]; ++i) {
            const auto node = static_cast<std::size_t>(j * scene.bed.geometry.nx + i);
            largest = std::max(largest, friction_at_rest(scene.bed_laws()->at(node)));
        }
    return largest;
}

/// Of sand that has the bed's friction.
double friction_inside(const Scene& scene, const FlowParticles& particles, double low) {
    const double at_bed = scene.solid->whole_bed_law ? mean_friction(scene, particles, low) : scene.solid->bed_friction;
    return std::max(largest_at_rest(scene), at_bed);
}

/// The speed that a particle's whole weight, as shear at the bed, gives a fluid or mud [m/s]. It is `fall` at most, the
/// speed that the way down gives.
double own_speed(const SolidLaw& law, double density, double gravity, double depth, double fall) {
    const auto of = [&](double viscosity, double yield_stress) {
        const double sheared = std::max(0.0, density * gravity * depth - yield_stress) * depth;
        return sheared < 3.0 * viscosity * fall ? sheared / (3.0 * viscosity) : fall;
    };
    if (const auto* fluid = std::get_if<solid::Fluid>(&law)) return of(fluid->viscosity, 0.0);
    if (const auto* mud = std::get_if<solid::Bingham>(&law)) return of(mud->viscosity, mud->yield_stress);
    return fall;
}

/// Means by mass of depth and speed. `low`: elevation of the lowest ground.
void add_means(const Scene& scene, const FlowParticles& particles, double low, SolidStart& start) {
    double mass = 0.0;
    for (std::size_t k = 0; k < particles.count(); ++k) {
        const double v2 = squared_speed(particles, k), depth = particles.depth[k];
        const double fall = std::sqrt(squared_speed_below(scene, particles, k, low));
        const double own = own_speed(scene.solid->law, scene.density, scene.gravity, depth, fall);
        mass += particles.mass[k];
        start.depth += particles.mass[k] * depth;
        start.speed += particles.mass[k] * std::max(std::sqrt(v2), own);
    }
    if (mass > 0.0) start.depth /= mass, start.speed /= mass;
}

}  // namespace

double resolving_cell(const SolidLaw& law, double density, double depth, double speed) {
    const double shear_rate = depth > 0.0 ? 3.0 * speed / depth : 0.0;  // at the bed, of a parabola
    if (!(shear_rate > 0.0)) return std::numeric_limits<double>::infinity();
    double stress = 0.0;
    if (const auto* fluid = std::get_if<solid::Fluid>(&law)) stress = fluid->viscosity * shear_rate;
    if (const auto* mud = std::get_if<solid::Bingham>(&law)) stress = mud->yield_stress + mud->viscosity * shear_rate;
    if (const auto* mud = std::get_if<solid::HerschelBulkley>(&law))
        stress = mud->yield_stress + mud->consistency * std::pow(shear_rate, mud->exponent);
    if (!(stress > 0.0)) return std::numeric_limits<double>::infinity();
    constexpr double kNearest = 0.75;  // of the distance that is seen of a profile [cells]: MirrorBatch::add
    return std::sqrt(stress / density) / (kNearest * shear_rate);
}

SolidStart choose_start(const Scene& scene, const FlowParticles& particles) {
    double fastest = 0.0, head = -INFINITY, deepest = scene.solid->cell;
    for (std::size_t k = 0; k < particles.count(); ++k) {
        const double v2 = squared_speed(particles, k);
        fastest = std::max({fastest, std::sqrt(v2), std::sqrt(2.0 * scene.gravity * particles.depth[k])});
        deepest = std::max(deepest, particles.depth[k]);
        head = std::max(head, particles.bed[k] + particles.depth[k] + 0.5 * v2 / scene.gravity);
    }
    const auto [low, high] = ground_of(scene);
    SolidStart start;
    start.friction = friction_inside(scene, particles, low);
    start.sound_speed = scene.solid->sound_speed.value_or(10.0 * std::max(fastest, 0.1));
    constexpr double kRoom = 8.0;    // cells above the ground at least
    constexpr double kSplash = 4.0;  // jets that a wall throws up rise to several times the energy of their flow
    start.top = scene.solid->top.value_or(std::max(low + kSplash * (head - low), high + kRoom * scene.solid->cell));
    add_means(scene, particles, low, start);
    start.stuck = scene.solid->stuck ||
                  (scene.solid->stuck_where_resolved &&
                   scene.solid->cell <= resolving_cell(scene.solid->law, scene.density, start.depth, start.speed));
    constexpr double kTransits = 20.0;
    const SolidLaw law = law_of(*scene.solid, scene.density, start);
    start.blur =
        kTransits * deepest / std::visit([&](const auto& chosen) { return chosen.sound_speed(scene.density); }, law);
    return start;
}

SolidScene solid_scene(const Scene& scene, const SolidStart& start) {
    const SolidStage& stage = *scene.solid;
    const GridGeometry& g = scene.bed.geometry;
    const std::array<double, 4> window = window_of(scene);
    SolidScene result;
    result.grid.cell = stage.cell;
    double high[3];
    const char* const names[] = {"west", "south", "east", "north"};
    for (int axis = 0; axis < 2; ++axis) {
        const auto first = static_cast<std::size_t>(axis), last = first + 2;
        const auto room = [&](std::size_t side) {
            return stage.closed[side] ? kBehindWalls * stage.cell : g.cell + kAtOpenSides * stage.cell;
        };
        result.grid.origin[axis] = window[first] - room(first);
        high[axis] = window[last] + room(last);
        for (const std::size_t side : {first, last}) {
            if (!stage.closed[side]) continue;
            Vec3 normal = Vec3::Zero(), at = Vec3::Zero();
            normal[axis] = side == first ? 1.0 : -1.0;
            at[axis] = window[side];
            result.surfaces.push_back(stage.mirrors[side] ? Surface::symmetry_plane(at, normal)
                                                          : Surface::plane(at, normal));
            result.surfaces.back().name = names[side];
        }
    }
    result.grid.origin[2] = ground_of(scene).first - kBehindWalls * stage.cell;
    high[2] = start.top + kAtOpenSides * stage.cell;
    for (int axis = 0; axis < 3; ++axis)
        result.grid.nodes[static_cast<std::size_t>(axis)] =
            static_cast<Index>(std::ceil((high[axis] - result.grid.origin[axis]) / stage.cell)) + 1;
    Surface ground = Surface::ground(without_gaps(scene.bed), start.stuck ? Hold::stuck : Hold::free,
                                     start.stuck ? 0.0 : stage.bed_friction);
    ground.name = "ground";
    result.surfaces.insert(result.surfaces.begin(), std::move(ground));
    for (const Barrier& barrier : scene.barriers) result.surfaces.push_back(surface_of(barrier, scene.bed, stage.cell));
    result.gravity = {0.0, 0.0, -scene.gravity};
    result.density = scene.density;
    result.law = law_of(stage, scene.density, start);
    result.affine = stage.transfer == Transfer::apic ? Affine::apic : Affine::tpic;
    result.flip = stage.transfer == Transfer::flip;
    result.blending = stage.blending;
    result.cfl = stage.cfl;
    result.split = stage.split;
    return result;
}

}  // namespace frana
