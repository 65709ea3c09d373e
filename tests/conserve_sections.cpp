// Discharge through lines: what passed is exact whatever points do on their way, and is kept with the state.
#include <omp.h>

#include <sstream>

#include "analytic_scene.h"
#include "catch.h"
#include "fake_gis.h"
#include "fresh_folder.h"
#include "observe/memory_archive.h"
#include "observe/sections.h"
#include "run/run_loop.h"
#include "threads_of_test.h"

using namespace frana;
using namespace frana::test;

namespace {

/// A slab that leaves a plane through a bent line.
Scene slide() {
    Scene scene = scene_on(140, 49, 1.0, [](double x, double y) {
        const double across = (y - 24.0) / 24.0;
        return 80.0 - 0.5 * x + 6.0 * across * across;
    });
    scene.bed_law = bed::Voellmy{0.1, 400.0};
    scene.sections = {{"bent", {{60, -5}, {70, 20}, {62, 53}}, true}, {"back", {{60, -5}, {70, 20}, {62, 53}}, false}};
    fill(scene, [](double x, double y) { return x > 20 && x < 50 && y > 12 && y < 36 ? 1.5 : 0.0; });
    return scene;
}

/// A slab in a gully three cells wide that comes to rest in part: points split, merge, leave, and sleep.
Scene gully() {
    Scene scene = scene_on(61, 25, 5.0, [](double x, double y) {
        const double rest = std::max(0.0, 230.0 - x), across = std::min(15.0, std::abs(y - 60.0));
        return 1.1e-3 * rest * rest + 0.02 * across * across;
    });
    scene.bed_law = bed::Voellmy{0.2, 400.0};
    scene.sections = {{"bent", {{90, -10}, {110, 60}, {95, 135}}, true},
                      {"back", {{90, -10}, {110, 60}, {95, 135}}, false}};
    fill(scene, [](double x, double y) { return x > 20 && x < 80 && y > 40 && y < 80 ? 1.5 : 0.0; });
    return scene;
}

/// Whether a place lies beyond that bent line [m].
bool beyond(double x, double y) {
    return x > (y < 60.0 ? 90.0 + 20.0 / 70.0 * (y + 10.0) : 110.0 - 15.0 / 75.0 * (y - 60.0));
}

double volume_beyond(const DepthAveraged& run) {
    const Particles& c = run.flow().particles;
    double mass = 0.0;
    for (Index p = 0; p < c.count(); ++p)
        if (beyond(run.flow().cell * c.x[p], run.flow().cell * c.y[p])) mass += c.mass[p];
    return mass / run.flow().density;
}

}  // namespace

// Sums of so many masses in another order agree to round-off: 1e-12 of the whole.
TEST_CASE("What passed a line is what lies beyond it, at every step", "[sections]") {
    Scene scene = gully();
    scene.scheme.cfl = 0.5;  // fewer steps part and unite fewer points
    DepthAveraged run(scene);
    const double whole = run.status().mass / scene.density;
    Index most = 0, merged = 0;
    double halfway = 0.0;
    while (run.status().time < 25.0 && run.status().mass_left == 0.0) {
        const Index before = run.status().particles;
        run.advance(25.0);
        merged += std::max<Index>(0, before - run.status().particles);
        const std::vector<double> passed = run.passed();
        CHECK(passed[0] == Approx(volume_beyond(run)).margin(1e-12 * whole));
        CHECK(passed[1] == -passed[0]);
        most = std::max(most, run.status().particles);
        if (passed[0] > 0.3 * whole && passed[0] < 0.7 * whole) halfway = passed[0];
    }
    CHECK(halfway > 0.0);
    CHECK(most > scene.particles.count());
    CHECK(merged > 0);
}

namespace {

/// Beds here have the flow's density.
struct BedBeyond {
    double gained = 0.0;   ///< since the start, beyond the bent line [m3]
    double on_line = 0.0;  ///< gained and lost within two and a half cells of it, both as positive [m3]
};
BedBeyond bed_beyond(DepthAveraged& run) {
    BedBeyond bed;
    const Frame frame = run.frame();
    const Field& change = *frame.node("bed_change");
    const GridGeometry& g = frame.grid;
    const double reach = 2.5 * g.cell;
    for (Index k = 0; k < change.count; ++k) {
        const double x = g.x(k % g.nx), y = g.y(k / g.nx), volume = g.cell * g.cell * change.data[k];
        if (beyond(x, y)) bed.gained += volume;
        if (beyond(x - reach, y) != beyond(x + reach, y)) bed.on_line += std::abs(volume);
    }
    return bed;
}

}  // namespace

TEST_CASE("What a flow took up before a line passes it: its volume to round-off", "[sections][erosion]") {
    Scene scene = gully();
    scene.erodible = ErodibleBed{};
    scene.erodible->density = scene.density;
    scene.erodible->law = erosion::Growth{0.01};
    scene.erodible->depth = sampled(scene.bed.geometry, [](double x, double) { return x < 60.0 ? 0.5 : 0.0; });
    DepthAveraged run(scene);
    const double whole = run.status().mass / scene.density;
    while (run.status().time < 20.0 && run.status().mass_left == 0.0) {
        run.advance(20.0);
        CHECK(run.passed()[0] == Approx(volume_beyond(run)).margin(1e-12 * whole));
    }
    CHECK(run.status().bed.eroded > 0.05 * whole * scene.density);
    CHECK(run.passed()[0] > 0.5 * whole);
}

// A particle gives the bed of nodes around it, a cell and a half and its own size away, and takes from them. Those beyond a line
// get from both sides of it. What does not cancel is 0.5 % of what the bed there gained and lost when each step has an exchange.
// It is 1.2 % when one stands for three steps.
TEST_CASE("What passed a line is what flow and bed beyond it gained, but for the bed that they share on the line",
          "[sections][erosion][deposition]") {
    Scene scene = gully();
    scene.erodible = ErodibleBed{};
    scene.erodible->density = scene.density;
    scene.erodible->law = erosion::Growth{0.01};
    scene.erodible->depth = sampled(scene.bed.geometry, [](double, double) { return 0.5; });
    scene.deposition = Deposition{};
    scene.deposition->rest = 1.0;
    DepthAveraged run(scene);
    const double whole = run.status().mass / scene.density;
    BedBeyond bed;
    for (const double until : {8.0, 15.0, 24.0, 40.0}) {
        run_to(run, until);
        bed = bed_beyond(run);
        CAPTURE(until, bed.on_line, bed.gained);
        CHECK(run.passed()[0] == Approx(volume_beyond(run) + bed.gained).margin(0.02 * bed.on_line));
    }
    CHECK(run.passed()[0] > whole);                                       // with what it took up on its way
    CHECK(std::abs(run.passed()[0] - volume_beyond(run)) > 0.5 * whole);  // nearly all has become bed
    CHECK(run.status().bed.deposited > 0.5 * whole * scene.density);
    CHECK(bed.on_line > 0.05 * whole);
}

TEST_CASE("A whole release passes a line: its volume to round-off", "[sections]") {
    Scene scene = slide();
    scene.bed_law = bed::None{};
    DepthAveraged run(scene);
    const double whole = run.status().mass / scene.density;
    run_to(run, 20.0);
    REQUIRE(run.status().mass == 0.0);  // the terrain is open
    CHECK(run.passed()[0] == Approx(whole).epsilon(1e-12));
}

TEST_CASE("Sums through lines go on after a resume and on any number of threads, with the same bits",
          "[sections][threads]") {
    const Threads restored;
    const Scene scene = slide();
    omp_set_num_threads(1);
    DepthAveraged straight(scene);
    MemoryArchive kept;
    while (straight.status().time < 6.0) {
        if (straight.passed()[0] > 0.0 && kept.entries().empty()) straight.serialize(kept);
        straight.advance(6.0);
    }
    REQUIRE_FALSE(kept.entries().empty());
    omp_set_num_threads(4);
    DepthAveraged resumed(scene, Start::resumed);
    resumed.serialize(kept.rewind());
    CHECK(resumed.passed()[0] > 0.0);
    CHECK(resumed.passed()[0] < straight.passed()[0]);
    run_to(resumed, 6.0);
    CHECK(resumed.passed() == straight.passed());
    omp_set_num_threads(2);
    DepthAveraged other(scene);
    run_to(other, 6.0);
    CHECK(other.passed() == straight.passed());
}

// Nodes without material counted as resting: half a cell from the edge a gauge had half of the speed.
TEST_CASE("Next to dry ground a gauge has the speed of what is there", "[gauges][sections]") {
    Scene scene = scene_on(41, 21, 1.0, [](double, double) { return 0.0; });
    fill(scene, [](double x, double y) { return x > 10 && x < 20 && y > 5 && y < 15 ? 1.0 : 0.0; });
    scene.particles.vx.assign(scene.particles.x.size(), 2.0);
    const DepthAveraged run(scene);
    for (const double x : {9.2, 9.9, 15.0, 20.1, 20.9}) {
        const Sample at = run.at({x, 10.3});
        CAPTURE(x, at.depth);
        REQUIRE(at.depth > 0.0);
        CHECK(at.velocity.x() == Approx(2.0).epsilon(1e-12));
        CHECK(at.speed == Approx(2.0).epsilon(1e-12));
    }
    CHECK(run.at({30.0, 10.3}).speed == 0.0);
}

TEST_CASE("Beyond the terrain a line has no discharge", "[sections]") {
    class Everywhere final : public Probe {
    public:
        Sample at(const Vec2&) const override { return {0.0, 2.0, {3.0, 0.0}, 3.0}; }
    };
    SectionLine line{"over the rim", {{10.0, 100.0}, {10.0, -60.0}}, false};
    CHECK(discharge_through(line, 0.5, Everywhere()) == Approx(2.0 * 3.0 * 160.0));
    line.terrain = {0.0, 0.0, 50.0, 80.0};
    CHECK(discharge_through(line, 0.5, Everywhere()) == Approx(2.0 * 3.0 * 80.0));
}

TEST_CASE("Sections do not change a run", "[sections]") {
    Scene scene = slide();
    DepthAveraged with(scene);
    scene.sections.clear();
    DepthAveraged without(scene);
    run_to(with, 5.0), run_to(without, 5.0);
    CHECK(with.status().momentum == without.status().momentum);
    CHECK(with.flow().particles.x == without.flow().particles.x);
    CHECK(with.flow().particles.id == without.flow().particles.id);
}

TEST_CASE("sections/NAME.csv has a row a step, whatever the outputs", "[sections]") {
    const Scene scene = slide();
    const auto table = [&](double every) {
        const FreshFolder folder;
        std::vector<SectionSummary> summaries;
        DepthAveraged run(scene);
        Observers observers;
        std::vector<SectionLine> lines;
        for (const Section& section : scene.sections) lines.push_back({section.name, section.line, section.to_right});
        lines[0].solid_share = 0.6;
        observers.push_back(std::make_unique<Sections>(folder.path(), lines, 0.5, summaries));
        std::ostringstream stream;
        Progress progress(stream, Progress::Style::silent, scene.density);
        const RunSummary summary = frana::run(run, {6.0, every, false}, observers, Interrupt(), progress);
        Table read = read_table(folder.path() / "sections" / "bent.csv");
        CHECK(read.rows() == static_cast<std::size_t>(summary.steps) + 1);
        CHECK(read.column("volume").back() == run.passed()[0]);
        CHECK(summaries[0].volume == run.passed()[0]);
        CHECK(read.column("sediment").back() == 0.6 * run.passed()[0]);
        CHECK(summaries[0].sediment == read.column("sediment").back());
        CHECK(summaries[1].sediment == summaries[1].volume);  // all of it, where nothing tells of grains
        CHECK(summaries[0].peak == *std::max_element(read.column("discharge").begin(), read.column("discharge").end()));
        // Discharge is of the nodes: its integral is the volume to the order of a cell's share of the flow's length.
        CHECK(summaries[0].integral == Approx(summaries[0].volume).epsilon(0.05));
        CHECK(summaries[0].towards.x() > 0.99);
        CHECK(summaries[1].volume == -summaries[0].volume);
        return read;
    };
    const Table rarely = table(6.0), often = table(0.37);
    CHECK(rarely.values == often.values);
}
