// Material that comes in through a line: its volume, uniform flow, and a wave on it.
#include <algorithm>
#include <cmath>

#include "checks/verify/library.h"
#include "checks/verify/trial.h"
#include "law/bed/normal_flow.h"
#include "observe/sections.h"

namespace frana::verify {
namespace {

constexpr double kInflowSlope = 0.2;  ///< tangent
constexpr double kInflowDensity = 1800.0;
const double kCosine = 1.0 / std::sqrt(1.0 + kInflowSlope * kInflowSlope);

/// Uniform flow of a discharge per width on the slope, as the map has it.
struct Uniform {
    double depth, speed;  ///< vertical [m]; along the map [m/s]
};
Uniform uniform(const BedLaw& law, double discharge) {
    const bed::NormalFlow flow = bed::normal_flow(law, discharge, {kInflowSlope, 9.81, kInflowDensity});
    return {flow.thickness / kCosine, flow.speed * kCosine};
}

/// A strip of six cells between walls, which falls along x and ends at an exit. An inflow is over all of its width.
struct Channel {
    double cell, length, line;  ///< [m]
    double width() const { return 6.0 * cell; }
    Scene scene(const BedLaw& law) const {
        const Index nx = static_cast<Index>(std::lround(length / cell)) + 1;
        Scene scene = scene_on(nx, 7, cell, [this](double x, double) {
            return x > length - 3.5 * cell ? Raster::nodata : -kInflowSlope * x;
        });
        scene.sides = Sides::wall;
        scene.density = kInflowDensity;
        scene.bed_law = law;
        return scene;
    }
    /// Discharges per width [m2/s], linear in time, each at the speed of uniform flow.
    void feed(Scene& scene, const std::vector<double>& time, const std::vector<double>& discharge, int per_side) const {
        constexpr int kParts = 32;
        Inflow inflow;
        inflow.name = "upstream";
        inflow.line = {{line, 0.0}, {line, width()}};
        inflow.slope = kInflowSlope;
        inflow.spacing = cell / per_side;
        const auto add = [&](double t, double q) {
            inflow.time.push_back(t), inflow.discharge.push_back(q * width());
            inflow.speed.push_back(uniform(scene.bed_law, q).speed);
        };
        add(time.front(), discharge.front());
        for (std::size_t n = 0; n + 1 < time.size(); ++n)
            for (int part = 1; part <= kParts; ++part) {
                const double share = static_cast<double>(part) / kParts;
                add(time[n] + share * (time[n + 1] - time[n]),
                    discharge[n] + share * (discharge[n + 1] - discharge[n]));
            }
        scene.inflows = {inflow};
    }
};

/// |volume - expected| / expected of what came in.
double volume_error(DepthAveraged& run) {
    const InflowBudget budget = run.extras().inflow.value();
    return std::abs(budget.volume - budget.expected) / budget.expected;
}

/// A flood into a closed basin, at each step up to one row; nothing is there before.
Measurement run_volume(const Setup& setup) {
    const double cell = 40.0 / static_cast<double>(setup.cells);
    Scene scene =
        scene_on(setup.cells + 1, setup.cells + 1, cell, [](double x, double y) { return 0.1 * x + 0.05 * y; });
    scene.sides = Sides::wall;
    scene.bed_law = bed::Manning{0.05, 0.0};
    Inflow inflow;
    inflow.name = "oblique";
    inflow.line = {{26.0, 30.0}, {32.0, 20.0}};
    inflow.spacing = cell / setup.per_side;
    inflow.time = {1.0, 4.0, 5.0, 9.0, 20.0}, inflow.discharge = {0.0, 40.0, 12.0, 12.0, 0.0};
    inflow.speed = {2.0, 5.0, 3.0, 3.0, 1.0};
    inflow.to_right = false;
    scene.inflows = {inflow};
    Trial trial(std::move(scene), setup);
    double worst = 0.0;
    trial.run_to(25.0, [&](const Status& now) {
        if (now.mass_in > 0.0) worst = std::max(worst, volume_error(trial.simulation()));
    });
    Measurement m = trial.measure();
    constexpr double kVolume = 60.0 + 26.0 + 48.0 + 66.0;
    m.add("volume_error", std::abs(trial.simulation().status().mass_in / 1000.0 - kVolume) / kVolume);
    m.add("worst_volume_error", worst);
    return m;
}

/// Depth and speed behind the front of an inflow of 4 m2/s onto the dry slope. Also where the front is.
struct BehindFront {
    double depth_error = 0.0, speed_error = 0.0;  ///< largest of their means over ten metres each, relative
    double front_error = 0.0;                     ///< of its way [1]
    Measurement measurement;
};
BehindFront behind_front(const BedLaw& law, const Setup& setup) {
    constexpr double kDischarge = 4.0, kEnd = 20.0, kLine = 10.0, kFront = 20.0;
    const Channel channel{100.0 / static_cast<double>(setup.cells), 160.0, kLine};
    Scene scene = channel.scene(law);
    channel.feed(scene, {0.0, 2.0 * kEnd}, {kDischarge, kDischarge}, setup.per_side);
    const Uniform exact = uniform(law, kDischarge);
    Trial trial(std::move(scene), setup);
    trial.run_to(kEnd);
    const double way = exact.speed * kEnd;
    BehindFront result;
    result.measurement =
        trial.measure({[&](double, double) { return exact.depth; },
                       [&](double, double) { return exact.speed; },
                       {},
                       [&](double x, double) { return x > kLine + 10.0 && x < kLine + way - kFront; }});
    // Half of the depth, from the middle row.
    double front = kLine;
    for (double x = kLine; x < kLine + 1.5 * way; x += 0.1 * channel.cell) {
        const Sample here = trial.simulation().at({x, 0.5 * channel.width()});
        if (here.depth > 0.5 * exact.depth) front = x;
    }
    result.front_error = (front - kLine - way) / way;
    for (double x = kLine + 10.0; x + 10.0 < kLine + way - kFront; x += 10.0) {
        double depth = 0.0, flux = 0.0;
        constexpr int kPlaces = 40;
        for (int n = 0; n < kPlaces; ++n) {
            const Sample here = trial.simulation().at({x + 10.0 * (n + 0.5) / kPlaces, 0.5 * channel.width()});
            depth += here.depth / kPlaces, flux += here.velocity.x() / kPlaces;
        }
        result.depth_error = std::max(result.depth_error, std::abs(depth / exact.depth - 1.0));
        result.speed_error = std::max(result.speed_error, std::abs(flux / exact.speed - 1.0));
    }
    return result;
}

Measurement run_normal(const Setup& setup) {
    const BehindFront voellmy = behind_front(bed::Voellmy{0.08, 400.0}, setup);
    const BehindFront manning = behind_front(bed::Manning{0.05, 0.0}, setup);
    const BehindFront bingham = behind_front(bed::Bingham{200.0, 400.0, 0.0}, setup);
    Measurement m = voellmy.measurement;
    const auto add = [&](const std::string& law, const BehindFront& found) {
        m.add(law + "_depth", found.depth_error), m.add(law + "_speed", found.speed_error);
        m.add(law + "_front", found.front_error);
    };
    add("voellmy", voellmy), add("manning", manning), add("bingham", bingham);
    return m;
}

/// The closed forms that the search for uniform flow must meet.
std::vector<Residual> normal_residuals() {
    const double s = kInflowSlope * kCosine, q = 4.0;
    const auto flow = [&](const BedLaw& law) { return bed::normal_flow(law, q, {kInflowSlope, 9.81, kInflowDensity}); };
    const double voellmy = std::cbrt(q * q / (400.0 * (s - 0.08 * kCosine)));
    const double manning = std::pow(0.05 * q / std::sqrt(s), 0.6);
    const double h = flow(bed::Bingham{200.0, 400.0, 0.0}).thickness, sheared = h - 400.0 / (kInflowDensity * 9.81 * s);
    const double bingham = kInflowDensity * 9.81 * s * sheared * sheared * (3.0 * h - sheared) / (6.0 * 200.0);
    return {{"Voellmy: h = (q^2 / (xi (sin - mu cos)))^(1/3)",
             std::abs(flow(bed::Voellmy{0.08, 400.0}).thickness / voellmy - 1.0), 1e-12},
            {"Manning: h = (n q / sqrt(sin))^(3/5)", std::abs(flow(bed::Manning{0.05, 0.0}).thickness / manning - 1.0),
             1e-12},
            {"Bingham: q = rho g sin hs^2 (3 h - hs) / (6 eta)", std::abs(bingham / q - 1.0), 1e-12},
            {"0.697908 m by Voellmy's law", std::abs(voellmy - 0.697908), 5e-7}};
}

/// What lies before a place along x [kg].
double mass_before(DepthAveraged& run, const GridGeometry& grid, double place) {
    const Particles& c = run.flow().particles;
    CompensatedSum mass;
    for (Index p = 0; p < c.count(); ++p)
        if (grid.x0 + grid.cell * c.x[p] < place) mass.add(c.mass[p]);
    return mass.value();
}

/// A triangle from 4 to 8 m2/s and back on uniform flow. The largest discharge goes with the celerity of 8 m2/s, 3/2 u.
Measurement run_wave(const Setup& setup) {
    constexpr double kBase = 4.0, kPeak = 8.0, kStart = 20.0, kRise = 60.0, kLine = 20.0, kAway = 1000.0, kEnd = 260.0;
    const BedLaw law = bed::Voellmy{0.08, 400.0};
    const Channel channel{1000.0 / static_cast<double>(setup.cells), kLine + kAway + 80.0, kLine};
    Scene scene = channel.scene(law);
    channel.feed(scene, {0.0, kStart, kStart + kRise, kStart + 2.0 * kRise, 2.0 * kEnd},
                 {kBase, kBase, kPeak, kBase, kBase}, setup.per_side);
    const Uniform base = uniform(law, kBase), peak = uniform(law, kPeak);
    fill(scene, [&](double x, double) { return x > kLine && x < kLine + kAway + 60.0 ? base.depth : 0.0; },
         {setup.per_side});
    for (double& speed : scene.particles.vx) speed = base.speed;
    const Polyline gauge{{kLine + kAway, -1.0}, {kLine + kAway, channel.width() + 1.0}};
    scene.sections = {{"end", gauge, true}};
    Trial trial(std::move(scene), setup);
    DepthAveraged& run = trial.simulation();
    const GridGeometry grid = run.frame().grid;
    const double before = mass_before(run, grid, kLine + kAway) - run.status().mass_in;
    std::vector<double> time, discharge;
    double integral = 0.0, excess = 0.0, moment = 0.0;
    trial.run_to(kEnd, [&](const Status& now) {
        const SectionLine line{"end", {{kLine + kAway, 0.0}, {kLine + kAway, channel.width()}}, true};
        time.push_back(now.time);
        discharge.push_back(discharge_through(line, 0.5 * channel.cell, trial.simulation()) / channel.width());
        const double dt = time.size() > 1 ? time.back() - time[time.size() - 2] : 0.0;
        integral += dt * discharge.back();
        excess += dt * (discharge.back() - kBase), moment += dt * (discharge.back() - kBase) * now.time;
    });
    // The largest mean over five seconds: what single steps add is noise of the order of a row.
    double best = 0.0, when = 0.0;
    for (std::size_t n = 0; n < time.size(); ++n) {
        double sum = 0.0, count = 0.0;
        for (std::size_t k = n; k < time.size() && time[k] < time[n] + 5.0; ++k) sum += discharge[k], count += 1.0;
        if (time[n] + 5.0 < kEnd && sum / count > best) best = sum / count, when = time[n] + 2.5;
    }
    const double travel = kAway / (1.5 * peak.speed);
    Measurement m = trial.measure();
    m.add("peak_time_error", (when - kStart - kRise - travel) / travel);
    m.add("peak_discharge_error", best / kPeak - 1.0);
    m.add("passed_error", trial.simulation().passed()[0] / (channel.width() * integral) - 1.0);
    // What the line let through is missing before it.
    const double missing = before + run.status().mass_in - mass_before(run, grid, kLine + kAway);
    m.add("balance_error", run.passed()[0] * kInflowDensity / missing - 1.0);
    m.add("volume_error", volume_error(trial.simulation()));
    // All of the triangle's volume has passed: what came in beyond the base flow.
    m.add("excess_error", excess / ((kPeak - kBase) * kRise) - 1.0);
    return m;
}

}  // namespace

std::vector<Problem> inflow_problems() {
    const Gate mass{0, "mass_error", 1e-13, "round-off"};
    Problem volume{"inflow_volume",
                   "a flood through an oblique line into a closed basin that is empty before",
                   {20, 40, 80},
                   [] { return std::vector<Residual>{}; },
                   run_volume};
    volume.order_of = "";
    volume.has_presets = false;
    volume.gates = {mass,
                    {0, "volume_error", 1e-13, "round-off"},
                    {0, "worst_volume_error", 1e-13, "round-off, at every step up to one row"}};
    Problem normal{"inflow_normal",
                   "4 m2/s come in onto a dry slope of 0.2 at the speed of uniform flow: Voellmy, Manning, Bingham",
                   {50, 100, 200},
                   normal_residuals,
                   run_normal};
    normal.order_of = "l1_depth";
    normal.has_presets = false;
    normal.gates = {mass};
    for (const char* law : {"voellmy", "manning", "bingham"})
        for (const char* what : {"_depth", "_speed"})
            normal.gates.push_back({200, std::string(law) + what, 5e-3, "goal, behind the front"});
    Problem wave{"inflow_wave",
                 "a triangle from 4 to 8 m2/s on uniform flow: its peak 1 km away, by the kinematic celerity",
                 {250, 500},
                 [] { return std::vector<Residual>{}; },
                 run_wave};
    wave.order_of = "";
    wave.has_presets = false;
    wave.gates = {mass,
                  {500, "peak_time_error", 3e-2, "goal"},
                  {0, "volume_error", 1e-13, "round-off"},
                  {0, "balance_error", 1e-12, "rounding of a plain sum of passages"}};
    return {volume, normal, wave};
}

}  // namespace frana::verify
