#include "checks/fuzz/facts.h"

#include <algorithm>
#include <cmath>

#include "base/compensated_sum.h"
#include "checks/fuzz/snapshot.h"
#include "coupling/staged_run.h"
#include "coupling/structured_run.h"
#include "shallow/depth_averaged.h"
#include "terrain/places.h"

namespace frana::fuzz {
namespace {

/// What the bed's curvature is against the scheme's steps and the flow's depth; zero on gentle terrain, which has none.
struct Bends {
    double unresolved = 0.0;  ///< largest change of slope from node to node that the Hessian does not account for [1]
    double sharpest = 0.0;    ///< largest entry of the Hessian [1/m]
};

Bends bends_of(const Flow& flow) {
    Bends worst;
    if (!flow.steep) return worst;
    const bool bent = flow.bed.hxx.count() > 0;
    const Index up = flow.grid.stride();
    for (Index j = 0; j < flow.grid.ny(); ++j)
        for (Index i = 0; i < flow.grid.nx(); ++i) {
            const Index k = flow.grid.at(i, j);
            const auto sample = [&](Index step, double hessian) {
                const double* z = flow.bed.z.data() + k;
                const double bend = (z[step] - 2.0 * z[0] + z[-step]) / flow.cell;
                worst.unresolved = std::max(worst.unresolved, std::abs(bend - hessian * flow.cell));
                worst.sharpest = std::max(worst.sharpest, std::abs(hessian));
            };
            sample(1, bent ? flow.bed.hxx[k] : 0.0);
            sample(up, bent ? flow.bed.hyy[k] : 0.0);
        }
    return worst;
}

/// What the depth on the nodes could set free [J].
double depth_energy(const Flow& flow) {
    CompensatedSum sum;
    for (const Index tile : flow.active.work)
        for_each_node_of(flow.grid, tile, flow.in_reach[tile], [&](Index k, Index i, Index j) {
            const double h = flow.nodes.depth[k];
            sum.add(0.5 * flow.share(i, j) * flow.density * flow.area * flow.gravity * h * h);
        });
    return sum.value();
}

constexpr double kSmooth = 0.02, kThin = 0.1;  // slope a cell; depth over radius of curvature

/// The bed as the depth-averaged flow has it.
void learn_bed(const Scene& scene, const Flow& flow, Facts& facts) {
    facts.walls = flow.walls;
    facts.steep = flow.steep;
    double steepest2 = 0.0;
    for (Index j = 0; j < flow.grid.ny(); ++j)
        for (Index i = 0; i < flow.grid.nx(); ++i) {
            const Index k = flow.grid.at(i, j);
            const double bx = flow.bed.slope_x[k], by = flow.bed.slope_y[k];
            steepest2 = std::max(steepest2, bx * bx + by * by);
            for (const Index step : {Index{1}, flow.grid.stride()}) {
                const double* z = flow.bed.z.data() + k;
                facts.one_cell_drop = std::max(facts.one_cell_drop, std::abs(z[step] - z[0]));
                facts.one_cell_bend = std::max(facts.one_cell_bend, std::abs(z[step] - 2.0 * z[0] + z[-step]));
            }
        }
    const Bends bends = bends_of(flow);
    facts.energy_law = bends.unresolved < kSmooth && bends.sharpest * facts.release_depth < kThin &&
                       scene.terrain != TerrainModel::linearised && !scene.scheme.paper_pressure;
    facts.turn = bends.sharpest * flow.cell;
    if (facts.steep) facts.steepest = std::sqrt(steepest2);
    if (!facts.energy_law && facts.steep) facts.stretch = std::sqrt(1.0 + steepest2);
    // Stiff mud takes back in a step nearly all that weight and pressure give it.
    facts.cancels = facts.cancels || std::holds_alternative<bed::Bingham>(scene.bed_law);
}

/// The same as structured particles and water have it: no Hessian bends their paths.
void learn_bed(const Raster& bed, Facts& facts) {
    const GridGeometry& g = bed.geometry;
    double steepest = 0.0;
    const auto sample = [&](double behind, double here, double ahead) {
        const double up = ahead - here, down = here - behind;
        for (const double rise : {up, down})
            if (std::isfinite(rise)) facts.one_cell_drop = std::max(facts.one_cell_drop, std::abs(rise));
        if (std::isfinite(up - down)) facts.one_cell_bend = std::max(facts.one_cell_bend, std::abs(up - down));
        const double across = std::isfinite(up) && std::isfinite(down) ? 0.5 * (up + down)
                              : std::isfinite(up)                      ? up
                                                                       : down;
        if (std::isfinite(across)) steepest = std::max(steepest, std::abs(across) / g.cell);
    };
    const auto at = [&](Index i, Index j) {
        return i < 0 || j < 0 || i >= g.nx || j >= g.ny ? Raster::nodata : bed.at(i, j);
    };
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) {
            sample(at(i - 1, j), at(i, j), at(i + 1, j));
            sample(at(i, j - 1), at(i, j), at(i, j + 1));
        }
    facts.steepest = std::sqrt(2.0) * steepest;  // along both axes at once, at most
    facts.energy_law = facts.one_cell_bend / g.cell < kSmooth;
    if (!facts.energy_law) facts.stretch = std::hypot(1.0, facts.steepest);
}

void learn_release(const Scene& scene, Facts& facts) {
    for (Index p = 0; p < scene.particles.count(); ++p) {
        const auto n = static_cast<std::size_t>(p);
        const double depth = scene.particles.depth[n], mass = scene.density * scene.particles.volume[n];
        facts.release_depth = std::max(facts.release_depth, depth);
        facts.release_energy += 0.5 * mass * scene.gravity * depth;
    }
}

/// Of nodes around a place: lines that are drawn are eight cells long at most [m].
double highest_around(const Raster& bed, const Vec2& at) {
    constexpr Index kAround = 8;
    const GridGeometry& g = bed.geometry;
    const NodeAt middle = nearest_node(g, at);
    double highest = -std::numeric_limits<double>::infinity();
    for (Index j = std::max<Index>(0, middle.j - kAround); j <= std::min(g.ny - 1, middle.j + kAround); ++j)
        for (Index i = std::max<Index>(0, middle.i - kAround); i <= std::min(g.nx - 1, middle.i + kAround); ++i)
            if (std::isfinite(bed.at(i, j))) highest = std::max(highest, bed.at(i, j));
    return highest;
}

/// What comes in counts as if it had been there.
void learn_inflows(const Scene& scene, Facts& facts) {
    for (const Inflow& inflow : scene.inflows) {
        double highest = -std::numeric_limits<double>::infinity(), deepest = 0.0, volume = 0.0;
        for (const Vec2& corner : inflow.line) highest = std::max(highest, highest_around(scene.bed, corner));
        for (std::size_t n = 0; n < inflow.time.size(); ++n) {
            const double speed = inflow.speed[n];
            facts.inflow_speed = std::max(facts.inflow_speed, std::hypot(1.0, facts.steepest) * speed);
            if (speed > 0.0) deepest = std::max(deepest, inflow.discharge[n] / (speed * inflow.width()));
            if (n > 0)
                volume += 0.5 * (inflow.discharge[n] + inflow.discharge[n - 1]) * (inflow.time[n] - inflow.time[n - 1]);
        }
        for (const Inflow::Patch& patch : inflow.patches)
            highest = std::max(highest, highest_around(scene.bed, patch.at));
        if (inflow.area > 0.0) deepest = volume / inflow.area;  // if none of it flowed off
        facts.release_depth = std::max(facts.release_depth, deepest);
        facts.highest_inflow = std::max(facts.highest_inflow, highest + deepest);
        facts.release_energy +=
            scene.density * volume * (0.5 * scene.gravity * deepest + 0.5 * facts.inflow_speed * facts.inflow_speed);
    }
}

/// As inflows do.
void learn_late(const Scene& scene, Facts& facts) {
    for (const LateRelease& release : scene.late) {
        const Seeds& seeds = release.seeds;
        for (std::size_t p = 0; p < seeds.x.size(); ++p) {
            const double depth = seeds.depth[p], mass = scene.density * seeds.volume[p];
            const double speed = std::hypot(1.0, facts.steepest) * std::hypot(seeds.vx[p], seeds.vy[p]);
            facts.inflow_speed = std::max(facts.inflow_speed, speed);
            facts.release_depth = std::max(facts.release_depth, depth);
            facts.release_energy += mass * (0.5 * scene.gravity * depth + 0.5 * speed * speed);
            facts.highest_inflow =
                std::max(facts.highest_inflow, highest_around(scene.bed, {seeds.x[p], seeds.y[p]}) + depth);
        }
    }
}

/// A bed that sinks may become steeper, and bends that no Hessian of the start has.
void learn_erodible(const ErodibleBed& bed, const Flow& flow, Facts& facts) {
    facts.erodes = true;
    facts.bed_energy = facts.energy_law, facts.energy_law = false;
    const double deepest = *std::max_element(bed.depth.values.begin(), bed.depth.values.end());
    if (bed.evolves) facts.loose = deepest;
    // What swells, or comes from ground that stays, lifts the surface.
    facts.release_depth += std::max(0.0, deepest * bed.density / flow.density - facts.loose);
    if (!facts.steep) return;
    facts.steepest += 2.0 * facts.loose / flow.cell;
    facts.stretch = std::hypot(1.0, facts.steepest);
}

/// A bed that falls where a release goes becomes as steep as its edge.
void learn_scars(const Scene& scene, const Flow& flow, Facts& facts) {
    if (!scene.cuts_later()) return;
    facts.bed_energy = facts.energy_law = false;
    double deepest = 0.0;  // where all of them lie on one another
    for (const LateRelease& release : scene.late) {
        double depth = 0.0;
        for (const ScarNode& node : release.scar) depth = std::max(depth, node.depth);
        deepest += depth;
    }
    if (!facts.steep) return;
    facts.steepest += 2.0 * deepest / flow.cell;
    facts.stretch = std::hypot(1.0, facts.steepest);
}

/// A bed that rises may become as steep as a deposit's own margin, and later flow falls from it.
void learn_deposition(const Flow& flow, Facts& facts) {
    facts.erodes = true;
    facts.bed_energy = facts.bed_energy || facts.energy_law, facts.energy_law = false;
    if (!facts.steep) return;
    facts.steepest += 2.0 * facts.release_depth / flow.cell;
    facts.stretch = std::hypot(1.0, facts.steepest);
}

void learn_particles(const Scene& scene, const Flow& flow, Facts& facts) {
    learn_bed(scene, flow, facts);
    if (scene.erodible) learn_erodible(*scene.erodible, flow, facts);
    learn_inflows(scene, facts);
    learn_late(scene, facts);
    learn_scars(scene, flow, facts);
    if (scene.deposition || scene.forest) learn_deposition(flow, facts);
    if (scene.still_surface) {
        facts.lake = true;
        facts.level_error = off_level(flow, *scene.still_surface);
        facts.level_round_off =
            16.0 * std::numeric_limits<double>::epsilon() * (std::abs(*scene.still_surface) + facts.release_depth);
    }
    const Transfer transfer = scene.scheme.transfer;
    facts.affine = transfer == Transfer::tpic || transfer == Transfer::apic;
    facts.linear = scene.scheme.shape == Shape::linear;
    facts.carried_depth = scene.scheme.paper_pressure;
    facts.hidden_energy = std::max(0.0, facts.release_energy - depth_energy(flow));
}

/// No particle ever stands in such a run. There are points from the start, and they may leave only where particles
/// cannot stand.
bool is_all_in_3d(const Scene& scene) {
    const std::array<Index, 4>& w = scene.solid->window;
    const GridGeometry& g = scene.bed.geometry;
    return scene.solid->from == 0.0 && !scene.solid->until && w[0] == 0 && w[1] == 0 && w[2] == g.nx - 1 &&
           w[3] == g.ny - 1;
}

/// What particles have on nodes is no excuse for 3D points.
void forget_particles(Facts& facts) {
    facts.energy_law = true, facts.stretch = 1.0;
    facts.linear = facts.carried_depth = false;
    facts.turn = facts.hidden_energy = facts.steepest = facts.one_cell_drop = facts.one_cell_bend = 0.0;
}

void learn_water(const Scene& scene, Facts& facts) {
    facts.all_in_points = false;
    facts.virtual_mass = scene.water->exchange.virtual_mass != VirtualMass::none;
    if (scene.water->level) {
        double volume = 0.0;
        for (const double of : scene.particles.volume) volume += of;
        facts.displaces = scene.water->exchange.material.fluid_density * scene.gravity * volume;
        facts.bears = scene.water->exchange.pore_pressure;
    }
    learn_inflows(scene, facts);
    // A cell that nothing flows into has dh/dt = -h u / cell. So it runs out to a film on a way of ln(h / film) cells.
    facts.drained_drop = facts.one_cell_drop * std::max(0.0, std::log(facts.release_depth / WaterScene().film));
    for (const WaterPhase::Side& side : scene.water->sides)  // water comes in from so high
        if (side.is == WaterPhase::Side::Is::level) facts.highest_rain = std::max(facts.highest_rain, side.level);
    if (scene.water->rain.values.empty()) return;
    for (const double z : scene.bed.values) facts.highest_rain = std::max(facts.highest_rain, z);
}

}  // namespace

Facts facts_of(const Scene& scene, const Simulation& simulation, const Claims& claims) {
    Facts facts;
    facts.claims = claims;
    facts.gravity = scene.gravity;
    facts.density = scene.density;
    facts.cell = scene.bed.geometry.cell;
    facts.nodes_x = scene.bed.geometry.nx, facts.nodes_y = scene.bed.geometry.ny;
    learn_release(scene, facts);
    if (const DepthAveraged* particles = particles_of(simulation)) {
        learn_particles(scene, particles->flow(), facts);
    } else if (const auto* staged = dynamic_cast<const StagedRun*>(&simulation)) {
        facts.in_3d = facts.cancels = true, facts.all_in_points = false;
        facts.cell_3d = scene.solid->cell;
        learn_particles(scene, staged->particles().flow(), facts);
        if (is_all_in_3d(scene)) forget_particles(facts);
    } else {
        facts.walls = are_closed(scene.sides);
        facts.affine = facts.cancels = true;
        facts.structured = scene.structure.has_value() && scene.particles.count() > 0;
        learn_bed(scene.bed, facts);
        if (scene.water) learn_water(scene, facts);
    }
    return facts;
}

}  // namespace frana::fuzz
