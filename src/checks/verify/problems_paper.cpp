// The cases of Fois et al. 2024. The first is the lake of known level as the authors ran it (section 4.1, table 1). The
// second is mud that runs onto a bump (section 4.2). The second has no exact answer: identities and symmetry must hold.
#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "checks/verify/lakes.h"
#include "checks/verify/library.h"
#include "terrain/places.h"

namespace frana::verify {
namespace {

/// Errors of table 1, absolute, over the points: of the depth [m3], [m], and of depth times velocity [m4/s], [m2/s].
struct Table1 {
    double l1_h = 0.0, max_h = 0.0, l1_hu = 0.0, max_hu = 0.0;
};

/// Bed at a place between four nodes, bilinear as for the paper's points [m].
double bed_at(const Raster& bed, double x, double y) { return NodeSquare(bed.geometry, x, y).value(bed); }

void add_errors(const Trial& trial, const Frame& frame, double level, Table1& table) {
    const double *h = frame.particle("depth")->data, *v = frame.particle("velocity")->data;
    const double *place = frame.particle("position")->data, *volume = frame.particle("volume")->data;
    Table1 here;
    for (Index p = 0; p < frame.particle("depth")->count; ++p) {
        const double exact = level - bed_at(trial.scene().bed, place[3 * p], place[3 * p + 1]);
        const double area = volume[p] / exact, dh = std::abs(h[p] - exact);
        const double dhu = h[p] * std::hypot(v[3 * p], v[3 * p + 1]);
        here.l1_h += area * dh, here.max_h = std::max(here.max_h, dh);
        here.l1_hu += area * dhu, here.max_hu = std::max(here.max_hu, dhu);
    }
    table = {std::max(table.l1_h, here.l1_h), std::max(table.max_h, here.max_h), std::max(table.l1_hu, here.l1_hu),
             std::max(table.max_hu, here.max_hu)};
}

/// Bilinear shapes, PIC, depth by the differential equation, level known; whatever the preset.
Measurement run_table(Setup setup) {
    setup.preset = "paper";
    Measurement m;
    Table1 table;
    double speed = 0.0, without_level = 0.0;
    const auto run = [&](Scene scene, double& fastest) {
        Trial trial(std::move(scene), setup, false);
        trial.run_to(1.0, [&](const Status& now) { fastest = std::max(fastest, now.max_speed_on_map); });
        const double wall = m.wall_seconds;
        m = trial.measure();
        m.wall_seconds += wall;
        return trial;
    };
    for (const Lake& lake : {lake_z1(), lake_z2()})
        for (const Placement placement : kPlacements) {
            Scene scene = scene_of(lake, setup, placement);
            Trial known = run(scene, speed);
            add_errors(known, known.simulation().frame(), lake.level, table);
            scene.scheme.still_level.reset();
            if (placement == Placement::aligned) run(std::move(scene), without_level);
        }
    m.add("max_speed", speed, "m/s");
    m.add("l1_h", table.l1_h, "m3");
    m.add("max_h", table.max_h, "m");
    m.add("l1_hu", table.l1_hu, "m4/s");
    m.add("max_hu", table.max_hu, "m2/s");
    m.add("speed_without_level", without_level, "m/s");  // that the level is what holds the lake
    return m;
}

/// Mirror-symmetric about y = 10 m, between walls as the paper's domain ends; 2100 points as in the paper.
Scene obstacle(const Setup& setup) {
    const double cell = 150.0 / static_cast<double>(setup.cells);
    const Index across = static_cast<Index>(std::lround(20.0 / cell)) + 1;
    Scene scene = scene_on(setup.cells + 1, across, cell, [](double x, double y) {
        return 60 - x / 3 + 15 * std::exp(-((x - 50) * (x - 50) + (y - 10) * (y - 10)) / 7);
    });
    scene.density = 1200;
    scene.terrain = TerrainModel::shallow;
    scene.sides = Sides::wall;
    scene.bed_law = bed::Voellmy{std::tan(12 * constants::kPi / 180.0), 200};
    scene.rheology = rheology::Newtonian{10};
    fill(scene, [](double x, double y) { return x > 5 && x < 42.5 && y > 3 && y < 17 ? 10.0 : 0.0; }, {setup.per_side});
    return scene;
}

/// Depth of the node nearest to a place [m].
double depth_near(const Frame& frame, double x, double y) {
    const NodeAt node = nearest_node(frame.grid, x, y);
    return frame.node("depth")->data[node.j * frame.grid.nx + node.i];
}

Measurement run_obstacle(const Setup& setup) {
    Trial trial(obstacle(setup), setup);
    double mass = 0.0, momentum = 0.0;
    trial.run_to(3.0, [&](const Status& now) {
        mass = std::max(mass, now.p2g_mass_error);
        momentum = std::max(momentum, now.p2g_momentum_error);
    });
    Measurement m = trial.measure();
    const Frame frame = trial.simulation().frame();
    const Index nx = frame.grid.nx, ny = frame.grid.ny;
    const double* h = frame.node("depth")->data;
    double worst = 0.0;
    for (Index j = 0; j < ny; ++j)
        for (Index i = 0; i < nx; ++i) worst = std::max(worst, std::abs(h[j * nx + i] - h[(ny - 1 - j) * nx + i]));
    m.add("p2g_mass", mass);
    m.add("p2g_momentum", momentum);
    m.add("mirror_error", worst / frame.status.max_depth);
    m.add("lee_depth", depth_near(frame, 54, 10), "m");  // behind the bump's foot, between the lobes
    m.add("lobe_depth", std::min(depth_near(frame, 54, 4), depth_near(frame, 54, 16)), "m");
    m.add("rejoined_depth", depth_near(frame, 63, 10), "m");
    return m;
}

}  // namespace

std::vector<Problem> paper_problems() {
    Problem table{"lake_paper",
                  "lakes Z1 and Z2 of known level in the paper's own preset (Fois et al. 2024, table 1)",
                  {50},
                  {},
                  run_table};
    const std::string source = "table 1 of the paper";
    table.gates = {{0, "max_speed", 1e-12, "goal"},
                   {0, "l1_h", 2e-12, source},
                   {0, "max_h", 3e-13, source},
                   {0, "l1_hu", 2e-13, source},
                   {0, "max_hu", 3e-14, source}};
    Problem mud{"obstacle",
                "mud splits around a bump and joins again (Fois et al. 2024, section 4.2)",
                {150},
                {},
                run_obstacle};
    mud.gates = {{0, "p2g_mass", 1e-13, "round-off of sums over 1e4 points"},
                 {0, "p2g_momentum", 1e-13, "round-off of sums over 1e4 points"},
                 {0, "mirror_error", 1e-10, "round-off of mirrored sums, grown through 3 s of splashing"},
                 {0, "lee_depth", 0.0, "the lobes leave the lee dry"},
                 {0, "mass_error", 1e-13, "round-off"}};
    return {table, mud};
}

}  // namespace frana::verify
