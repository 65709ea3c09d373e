// The measuring itself, on scenes far too small to tell anything about speed.
#include <cmath>
#include <filesystem>
#include <regex>

#include "base/error.h"
#include "catch.h"
#include "checks/bench/blob.h"
#include "checks/bench/body.h"
#include "checks/bench/print.h"
#include "checks/bench/traffic.h"
#include "fresh_folder.h"
#include "shallow/depth_averaged.h"

using namespace frana;

namespace {

bench::Options tiny() {
    bench::Options options;
    options.particles = {1000, 4000};
    options.threads = {2};
    options.quick = true;
    options.array_bytes = 1 << 20;
    return options;
}

const bench::Report& report() {
    static const bench::Report done = bench::run(tiny(), [](const std::string&) {});
    return done;
}

/// Every number that stands behind "key": in the text; numbers with another notation are not found.
std::vector<double> numbers(const std::string& text, const std::string& key) {
    const std::regex pattern("\"" + key + "\": ([-+0-9.e]+)[,}]");
    std::vector<double> found;
    for (std::sregex_iterator hit(text.begin(), text.end(), pattern), end; hit != end; ++hit)
        found.push_back(std::stod((*hit)[1]));
    return found;
}

std::size_t occurrences(const std::string& text, const std::string& word) {
    std::size_t count = 0;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
    return count;
}

}  // namespace

TEST_CASE("A blob has as many points as it should, on the same tiles of tight and wide grids", "[bench]") {
    bench::Blob blob;
    blob.particles = 3001;
    const Scene tight = bench::blob_scene(blob);
    blob.emptiness = 100.0;
    const Scene wide = bench::blob_scene(blob);
    CHECK(tight.particles.count() == 3001);
    CHECK(wide.particles.volume == tight.particles.volume);
    CHECK(wide.bed.geometry.size() >= 100 * 3001 / 4);
    const double shift = (wide.particles.x[0] - tight.particles.x[0]) / tight.bed.geometry.cell / kTile;
    CHECK(shift == std::round(shift));
    const DepthAveraged a(tight), b(wide);
    CHECK(a.flow().active.begin == b.flow().active.begin);
}

TEST_CASE("bench writes the contract's keys with finite numbers above zero", "[bench]") {
    const std::string json = bench::json_of(report());
    const std::size_t kernels = occurrences(json, "\"name\": ");
    CHECK(kernels > 50);
    for (const char* key :
         {"particles", "threads", "ns_per_particle_step", "bytes_per_particle_step", "fraction_of_stream"}) {
        CAPTURE(key);
        const std::vector<double> values = numbers(json, key);
        CHECK(values.size() == kernels);
        for (const double value : values) CHECK((std::isfinite(value) && value > 0.0));
    }
    CHECK(numbers(json, "node_touch_ns").size() == 1);
    CHECK(numbers(json, "node_touch_ns")[0] > 0.0);
    CHECK(numbers(json, "1").size() == 2);  // both triads, one thread and two
    CHECK(numbers(json, "2").size() == 2);
    CHECK(occurrences(json, "\"depth_averaged/full/double\"") == 4);  // two sizes, one thread and two
    CHECK(occurrences(json, "\"depth_averaged/grid_update/double\"") == 4);
}

TEST_CASE("The table of bench tells how much faster two threads are, phase by phase", "[bench]") {
    const std::string table = bench::table_of(report());
    const std::size_t begin = table.find("speed-up over one thread");
    REQUIRE(begin != std::string::npos);
    const std::string part = table.substr(begin, table.find("\n\n", begin) - begin);
    for (const Index particles : {Index{1000}, Index{4000}}) {
        const bench::Timed *one = bench::find(report(), "depth_averaged", particles, 1),
                           *two = bench::find(report(), "depth_averaged", particles, 2);
        REQUIRE((one != nullptr && two != nullptr));
        const std::regex row("depth_averaged/full/double +" + std::to_string(particles) + " +([0-9.]+)\n");
        std::smatch found;
        REQUIRE(std::regex_search(part, found, row));
        CHECK(std::stod(found[1]) ==
              Approx(one->cost.full().wall_ns / two->cost.full().wall_ns).margin(0.006));  // two digits
    }
    CHECK(occurrences(part, "depth_averaged/grid_update/double") == 2);
    CHECK(occurrences(part, "structured/") == 0);  // timed with one thread only
}

TEST_CASE("bench finds the same bits for one, two and four threads, and other bits in another state", "[bench]") {
    CHECK(report().hashes.size() == 3);
    CHECK(bench::same_bits(report()));
    bench::Report other = report();
    other.hashes[4] ^= 1;
    CHECK_FALSE(bench::same_bits(other));
    bench::Blob blob;
    blob.particles = 1000;
    Particles particles = DepthAveraged(bench::blob_scene(blob)).flow().particles;
    const std::uint64_t before = bench::hash_of(particles);
    particles.r2y[500] = std::nextafter(particles.r2y[500], 1.0);
    CHECK(bench::hash_of(particles) != before);
}

TEST_CASE("Every phase that the solver times has a traffic model, and phases make up the step", "[bench]") {
    bench::Blob blob;
    blob.particles = 4000;
    DepthAveraged simulation(bench::blob_scene(blob));
    for (int step = 0; step < 6; ++step) simulation.advance(1e9);
    CHECK(simulation.timings().size() >= 8);
    for (const PhaseTime& phase : simulation.timings()) {
        CAPTURE(phase.name);
        const bench::Traffic traffic = bench::traffic_of(phase.name, simulation.flow());
        CHECK(traffic.particle + traffic.node > 0.0);
        CHECK(phase.calls > 0);
        CHECK(phase.cpu_seconds == 0.0);  // not asked for
    }
    Mpm3d space(bench::body_scene(bench::BodyLaw::bingham, 1000));
    for (int step = 0; step < 3; ++step) space.advance(1e9);
    for (const PhaseTime& phase : space.timings()) {
        CAPTURE(phase.name);
        const bench::Traffic traffic = bench::traffic_of(phase.name, space.body());
        CHECK(traffic.particle + traffic.node > 0.0);
    }
    const bench::Cost& cost = bench::find(report(), "depth_averaged", 4000, 1)->cost;
    double sum = 0.0;
    for (const bench::PhaseCost& phase : cost.phases)
        if (phase.name != "full") sum += phase.cpu_ns;
    CHECK(sum == Approx(cost.full().cpu_ns).epsilon(1e-6));
    CHECK(cost.phases.back().name == "other");
    CHECK(cost.phases.back().cpu_ns < 0.2 * sum);  // a phase that nobody records would hide there
}

TEST_CASE("Memory per point counts at least the arrays and the copy of one in the sort", "[bench]") {
    const bench::Cost& cost = bench::find(report(), "depth_averaged", 4000, 1)->cost;
    CHECK(cost.bytes_per_particle >= 16 * 8);
}

TEST_CASE("A gate that was not measured is not met", "[bench]") {
    bool seen = false;
    for (const bench::Gate& gate : bench::gates(report())) {
        CHECK((!std::isnan(gate.measured) || !gate.met()));
        seen |= !std::isnan(gate.measured);
    }
    CHECK(seen);
    bench::Options one = tiny();
    one.particles = {1000};
    bench::Report alone;
    alone.options = one;
    for (const bench::Gate& gate : bench::gates(alone)) CHECK_FALSE(gate.met());
}

namespace {

/// Notes what it is shown.
struct Shown {
    std::size_t particle_fields = 0, node_fields = 0, frames = 0;
};
class Witness final : public Observer {
public:
    explicit Witness(Shown& shown) : shown_(shown) {}
    std::string name() const override { return "witness"; }
    void observe(const Frame& frame) override {
        CHECK(frame.number == static_cast<Index>(shown_.frames++));
        shown_.particle_fields = frame.particles.size();
        shown_.node_fields = frame.nodes.size();
    }

private:
    Shown& shown_;
};

}  // namespace

TEST_CASE("bench shows twelve particle fields to writers of particles, the grid to others, and cleans up", "[bench]") {
    const FreshFolder above;
    Shown points, grid;
    const auto costs =
        bench::time_frames(1000,
                           {{bench::kGatedWriter, true, false,
                             [&](const auto& folder) {
                                 CHECK(std::filesystem::is_directory(folder));
                                 return std::make_unique<Witness>(points);
                             }},
                            {"grid", false, true, [&](const auto&) { return std::make_unique<Witness>(grid); }}},
                           above.path());
    CHECK(std::filesystem::is_empty(above.path()));
    CHECK(points.particle_fields == 12);
    CHECK(points.node_fields == 0);
    CHECK(points.frames > 1);
    CHECK(grid.particle_fields == 1);  // the position, for writers that cannot do without
    CHECK(grid.node_fields > 10);
    REQUIRE(costs.size() == 3);
    for (const bench::FrameCost& cost : costs) CHECK((cost.seconds > 0.0 && cost.steps > 0.0));
    CHECK(costs[1].fields == 12);
    CHECK(bench::steps_of(costs, bench::kGatedWriter) == Approx(costs[0].steps + costs[1].steps));
    CHECK(std::isnan(bench::steps_of(costs, "nobody")));
}

TEST_CASE("bench refuses particles and threads that cannot be", "[bench]") {
    bench::Options options = tiny();
    options.particles = {5};
    CHECK_THROWS_WITH(bench::run(options, [](const std::string&) {}),
                      "--particles: found 5; expected 1000 to 100000000; choose a number in this range");
    options = tiny();
    options.threads = {0};
    CHECK_THROWS_AS(bench::run(options, [](const std::string&) {}), UserError);
}
