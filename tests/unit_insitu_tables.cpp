// What is looked at between the outputs: when, what stands in the tables, and that nothing of it touches the run.
#include <cstring>
#include <sstream>

#include "analytic_scene.h"
#include "catch.h"
#include "fake_simulation.h"
#include "fresh_folder.h"
#include "observe/insitu.h"
#include "observe/insitu_tables.h"
#include "observe/table.h"
#include "run/run_loop.h"

using namespace frana;
namespace fs = std::filesystem;

namespace {

/// Notes down the times; fails at the wish of the test.
class Diary final : public InsituWork {
public:
    explicit Diary(std::vector<double>& times, Index fail_until = 0) : times_(times), fail_until_(fail_until) {}
    void sample(const Frame& frame, Index number) override {
        if (calls_++ < fail_until_) throw UserError("the disk is full");
        CHECK(number == static_cast<Index>(times_.size()));
        times_.push_back(frame.status.time);
    }

private:
    std::vector<double>& times_;
    Index fail_until_, calls_ = 0;
};

RunSummary run_with(Simulation& simulation, const RunPlan& plan, const InsituTimes& times,
                    std::unique_ptr<InsituWork> work, InsituTally& tally) {
    Observers observers;
    observers.push_back(std::make_unique<InsituObserver>(times, std::move(work), tally));
    std::ostringstream stream;
    Progress progress(stream, Progress::Style::silent, FakeSimulation::density);
    return run(simulation, plan, observers, Interrupt(), progress);
}

/// Times of the looks at the fake, whose longest step is 0.03 s, with outputs every 0.5 s up to 1 s.
std::vector<double> looks(const InsituTimes& times) {
    std::vector<double> seen;
    FakeSimulation simulation;
    InsituTally tally{"diary", "test", 0, 0, ""};
    run_with(simulation, {1.0, 0.5, false}, times, std::make_unique<Diary>(seen), tally);
    CHECK(tally.made == static_cast<Index>(seen.size()));
    CHECK(tally.failed == 0);
    return seen;
}

const GridGeometry small{4, 3, 100.0, 200.0, 2.0};

/// A frame of 4 x 3 nodes with numbers to do sums with by hand; the last node has no terrain.
struct SmallFrame {
    std::vector<double> elevation, depth, velocity;
    Frame frame;

    SmallFrame() {
        for (int k = 0; k < 12; ++k) {
            elevation.push_back(k == 11 ? Raster::nodata : 10.0 * k);
            depth.push_back(k < 8 ? 0.5 * k : 0.0);
            velocity.insert(velocity.end(), {1.0 * k, -2.0 * k, 0.0});
        }
        frame.status.time = 2.5;
        frame.grid = small;
        frame.nodes = {{"elevation", "m", 1, elevation.data(), 12},
                       {"depth", "m", 1, depth.data(), 12},
                       {"velocity", "m/s", 3, velocity.data(), 12}};
    }
};

}  // namespace

TEST_CASE("Nodes that the flow never came to are in no statistics and on no line of arrivals", "[insitu]") {
    SmallFrame small_frame;
    std::vector<double> arrival(12, -1.0);
    arrival[5] = 2.0, arrival[6] = 3.0;
    small_frame.frame.nodes.push_back({"arrival_time", "s", 1, arrival.data(), 12});
    const FreshFolder folder;
    const fs::path csv = folder.path() / "reduce.csv";
    make_reduction(csv, {"arrival_time"}, 0.1)->sample(small_frame.frame, 0);  // nodes 1 to 7 are deeper
    const Table table = read_table(csv);
    CHECK(table.column("arrival_time_min").at(0) == 2.0);
    CHECK(table.column("arrival_time_max").at(0) == 3.0);
    CHECK(table.column("arrival_time_mean").at(0) == 2.5);
    const Scalar values = scalar(small_frame.frame.nodes, "arrival_time", "the grid");
    CHECK(value_at(values, small, {103.0, 202.0}) == Approx(2.5));  // between nodes 5 and 6
    CHECK(std::isnan(value_at(values, small, {101.0, 202.0})));     // between nodes 4 and 5
}

TEST_CASE("Without times of its own, in-situ samples at every output", "[insitu]") {
    CHECK(looks({}) == std::vector<double>{0.0, 0.5, 1.0});
}

TEST_CASE("A time interval samples the first state at or past each multiple, and at the end", "[insitu]") {
    // 0.03 s a step from 0, cut at the outputs: 0.21 and 0.42 are the first past 0.2 and 0.4; after 0.5 come 0.62, 0.80
    const std::vector<double> seen = looks({0.2, {}});
    REQUIRE(seen.size() == 6);
    const double expected[] = {0.0, 0.21, 0.42, 0.62, 0.80, 1.0};
    for (std::size_t i = 0; i < 6; ++i) CHECK(seen[i] == Approx(expected[i]).epsilon(1e-12));
    CHECK(looks({0.5, {}}) == std::vector<double>{0.0, 0.5, 1.0});
    CHECK(looks({0.9, {}}).size() == 3);  // the start, just past 0.9 s, the end
}

TEST_CASE("A number of steps samples that often, and at the end", "[insitu]") {
    const std::vector<double> seen = looks({{}, 10});  // 17 + 17 steps
    REQUIRE(seen.size() == 5);
    CHECK(seen[1] == Approx(0.3).epsilon(1e-12));
    CHECK(seen[4] == 1.0);
}

TEST_CASE("A work that fails is counted with its first reason, and the run goes on", "[insitu]") {
    std::vector<double> seen;
    FakeSimulation simulation;
    InsituTally tally{"diary", "test", 0, 0, ""};
    const RunSummary summary = run_with(simulation, {1.0, 0.25, false}, {}, std::make_unique<Diary>(seen, 2), tally);
    CHECK(summary.reason == "end");
    CHECK(summary.last.time == 1.0);
    CHECK(tally.failed == 2);
    CHECK(tally.made == 3);
    CHECK(tally.first_failure == "t = 0 s: the disk is full");
    REQUIRE(summary.output.size() == 2);
    CHECK(summary.output[0].name == "insitu diary");
}

TEST_CASE("Looking after every step leaves the run the same to the last bit", "[insitu]") {
    const auto end_state = [](const InsituTimes& times) {
        Scene scene = test::scene_on(40, 30, 1.0, [](double x, double y) { return 40 - 0.5 * x + 0.1 * y; });
        scene.bed_law = bed::Voellmy{0.2, 500};
        scene.rheology = rheology::Bingham{100.0, 50.0};
        test::fill(scene, [](double x, double y) { return std::hypot(x - 12, y - 15) < 6 ? 2.0 : 0.0; });
        DepthAveraged simulation(scene);
        std::vector<double> seen;
        InsituTally tally{"diary", "test", 0, 0, ""};
        run_with(simulation, {2.0, 1.0, false}, times, std::make_unique<Diary>(seen), tally);
        const Frame frame = simulation.frame();
        std::vector<double> state;
        for (const Field& field : frame.particles)
            state.insert(state.end(), field.data, field.data + field.count * field.components);
        state.push_back(static_cast<double>(seen.size()));
        return state;
    };
    std::vector<double> alone = end_state({}), watched = end_state({{}, 1});
    CHECK(alone.back() == 3.0);
    CHECK(watched.back() > 10.0);
    alone.pop_back(), watched.pop_back();
    REQUIRE(alone.size() == watched.size());
    CHECK(std::memcmp(alone.data(), watched.data(), alone.size() * sizeof(double)) == 0);
}

TEST_CASE("Scalars are found by name, components of vectors and stresses too", "[insitu]") {
    const SmallFrame made;
    const std::optional<Scalar> across = find_scalar(made.frame.nodes, "velocity_y");
    REQUIRE(across);
    CHECK((*across)[3] == -6.0);
    CHECK(across->unit == "m/s");
    CHECK((*find_scalar(made.frame.nodes, "depth"))[7] == 3.5);
    CHECK_FALSE(find_scalar(made.frame.nodes, "velocity"));
    CHECK_FALSE(find_scalar(made.frame.nodes, "stress_xx"));
    CHECK_THROWS_WITH(scalar(made.frame.nodes, "stress_xx", "the grid"),
                      "found no field \"stress_xx\" of the grid; expected one of elevation, depth, velocity; choose "
                      "one of them");
}

TEST_CASE("A cut has the values of the grid between its nodes, and empty cells where there is no terrain", "[insitu]") {
    const FreshFolder folder;
    const SmallFrame made;
    const fs::path csv = folder.path() / "insitu" / "cut.csv";
    // along the lower row, one node to the next, then up the last column to the node without terrain
    const auto work = make_cut_table(csv, {{100, 200}, {106, 200}, {106, 204}}, {"depth", "velocity_x"});
    work->sample(made.frame, 0);
    work->sample(made.frame, 1);
    const Table table = read_table(csv);
    CHECK(table.columns == std::vector<std::string>{"t", "distance", "x", "y", "bed", "depth", "velocity_x"});
    CHECK(table.units[5] == "m");
    CHECK(table.units[6] == "m/s");
    REQUIRE(table.rows() == 2 * 11);  // stations 1 m apart on 10 m, both ends
    CHECK(table.column("t")[0] == 2.5);
    CHECK(table.column("distance")[10] == 10.0);
    CHECK(table.column("depth")[2] == 0.5);   // at node 1
    CHECK(table.column("depth")[3] == 0.75);  // between nodes 1 and 2
    CHECK(table.column("bed")[3] == 15.0);
    CHECK(table.column("depth")[8] == 3.5);       // node 7
    CHECK(table.column("velocity_x")[7] == 5.0);  // between nodes 3 and 7
    CHECK(std::isnan(table.column("bed")[9]));
    CHECK(std::isnan(table.column("bed")[10]));
    CHECK(table.column("x")[21] == 106.0);
}

TEST_CASE("A reduction has extremes, mean, area and volume of what is deep enough", "[insitu]") {
    const FreshFolder folder;
    SmallFrame made;
    const fs::path csv = folder.path() / "extremes.csv";
    const auto work = make_reduction(csv, {"depth", "velocity_y"}, 2.0);
    work->sample(made.frame, 0);
    std::fill(made.depth.begin(), made.depth.end(), 2.0);  // not above the limit
    work->sample(made.frame, 1);
    const Table table = read_table(csv);
    REQUIRE(table.rows() == 2);
    const auto first = [&](const char* column) { return table.column(column)[0]; };
    // nodes 5, 6 and 7 with depths 2.5, 3 and 3.5 m on pixels of 4 m2
    CHECK(first("area") == 12.0);
    CHECK(first("volume") == 36.0);
    CHECK(first("depth_min") == 2.5);
    CHECK(first("depth_max") == 3.5);
    CHECK(first("depth_max_x") == 106.0);
    CHECK(first("depth_max_y") == 202.0);
    CHECK(first("depth_mean") == 3.0);
    CHECK(first("velocity_y_min") == -14.0);  // at the last of them
    CHECK(first("velocity_y_max") == -10.0);
    CHECK(first("velocity_y_max_x") == 102.0);
    CHECK(first("velocity_y_mean") == -12.0);
    CHECK(table.column("area")[1] == 0.0);
    CHECK(table.column("volume")[1] == 0.0);
    CHECK(std::isnan(table.column("depth_min")[1]));
    CHECK(std::isnan(table.column("depth_max")[1]));
    CHECK(std::isnan(table.column("depth_mean")[1]));
}

TEST_CASE("Where free water is alone damage says nothing, and is not in its statistics", "[insitu]") {
    const FreshFolder folder;
    SmallFrame made;
    std::vector<double> water(12, 0.0), damage(12, 0.0);
    for (std::size_t k = 1; k < 12; ++k)
        if (k < 6)
            water[k] = made.depth[k];  // alone
        else
            damage[k] = 0.25 * static_cast<double>(k - 5), water[k] = 0.25;
    made.frame.nodes.push_back({"water_depth", "m", 1, water.data(), 12});
    made.frame.nodes.push_back({"damage", "1", 1, damage.data(), 12});
    const fs::path csv = folder.path() / "damage.csv";
    const auto work = make_reduction(csv, {"damage", "water_depth"}, 0.1);
    work->sample(made.frame, 0);
    std::copy(made.depth.begin(), made.depth.end(), water.begin());
    work->sample(made.frame, 1);
    const Table table = read_table(csv);
    CHECK(table.column("area")[0] == 28.0);  // nodes 1 to 7
    CHECK(table.column("damage_min")[0] == 0.25);
    CHECK(table.column("damage_max")[0] == 0.5);
    CHECK(table.column("damage_mean")[0] == 0.375);
    CHECK(table.column("water_depth_max")[0] == 2.5);
    CHECK(table.column("area")[1] == 28.0);
    CHECK(std::isnan(table.column("damage_mean")[1]));
}
