// Blocks and slabs on planes at any angle to the grid: travel, terminal speed, and what must not move.
#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "checks/verify/exact_block.h"
#include "checks/verify/library.h"
#include "checks/verify/slide.h"

namespace frana::verify {
namespace {

using constants::kDegree;
constexpr double kTurns[] = {0.0, 15.0, 27.0, 45.0};

/// Cells per 100 m.
double cell_of(const Setup& setup) { return 100.0 / static_cast<double>(setup.cells); }

Function plane(double slope_deg) {
    return [t = std::tan(slope_deg * kDegree)](double s, double) { return -t * s; };
}

/// A thin blob on planes of 10 to 60 degrees, 5 s. It gives the worst of 16 runs, and the figures of a run of the last
/// of them.
Measurement run_block_coulomb(const Setup& setup) {
    constexpr double kMu = 0.1, kEnd = 5.0;
    double travel = 0.0, drift = 0.0;
    Measurement m;
    for (const double slope : {10.0, 30.0, 45.0, 60.0})
        for (const double turn : kTurns) {
            const double exact = Slab{slope, kMu}.travel(kEnd) * std::cos(slope * kDegree);  // along the map
            Slide slide{cell_of(setup), turn * kDegree, 0.0, exact, 8.0};
            slide.per_side = setup.per_side;
            Scene scene = slide.scene(plane(slope));
            scene.bed_law = bed::Coulomb{kMu};
            Trial trial(std::move(scene), setup);
            const BlobState start = blob_state(trial, slide, plane(slope));
            trial.run_to(kEnd);
            const BlobState end = blob_state(trial, slide, plane(slope));
            travel = std::max(travel, std::abs((end.along - start.along) / exact - 1));
            drift = std::max(drift, std::abs(end.across - start.across));
            m = trial.measure();
        }
    m.add("travel_error", travel);
    m.add("cross_drift", drift, "m");
    return m;
}

/// Means over the points that started within two cells of the centre (0, 0) of a disc. It is so wide that they do not
/// feel its edge. Speed along the bed [m/s], way along and across the slide [m].
struct Middle {
    double speed, along, across;
};
Middle middle_of(Trial& trial, const Slide& slide) {
    const Seeds& seeds = trial.scene().particles;
    const Frame frame = trial.simulation().frame();
    const double *place = frame.particle("position")->data, *speed = frame.particle("speed")->data;
    const double* id = frame.particle("id")->data;
    Middle sum{0.0, 0.0, 0.0};
    double count = 0.0;
    for (Index p = 0; p < frame.particle("id")->count; ++p) {
        const Index first = static_cast<Index>(id[p]);
        if (first >= seeds.count() || std::hypot(seeds.x[first], seeds.y[first]) > 2.0 * slide.cell) continue;
        sum.speed += speed[p];
        sum.along += slide.along(place[3 * p] - seeds.x[first], place[3 * p + 1] - seeds.y[first]);
        sum.across += slide.across(place[3 * p] - seeds.x[first], place[3 * p + 1] - seeds.y[first]);
        count += 1.0;
    }
    return {sum.speed / count, sum.along / count, sum.across / count};
}

const Slab kVoellmy[] = {{30, 0.2, 1000, 2}, {35, 0.155, 4000, 1}, {25, 0.1, 500, 1.5}};

/// The three slabs, along the grid and turned 27 degrees; the worst of six runs.
Measurement run_block_voellmy(const Setup& setup) {
    constexpr double kEnd = 10.0, kRadius = 200.0;
    double speed = 0.0, travel = 0.0;
    Measurement m;
    for (const Slab& slab : kVoellmy)
        for (const double turn : {0.0, 27.0}) {
            const double cosine = std::cos(slab.slope_deg * kDegree);
            Slide slide{cell_of(setup), turn * kDegree, 0.0, slab.travel(kEnd) * cosine};
            slide.radius = kRadius / slide.cell;
            slide.depth = slab.thickness / cosine / slide.cell;
            slide.per_side = setup.per_side;
            Scene scene = slide.scene(plane(slab.slope_deg));
            scene.bed_law = bed::Voellmy{slab.mu, slab.xi};
            Trial trial(std::move(scene), setup);
            trial.run_to(kEnd);
            const Middle middle = middle_of(trial, slide);
            speed = std::max(speed, std::abs(middle.speed / slab.speed(kEnd) - 1));
            travel = std::max(travel, std::abs(middle.along / (slab.travel(kEnd) * cosine) - 1));
            m = trial.measure();
        }
    m.add("speed_error", speed);
    m.add("travel_error", travel);
    return m;
}

/// What a plane carries: a layer 1 m thick, or a blob 2 m high and 40 m wide.
struct Load {
    double slope_deg, mu;
    bool blob;
};

struct Stand {
    double farthest;  ///< that a point which started within 60 m of the centre has moved in 10 s [m]
    Middle middle;
    Measurement measurement;
};

/// The layer's edge, a cliff 200 m from the centre, does move, hence the 60 m.
Stand stand(const Setup& setup, const Load& load, double turn) {
    Slide slide{cell_of(setup), turn};
    slide.radius = 200.0 / slide.cell;
    slide.depth = 0.0;
    Scene scene = slide.scene(plane(load.slope_deg));
    const auto layer = [](double x, double y) { return x * x + y * y < 4e4 ? 1.0 : 0.0; };
    const auto blob = [](double x, double y) { return 2.0 * std::max(0.0, 1.0 - (x * x + y * y) / 400.0); };
    fill(scene, load.blob ? Function(blob) : Function(layer), {setup.per_side});
    scene.bed_law = bed::Coulomb{load.mu};
    Trial trial(std::move(scene), setup);
    trial.run_to(10.0);
    const Seeds& seeds = trial.scene().particles;
    const Particles& c = trial.simulation().flow().particles;
    const GridGeometry& g = trial.scene().bed.geometry;
    double farthest = 0.0;
    for (Index p = 0; p < c.count(); ++p) {
        const Index first = c.id[p];
        if (first >= seeds.count() || std::hypot(seeds.x[first], seeds.y[first]) > 60.0) continue;
        farthest = std::max({farthest, std::abs(c.x[p] - (seeds.x[first] - g.x0) / g.cell),
                             std::abs(c.y[p] - (seeds.y[first] - g.y0) / g.cell)});
    }
    return {farthest * g.cell, middle_of(trial, slide), trial.measure()};
}

Measurement run_block_static(const Setup& setup) {
    double farthest = 0.0;
    for (const Load& load : {Load{30, 0.5774, false}, {60, 1.7321, false}, {30, 0.84, true}})
        for (const double turn : {0.0, 27.0, 45.0})
            farthest = std::max(farthest, stand(setup, load, turn * kDegree).farthest);
    const Slab moving{30, 0.5773};
    const Stand slow = stand(setup, {30, moving.mu, false}, 27 * kDegree);
    Measurement m = slow.measurement;
    m.add("displacement", farthest, "m");
    m.add("barely_moving", slow.middle.along / (moving.travel(10.0) * std::cos(30 * kDegree)) - 1);
    return m;
}

std::vector<Residual> voellmy_residuals() {
    std::vector<Residual> list = published_blocks();
    for (const Slab& slab : kVoellmy)
        for (const Residual& residual : slab.residuals()) list.push_back(residual);
    return list;
}

}  // namespace

std::vector<Problem> block_problems() {
    const Gate volume{0, "mass_error", 1e-13, "round-off"};
    Problem coulomb{"block_coulomb",
                    "thin block on planes of 10 to 60 degrees turned 0 to 45 degrees: a t^2 / 2",
                    {25, 50, 100},
                    published_blocks,
                    run_block_coulomb};
    coulomb.gates = {{0, "travel_error", 1e-8, "goal; an earlier code 1e-9"},
                     {0, "cross_drift", 1e-7, "1e-8 of the travel; an earlier code 2e-9"},
                     volume};
    Problem voellmy{"block_voellmy",
                    "infinite slab with Voellmy friction, turned 0 and 27 degrees: tanh to its end speed",
                    {12, 25},
                    voellmy_residuals,
                    run_block_voellmy};
    voellmy.gates = {{0, "speed_error", 1e-6, "goal; an earlier code 4e-9"},
                     {0, "travel_error", 1e-3, "canon B5, at the default time step"},
                     volume};
    Problem holds{"block_static",
                  "layers and a blob below the friction angle, turned 0 to 45 degrees: not one bit moves",
                  {12, 25},
                  {},
                  run_block_static};
    holds.gates = {{0, "displacement", 0.0, "static friction is a bound, not a force"},
                   {0, "barely_moving", 1e-6, "as the slab that moves: friction solve is exact"},
                   volume};
    return {coulomb, voellmy, holds};
}

}  // namespace frana::verify
