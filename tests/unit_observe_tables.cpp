#include <sstream>

#include "catch.h"
#include "fake_simulation.h"
#include "fresh_folder.h"
#include "observe/energy_made.h"
#include "observe/gauges.h"
#include "observe/history.h"
#include "observe/profiles.h"
#include "run/run_loop.h"

using namespace frana;

namespace {

RunSummary watch(Observers& observers, const RunPlan& plan, FakeScript script = {}) {
    FakeSimulation simulation(std::move(script));
    std::ostringstream stream;
    Progress progress(stream, Progress::Style::silent, FakeSimulation::density);
    return run(simulation, plan, observers, Interrupt(), progress);
}

}  // namespace

TEST_CASE("a table reads back the bits that were written") {
    const FreshFolder folder;
    TableWriter writer(folder.path() / "deep" / "a.csv", {"t [s]", "x [m]", "plain"});
    writer.add({0.1, 1.0 / 3.0, 7.0});
    writer.add({0.2, TableWriter::empty, -1e300});
    CHECK_FALSE(std::filesystem::exists(folder.path() / "deep"));  // nothing before the first flush
    writer.flush();
    CHECK(read_table(folder.path() / "deep" / "a.csv").rows() == 2);
    writer.add({3.0, 5e-324, 123456789012345.0});
    writer.flush();
    const Table table = read_table(folder.path() / "deep" / "a.csv");
    CHECK(table.columns == std::vector<std::string>{"t", "x", "plain"});
    CHECK(table.units == std::vector<std::string>{"s", "m", ""});
    REQUIRE(table.rows() == 3);
    CHECK(table.column("t")[0] == 0.1);
    CHECK(table.column("x")[0] == 1.0 / 3.0);
    CHECK(std::isnan(table.column("x")[1]));
    CHECK(table.column("plain")[1] == -1e300);
    CHECK(table.column("x")[2] == 5e-324);
    CHECK(table.column("plain")[2] == 123456789012345.0);
    CHECK_FALSE(table.has("y"));
    CHECK_THROWS_WITH(table.column("y"), Catch::Contains("no column \"y\"; found t, x, plain"));
}

TEST_CASE("a table that was cut short or changed is refused with its line") {
    const FreshFolder folder;
    const auto file = folder.path() / "a.csv";
    CHECK_THROWS_AS(read_table(file), UserError);
    std::ofstream(file) << "t,x\n1,2\n3\n";
    CHECK_THROWS_WITH(read_table(file), Catch::Contains("a.csv:3: 1 cells, expected 2"));
    std::ofstream(file) << "t,x\n1,two\n";
    CHECK_THROWS_WITH(read_table(file), Catch::Contains("a.csv:2: found \"two\""));
}

TEST_CASE("a table in a folder that cannot be made is a user error") {
    const FreshFolder folder;
    std::ofstream(folder.path() / "file") << "x";
    CHECK_THROWS_AS(TableWriter(folder.path() / "file" / "a.csv", {"t"}).flush(), UserError);
}

TEST_CASE("history holds a line per step with the simulation's own numbers") {
    const FreshFolder folder;
    Observers observers;
    observers.push_back(std::make_unique<History>(folder.path(), History::Lines::per_step));
    const RunSummary summary = watch(observers, {1.0, 0.25, false});
    const Table table = read_table(folder.path() / "history.csv");
    REQUIRE(table.rows() == static_cast<std::size_t>(summary.steps) + 1);
    const std::size_t last = table.rows() - 1;
    const Status& now = summary.last;
    CHECK(table.column("t")[0] == 0.0);
    CHECK(table.column("step")[last] == static_cast<double>(now.step));
    CHECK(table.column("t")[last] == now.time);
    CHECK(table.column("dt")[last] == now.dt);
    CHECK(table.column("particles")[last] == 25.0);
    CHECK(table.column("mass")[last] == now.mass);
    CHECK(table.column("mass_left")[last] == now.mass_left);
    CHECK(table.column("momentum_x")[last] == now.momentum[0]);
    CHECK(table.column("momentum_y")[last] == now.momentum[1]);
    CHECK(table.column("impulse_x")[last] == now.impulse[0]);
    CHECK(table.column("impulse_y")[last] == now.impulse[1]);
    CHECK(table.column("kinetic")[last] == now.kinetic);
    CHECK(table.column("potential")[last] == now.potential);
    CHECK(table.column("dissipated")[last] == now.dissipated);
    CHECK(table.column("energy_left")[last] == now.energy_left);
    CHECK(table.column("max_depth")[last] == now.max_depth);
    CHECK(table.column("max_speed")[last] == now.max_speed);
    CHECK(table.column("mean_speed")[last] == now.mean_speed);
    CHECK(table.column("covered_area")[last] == now.covered_area);
    CHECK(table.column("front")[last] == now.front);
    CHECK(table.column("p2g_mass_error")[last] == now.p2g_mass_error);
    CHECK(table.column("p2g_momentum_error")[last] == now.p2g_momentum_error);
    const Budget left_over = budget(summary.first, now);
    CHECK(table.column("mass_error")[last] == left_over.mass_error);
    CHECK(table.column("momentum_residual_x")[last] == left_over.momentum_residual[0]);
    CHECK(table.column("momentum_residual_y")[last] == left_over.momentum_residual[1]);
    CHECK(table.column("energy_residual")[last] == left_over.energy_residual);
}

TEST_CASE("energy that nothing gave is told by its share of what the flow turned over") {
    Status first, now;
    first.kinetic = 5.0, first.potential = 100.0, first.dissipated = 1.0;
    now.kinetic = 20.0, now.potential = 50.0, now.dissipated = 31.0;
    CHECK(share_made(first, now) == 0.0);  // 5 J are missing
    now.potential = 60.0;
    CHECK(share_made(first, now) == Approx(5.0 / 50.0));
    CHECK(share_made(first, first) == 0.0);
    Status lake = first;  // at rest on a mountain: what it turns over is round-off, as what seems made is
    first.potential = lake.potential = 5e11, lake.potential += 1e-3, lake.kinetic = first.kinetic = 0.0;
    lake.dissipated += 1e-20;
    CHECK(share_made(first, lake) == 0.0);
}

// A lake of 200 t and 0.24 m that made 1.9 J, and run-off of which 0.2 % was left, were said to be too fast.
TEST_CASE("energy that a lake or the rest of a run-off made is told by what they could turn over") {
    Status first, now;
    first.mass = now.mass = 2e5, first.max_depth = now.max_depth = 0.24;
    now.potential = 1.9, now.dissipated = 10.0;
    CHECK(share_made(first, now) < 5e-3);
    now.potential = 1e3;  // a fifth of 1 % of m g h
    CHECK(share_made(first, now) > 0.1);
    Status start, film;
    start.mass = 116619.0, start.max_depth = 0.017;
    film.mass = 240.0, film.mass_left = 116379.0, film.kinetic = 52342.0, film.dissipated = 105.0;
    film.energy_left = 1.5e5 - 52447.0;
    CHECK(share_made(start, film) == Approx(1.5e5 / (52342.0 / 240.0 * 116619.0)).epsilon(0.01));
    film.mass = 116619.0, film.mass_left = 0.0;  // nothing has left
    CHECK(share_made(start, film) > 2.0);
}

TEST_CASE("history per output holds a line per frame, also when the run is interrupted between frames") {
    const FreshFolder folder;
    Observers observers;
    observers.push_back(std::make_unique<History>(folder.path(), History::Lines::per_output));
    watch(observers, {1.0, 0.25, true}, {0.03, 0.6, 1e9, 1e9, false, {}});
    const std::vector<double> t = read_table(folder.path() / "history.csv").column("t");
    REQUIRE(t.size() == 4);
    CHECK(t[2] == 0.5);
    CHECK(t[3] >= 0.6);
}

TEST_CASE("history can be read after every output while the run goes on") {
    const FreshFolder folder;
    Observers observers;
    observers.push_back(std::make_unique<History>(folder.path(), History::Lines::per_step));
    std::size_t rows_seen = 0;
    FakeScript script;
    script.on_step = [&](Index step) {
        const std::size_t rows = read_table(folder.path() / "history.csv").rows();
        CHECK(rows >= rows_seen);
        if (step > 1) CHECK(rows >= 1);
        rows_seen = rows;
    };
    watch(observers, {0.5, 0.1, false}, script);
    CHECK(rows_seen > 5);
}

TEST_CASE("gauges hold the flow at their points after every step") {
    const FreshFolder folder;
    const Vec2 bridge(1012.25, 2018.75);
    Observers observers;
    observers.push_back(std::make_unique<Gauges>(folder.path(), std::vector<GaugePoint>{{"bridge", bridge}}));
    const RunSummary summary = watch(observers, {1.0, 0.25, false});
    const Table table = read_table(folder.path() / "gauges" / "bridge.csv");
    REQUIRE(table.rows() == static_cast<std::size_t>(summary.steps) + 1);
    for (std::size_t k = 0; k < table.rows(); ++k) {
        const double h = FakeSimulation::depth(bridge, table.column("t")[k]);
        CHECK(table.column("depth")[k] == h);
        CHECK(table.column("bed")[k] == FakeSimulation::bed(bridge));
        CHECK(table.column("surface")[k] == FakeSimulation::bed(bridge) + h);
        CHECK(table.column("speed")[k] ==
              Approx(FakeSimulation::kSteep * std::hypot(FakeSimulation::u, FakeSimulation::v)));
        CHECK(table.column("velocity_y")[k] == FakeSimulation::v);
    }
    CHECK(table.units[table.columns.size() - 1] == "m/s");
}

TEST_CASE("stations run from end to end at equal distances and take every corner") {
    const std::vector<Station> found = stations({{0, 0}, {3, 4}, {3, 4}, {3, 5.2}}, 1.0);
    REQUIRE(found.size() == 5 + 2 + 1);
    CHECK(found.front().point == Vec2(0, 0));
    CHECK((found[5].point - Vec2(3, 4)).norm() < 1e-14);
    CHECK((found[5].along - Vec2(0, 1)).norm() < 1e-14);
    CHECK((found[4].along - Vec2(0.6, 0.8)).norm() < 1e-14);
    CHECK((found.back().point - Vec2(3, 5.2)).norm() < 1e-14);
    for (std::size_t k = 1; k <= 5; ++k) CHECK(found[k].distance == Approx(static_cast<double>(k)));
    CHECK(found[6].distance == Approx(5.6));
    CHECK(found.back().distance == Approx(6.2));
    CHECK(stations({{1, 1}, {1, 1}}, 1.0).empty());
}

TEST_CASE("profiles equal the field on the nodes, with velocity along and across the line") {
    const FreshFolder folder;
    // from node to node: every other station stands on a node, where nothing is interpolated
    Observers observers;
    observers.push_back(std::make_unique<Profiles>(
        folder.path(), std::vector<ProfileLine>{{"down", {{1010.5, 2030.5}, {1010.5, 2000.5}}}}));
    watch(observers, {1.0, 0.5, false});
    const Table table = read_table(folder.path() / "profiles" / "down.csv");
    REQUIRE(table.rows() == 3 * 61);  // three outputs, stations half a cell apart on 30 m
    int wet = 0;
    for (std::size_t k = 0; k < table.rows(); ++k) {
        const Vec2 point(table.column("x")[k], table.column("y")[k]);
        CHECK(table.column("bed")[k] == Approx(FakeSimulation::bed(point)).epsilon(1e-13));
        CHECK(table.column("distance")[k] == Approx(2030.5 - point.y()));
        CHECK(table.column("surface")[k] == table.column("bed")[k] + table.column("depth")[k]);
        const double exact = FakeSimulation::depth(point, table.column("t")[k]);
        const bool on_node = k % 61 % 2 == 0;
        // between nodes a parabola's error of cell^2/8 times the largest curvature, height / width^2
        const double tolerance = on_node ? 1e-6 : FakeSimulation::height / (8.0 * 9.0);
        CHECK(std::abs(table.column("depth")[k] - exact) <= tolerance);
        if (table.column("depth")[k] <= 0.0) continue;
        ++wet;
        CHECK(table.column("velocity_along")[k] == Approx(-FakeSimulation::v));
        CHECK(table.column("velocity_across")[k] == Approx(FakeSimulation::u));
    }
    CHECK(wet > 100);
}

TEST_CASE("outside the grid a profile has distance and place, but no bed") {
    const FreshFolder folder;
    Observers observers;
    observers.push_back(std::make_unique<Profiles>(
        folder.path(), std::vector<ProfileLine>{{"out", {{990.0, 2010.0}, {1005.0, 2010.0}}}}));
    watch(observers, {0.1, 0.1, false});
    const Table table = read_table(folder.path() / "profiles" / "out.csv");
    CHECK(std::isnan(table.column("bed").front()));
    CHECK(std::isnan(table.column("surface").front()));
    CHECK(table.column("depth").front() == 0.0);
    CHECK(std::isfinite(table.column("bed").back()));
}
