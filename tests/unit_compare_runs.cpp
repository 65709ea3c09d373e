// Runout, deposits and whole comparisons with answers found by hand.
#include <array>
#include <cmath>

#include "catch.h"
#include "compare/comparison.h"

using namespace frana;

namespace {

constexpr double cell = 10.0;

/// 600 x 200 m; the pixels' outer edge starts at (0, 0).
GridGeometry slope_grid() { return {60, 20, 0.5 * cell, 0.5 * cell, cell}; }

template <class Value>
Raster made(const Value& value) {
    Raster raster = Raster::filled(slope_grid(), 0.0);
    const GridGeometry& g = raster.geometry;
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) raster.at(i, j) = value(g.x(i), g.y(j));
    return raster;
}

bool within(double x, double y, double x0, double y0, double x1, double y1) {
    return x > x0 && x < x1 && y > y0 && y < y1;
}

Polygon box(double x0, double y0, double x1, double y1) { return Polygon{{{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}}}; }

/// A flow along x from 50 m to `front`, 100 m wide; it rests on the last 100 m of it. Released at x < 100 m.
struct ComparedFlow {
    Raster bed, peak, last, arrival;

    explicit ComparedFlow(double front) {
        bed = made([](double x, double) { return 300.0 - 0.5 * x; });
        peak = made([&](double x, double y) { return within(x, y, 50, 50, front, 150) ? 2.0 : 0.0; });
        last = made([&](double x, double y) { return within(x, y, front - 100, 50, front, 150) ? 1.0 : 0.0; });
        arrival = made([&](double x, double y) {
            return within(x, y, 50, 50, 100, 150) ? 0.0 : x < front ? x / 20.0 : Raster::nodata;
        });
    }
    SimulatedRun run() const {
        SimulatedRun run;
        run.peak_depth = &peak;
        run.final_depth = &last;
        run.arrival_time = &arrival;
        run.bed = &bed;
        return run;
    }
};

}  // namespace

TEST_CASE("On a plane the steepest path runs straight down to the edge") {
    const ComparedFlow flow(300);
    const Polyline path = steepest_path(flow.bed, {75, 105});
    REQUIRE(path.size() == 53);  // nodes from 75 m to 595 m
    for (const Vec2& p : path) CHECK(p.y() == Approx(105));
    CHECK(path.front().x() == Approx(75));
    CHECK(path.back().x() == Approx(595));
    CHECK(length_of(path) == Approx(520));
}

TEST_CASE("The steepest path leaves a hollow over its lowest edge, and does not run on for ever") {
    // a trough with a dam across it at x = 300 m, with a gap in its north that is lower than the trough's sides
    const Raster bed = made([](double x, double y) {
        const bool dam = std::abs(x - 300.0) < 12.0 && y < 150.0;
        return 300.0 - 0.5 * x + 0.2 * std::abs(y - 105.0) + (dam ? 60.0 : 0.0);
    });
    const Polyline path = steepest_path(bed, {55, 55});
    CHECK(path.back().x() == Approx(595));
    double at_dam = 0.0;
    for (const Vec2& p : path)
        if (std::abs(p.x() - 300.0) < 6.0) at_dam = std::max(at_dam, p.y());
    // Through the gap, whose first nodes are at 155 m. At the top of a way up and down along y, the mean over eleven
    // nodes is lower by 10 m x 2 (1 + ... + 5) / 11 = 27.3 m; less for any gentler bend.
    CHECK(at_dam > 155.0 - 27.4);
    const Raster flat = made([](double, double) { return 1.0; });
    CHECK(length_of(steepest_path(flat, {305, 105})) > 0.0);
    CHECK(steepest_path(bed, {-500, 55}).empty());
}

TEST_CASE("The farthest point of an outline counts along a path, also round a bend and beyond its end") {
    const Polyline bend = {{0, 0}, {100, 0}, {100, 100}};
    const auto reach = [&](const Polygon& outline) { return reach_along(bend, outline.rings, 1.0); };
    CHECK(reach(box(-10, -10, 60, 10)) == Approx(60));
    CHECK(reach(box(80, 20, 120, 70)) == Approx(170));   // up the second leg
    CHECK(reach(box(90, 50, 110, 130)) == Approx(230));  // 30 m beyond the end
    CHECK(std::isnan(reach_along(bend, {}, 1.0)));
}

TEST_CASE("Beyond the end of a path only what lies in front of it counts") {
    const Polyline bend = {{0, 0}, {100, 0}, {100, 100}};
    const auto place = [&](double x, double y) { return place_along(bend, {x, y}).place; };
    CHECK(place(110, 140) == Approx(240));
    CHECK(place(139, 140) == Approx(240));  // not yet 45 degrees off
    CHECK(place(141, 140) == Approx(239));  // less by what it lies farther aside than ahead
    CHECK(place(180, 140) == Approx(200));
    CHECK(place(190, 140) == Approx(200));
    CHECK(place_along(bend, {141, 140}).off_end);
    CHECK_FALSE(place_along(bend, {110, 140}).off_end);
    // A path that comes back at its end: its last segment's extension runs over the first ones.
    const Polyline hook = {{0, 0}, {300, 0}, {300, 100}, {290, 100}};
    CHECK(place_along(hook, {50, 40}).place == Approx(50));
    CHECK(place_along(hook, {280, 95}).place == Approx(420));
    const FrontAlong front = front_along(bend, box(100, 100, 300, 140).rings, 1.0);
    CHECK(front.place == Approx(240));
    CHECK(turns_off(front, 50.0));
    CHECK_THAT(remark_on_turn(front, 50.0), Catch::Contains("lies up to 204 m aside of that end"));  // 200 and 40 m
    CHECK(remark_on_turn(front_along(bend, box(50, -20, 120, 140).rings, 1.0), 50.0).empty());
}

TEST_CASE("The runout beyond the end of a path has no step, and a flow that stops before it does not turn off") {
    const Polyline path = {{0, 0}, {1000, 0}};
    const auto reach = [&](double front) { return reach_along(path, box(500, 40, front, 100).rings, 1.0); };
    CHECK(reach(1010) == Approx(1000));
    CHECK(reach(1030) == Approx(1020));  // 30 m ahead, 40 m aside
    CHECK(reach(1039) == Approx(1038));
    CHECK(reach(1041) == Approx(1041));
    const FrontAlong wide = front_along(path, box(900, -200, 960, 200).rings, 1.0);
    CHECK(wide.place == Approx(960));
    CHECK_FALSE(turns_off(wide, 50.0));
    CHECK(turns_off(front_along(path, box(900, -200, 1001, 200).rings, 1.0), 50.0));
}

TEST_CASE("The steepest path ends where it meets the edge of the terrain, but passes by a hole in it", "[nan]") {
    // falls to the north-west everywhere; along the northern edge it would go on to the west
    Raster bed = made([](double x, double y) { return 1000.0 + 0.4 * x - 0.5 * y; });
    const Polyline path = steepest_path(bed, {505, 55});
    CHECK(path.back().y() == Approx(195));
    CHECK(path.back().x() == Approx(505 - 140));
    CHECK(length_of(path) == Approx(140 * std::sqrt(2.0)));
    for (const double x : {445.0, 455.0, 465.0}) bed.at(static_cast<Index>(x / cell), 13) = Raster::nodata;  // y = 135
    CHECK(steepest_path(bed, {505, 55}).back().y() == Approx(195));
    // nodata that reaches the grid's edge is not of the terrain
    for (Index j = 10; j < 20; ++j)
        for (Index i = 0; i < 60; ++i) bed.at(i, j) = Raster::nodata;
    const Polyline shorter = steepest_path(bed, {505, 55});
    CHECK(shorter.back().y() == Approx(95));
    CHECK(shorter.back().x() == Approx(505 - 40));
    // one that starts on the edge leaves it first
    CHECK(steepest_path(made([](double x, double y) { return x + y; }), {595, 105}).back().y() == Approx(5));
}

TEST_CASE("A path that touches the edge of the terrain and turns back inside goes on") {
    // a trough along x, whose bottom is on the northern row of nodes from 275 to 325 m
    const Raster bed = made([](double x, double y) {
        return 300.0 - 0.5 * x + 0.4 * std::abs(y - (195.0 - 0.5 * std::max(0.0, std::abs(x - 300.0) - 25.0)));
    });
    const Polyline path = steepest_path(bed, {105, 105});
    CHECK(path.back().x() == Approx(595));
    CHECK(path.back().y() == Approx(195 - 0.5 * (295 - 25)).margin(0.5 * cell));
    double northernmost = 0.0;
    for (const Vec2& p : path) northernmost = std::max(northernmost, p.y());
    CHECK(northernmost > 185.0);
}

TEST_CASE("Flows that do not meet have a runout each, those that join have one", "[compare]") {
    // two valleys down along x, at y = 55 and y = 145 m, with a ridge of 27 m between; flows of 30 m width in each
    const auto sides = [](double y) { return 0.6 * std::min(std::abs(y - 55.0), std::abs(y - 145.0)); };
    const auto covered = [](double x, double y) {
        return within(x, y, 50, 40, 250, 70) || within(x, y, 50, 130, 450, 160);
    };
    ComparedFlow flow(300);
    flow.bed = made([&](double x, double y) { return 300.0 - 0.5 * x + sides(y); });
    flow.peak = made([&](double x, double y) { return covered(x, y) ? 2.0 : 0.0; });
    flow.last = flow.peak;
    flow.arrival = made([&](double x, double y) {
        const bool there = within(x, y, 50, 40, 110, 70) || within(x, y, 50, 130, 100, 160);
        return there ? 0.0 : covered(x, y) ? x / 20.0 : Raster::nodata;
    });
    Survey survey;
    survey.footprint = {{box(50, 40, 280, 70), box(50, 130, 400, 160)}, "", "survey.geojson"};
    const Comparison c = compare(flow.run(), survey);
    const Vec2 start = c.path.front();
    CHECK(start.y() == Approx(55));  // of the larger one
    const auto from_start = [&](double x) { return Approx(x - start.x()).margin(cell * (std::sqrt(2.0) - 1.0)); };
    CHECK(c.trace.runout == from_start(250));
    CHECK(c.final->runout == from_start(250));
    CHECK(c.surveyed_runout == from_start(280));
    REQUIRE(c.others.size() == 1);
    CHECK(c.others[0].path.front().y() == Approx(145));
    CHECK(c.others[0].simulated == Approx(450 - c.others[0].path.front().x()));
    CHECK(c.others[0].surveyed == Approx(400 - c.others[0].path.front().x()));
    REQUIRE(c.remarks.size() == 1);
    CHECK_THAT(c.remarks[0], Catch::Contains("; the runout is that from"));

    flow.bed = made([&](double x, double) { return 300.0 - 0.5 * x; });  // no ridge between: two flows all the same
    const Comparison slope = compare(flow.run(), survey);
    CHECK(slope.trace.runout == from_start(250));
    REQUIRE(slope.others.size() == 1);
    CHECK(slope.others[0].simulated == Approx(450 - slope.others[0].path.front().x()));
    flow.peak = made([&](double x, double y) { return covered(x, y) || within(x, y, 50, 40, 80, 160) ? 2.0 : 0.0; });
    CHECK(compare(flow.run(), survey).others.empty());  // they touch
    CHECK(compare(flow.run(), survey).trace.runout == from_start(450));
}

TEST_CASE("Where gullies join, a flow that stopped before has its own runout, and one that went on has its own",
          "[compare]") {
    // Down along x at y = 55 and y = 145 m, both into the first from x = 300 m on.
    const auto sides = [](double x, double y) {
        const double second = 145.0 - 90.0 * std::clamp((x - 200.0) / 100.0, 0.0, 1.0);
        return 0.6 * std::min(std::abs(y - 55.0), std::abs(y - second));
    };
    ComparedFlow flow(300);
    flow.bed = made([&](double x, double y) { return 300.0 - 0.5 * x + sides(x, y); });
    const auto second = [](double x, double y) {
        const double middle = 145.0 - 90.0 * std::clamp((x - 200.0) / 100.0, 0.0, 1.0);
        return x > 50.0 && x < 450.0 && std::abs(y - middle) < 20.0;
    };
    const auto released = [](double x, double y) {
        return within(x, y, 50, 40, 110, 70) || within(x, y, 50, 130, 100, 160);
    };
    const auto compared = [&](double first_front) {
        const auto covered = [&](double x, double y) { return within(x, y, 50, 40, first_front, 70) || second(x, y); };
        flow.peak = made([&](double x, double y) { return covered(x, y) ? 2.0 : 0.0; });
        flow.last = flow.peak;
        flow.arrival = made([&](double x, double y) {
            return released(x, y) ? 0.0 : covered(x, y) ? x / 20.0 : Raster::nodata;
        });
        Survey survey;
        survey.footprint = {{box(50, 40, 480, 70)}, "", "survey.geojson"};
        return compare(flow.run(), survey);
    };
    const Comparison short_of_it = compared(180);
    CHECK(short_of_it.trace.runout == Approx(180 - short_of_it.path.front().x()).margin(cell));
    REQUIRE(short_of_it.others.size() == 1);
    const OtherRunout& other = short_of_it.others[0];
    CHECK(other.path.front().y() == Approx(145));
    CHECK(other.simulated > 450 - other.path.front().x());  // and it goes aslant
    CHECK(other.surveyed - other.simulated == Approx(30).margin(cell));
    CHECK(compared(320).others.empty());
}

TEST_CASE("A flow that leaves the steepest path has a runout along its own track", "[compare]") {
    // The path goes straight down along x; the flow turns off after 100 m, to the south-east.
    ComparedFlow flow(300);
    flow.bed = made([](double x, double y) { return 300.0 - 0.5 * x + 0.001 * std::abs(y - 155.0); });
    const auto middle = [](double x) { return 155.0 - 0.5 * std::max(0.0, x - 100.0); };
    const auto covered = [&](double x, double y) { return x > 50.0 && x < 350.0 && std::abs(y - middle(x)) < 20.0; };
    flow.peak = made([&](double x, double y) { return covered(x, y) ? 2.0 : 0.0; });
    flow.last = flow.peak;
    flow.arrival = made([&](double x, double y) { return covered(x, y) ? (x < 80.0 ? 0.0 : 1.0) : Raster::nodata; });
    Survey survey;
    survey.footprint = {{box(50, 20, 360, 180)}, "", "survey.geojson"};
    const Comparison c = compare(flow.run(), survey);
    CHECK(c.path_source == "track of the flow from the release");
    const double start = c.path.front().x(), aslant = std::hypot(1.0, 0.5);
    // A track over nodes goes along x and the diagonals, before it is smoothed.
    CHECK(c.trace.runout == Approx(100.0 - start + 250.0 * aslant).epsilon(0.03));
    REQUIRE_FALSE(c.remarks.empty());
    CHECK_THAT(c.remarks[0], Catch::Contains("left the steepest path before half of its way"));
    survey.path = Polyline{{60, 155}, {100, 155}, {360, 25}};
    CHECK(compare(flow.run(), survey).remarks.empty());
}

namespace {

struct Valley {
    double bottom, from, to;  ///< along y, and the released places along x [m]
};

/// Three valleys down along x, with ridges of 19 m between; a flow of 30 m width from each release to `front`.
ComparedFlow in_valleys(const std::vector<Valley>& releases, double front) {
    ComparedFlow flow(front);
    flow.bed = made([](double x, double y) {
        return 300.0 - 0.5 * x + 0.6 * std::min({std::abs(y - 35.0), std::abs(y - 105.0), std::abs(y - 165.0)});
    });
    flow.peak = Raster::filled(slope_grid(), 0.0);
    flow.arrival = Raster::filled(slope_grid(), Raster::nodata);
    for (const Valley& v : releases)
        for (Index k = 0; k < slope_grid().size(); ++k) {
            const double x = slope_grid().x(k % 60), y = slope_grid().y(k / 60);
            const auto node = static_cast<std::size_t>(k);
            if (within(x, y, v.from, v.bottom - 15, front, v.bottom + 15)) flow.peak.values[node] = 2.0;
            if (within(x, y, v.from, v.bottom - 15, v.to, v.bottom + 15)) flow.arrival.values[node] = 0.0;
        }
    flow.last = flow.peak;
    return flow;
}

}  // namespace

TEST_CASE("The runout is that of the largest release, also where a small one lies nearer to the middle", "[compare]") {
    ComparedFlow flow = in_valleys({{35, 50, 100}, {165, 50, 100}}, 500);
    flow.arrival.at(10, 10) = 0.0;  // 105, 105 m
    flow.peak.at(10, 10) = 2.0;
    Survey survey;
    survey.footprint = {{box(50, 20, 500, 50), box(50, 150, 500, 180)}, "", "survey.geojson"};
    const Comparison c = compare(flow.run(), survey);
    CHECK(c.path.front() == Vec2(75, 35));
    CHECK(c.trace.runout == Approx(425));
    CHECK(c.surveyed_runout == Approx(425));
    REQUIRE(c.others.size() == 2);
    CHECK(c.others[0].simulated == Approx(425));
    CHECK(c.others[0].surveyed == Approx(425));
}

TEST_CASE("A release beside the path of another valley has no runout of its own", "[compare]") {
    const ComparedFlow flow = in_valleys({{35, 50, 120}, {165, 50, 110}, {145, 300, 320}}, 500);
    Survey survey;
    survey.footprint = {{box(50, 20, 500, 50), box(50, 150, 500, 180)}, "", "survey.geojson"};
    const Comparison c = compare(flow.run(), survey);
    REQUIRE(c.others.size() == 1);
    CHECK(c.others[0].path.front().y() == Approx(165));
    CHECK(c.others[0].simulated == Approx(500 - c.others[0].path.front().x()));
}

TEST_CASE("A flow that turns off at the end of the path is told so", "[compare]") {
    ComparedFlow flow(300);
    Survey survey;
    survey.footprint = {{box(50, 50, 300, 150)}, "", "survey.geojson"};
    survey.path = Polyline{{60, 100}, {150, 100}, {150, 95}};  // ends on the flow, with a bend to the south
    const Comparison c = compare(flow.run(), survey);
    CHECK(c.trace.runout <= 95.0 + 45.0 + 1e-9);
    REQUIRE_FALSE(c.remarks.empty());
    CHECK_THAT(c.remarks.back(),
               Catch::Contains("so the runout of the survey ends with the path; give the whole track"));
}

TEST_CASE("A flow that runs 50 m too far is told so, and both of its extents are scored") {
    const ComparedFlow flow(350);
    Survey survey;
    survey.footprint = {{box(50, 50, 300, 150)}, "", "survey.geojson"};
    const Comparison c = compare(flow.run(), survey);
    CHECK(c.trace.areas.hit == Approx(25000));
    CHECK(c.trace.areas.iou() == Approx(25.0 / 30.0));
    CHECK(c.path_source == "steepest path from the release");
    // the release's middle is the node at 75 m
    CHECK(c.trace.runout == Approx(350 - 75));
    CHECK(c.surveyed_runout == Approx(300 - 75));
    REQUIRE(c.final);
    CHECK(c.final->areas.hit == Approx(5000));
    CHECK(c.final->areas.iou() == Approx(5.0 / 30.0));
    CHECK(c.final->runout - c.surveyed_runout == Approx(50));
    CHECK_FALSE(c.deposit);
    CHECK(c.remarks.empty());
}

TEST_CASE("Where nothing lay at the start, the path begins where material comes in") {
    ComparedFlow flow(350);
    for (double& t : flow.arrival.values)
        if (t == 0.0) t = 1.0;
    Survey survey;
    survey.footprint = {{box(50, 50, 300, 150)}, "", "survey.geojson"};
    SimulatedRun run = flow.run();
    CHECK(std::isnan(compare(run, survey).trace.runout));
    run.starts = {Vec2(66, 104)};
    const Comparison c = compare(run, survey);
    CHECK(c.path_source == "steepest path from where material comes in");
    CHECK(c.trace.runout == Approx(350 - 65));
    CHECK(c.surveyed_runout == Approx(300 - 65));
}

TEST_CASE("Where material comes in at two places, both flows have a runout", "[compare]") {
    ComparedFlow flow = in_valleys({{35, 50, 100}, {165, 50, 100}}, 500);
    for (Index k = 0; k < slope_grid().size(); ++k)  // the second stops earlier
        if (slope_grid().y(k / 60) > 120.0 && slope_grid().x(k % 60) > 300.0)
            flow.peak.values[static_cast<std::size_t>(k)] = 0.0;
    flow.last = flow.peak;
    Survey survey;
    survey.footprint = {{box(50, 20, 450, 50), box(50, 150, 350, 180)}, "", "survey.geojson"};
    SimulatedRun run = flow.run();
    for (double& t : flow.arrival.values)
        if (t == 0.0) t = 1.0;
    run.starts = {Vec2(75, 165), Vec2(75, 35)};
    const auto found = [&] {
        const Comparison c = compare(run, survey);
        REQUIRE(c.others.size() == 1);
        return std::array{c.trace.runout, c.surveyed_runout, c.trace.reach, c.others[0].simulated,
                          c.others[0].surveyed};
    };
    // Corners of outlines are half a width aside of the start.
    const double reach = std::hypot(300.0 - 75.0, 15.0);
    CHECK(found() == std::array{225.0, 275.0, reach, 425.0, 375.0});
    // A release at the start comes before what enters.
    flow.arrival.at(7, 3) = 0.0;
    run.starts = {Vec2(75, 165)};
    CHECK(found() == std::array{425.0, 375.0, std::hypot(425.0, 15.0), 225.0, 275.0});
}

TEST_CASE("A given path is used downhill, and its end is not the end of the runout") {
    const ComparedFlow flow(350);
    Survey survey;
    survey.footprint = {{box(50, 50, 300, 150)}, "", "survey.geojson"};
    survey.path = Polyline{{280, 100}, {80, 100}};
    survey.path_source = "track.geojson";
    const Comparison c = compare(flow.run(), survey);
    CHECK(c.trace.runout == Approx(270));
    CHECK(c.surveyed_runout == Approx(220));
    REQUIRE(c.remarks.size() == 2);
    CHECK_THAT(c.remarks[0], Catch::Contains("turned round"));
    CHECK_THAT(c.remarks[1], Catch::Contains("ends 70 m before"));
}

TEST_CASE("Of a given path that begins beyond the terrain nothing tells that it is drawn downhill", "[nan]") {
    const ComparedFlow flow(350);
    Survey survey;
    survey.footprint = {{box(50, 50, 300, 150)}, "", "survey.geojson"};
    survey.path = Polyline{{-500, 100}, {400, 100}};
    survey.path_source = "track.geojson";
    const Comparison c = compare(flow.run(), survey);
    REQUIRE_FALSE(c.remarks.empty());
    CHECK_THAT(c.remarks[0], Catch::Contains("track.geojson: found an end of the path where the terrain has no elev"));
}

TEST_CASE("A given path that touches neither flow nor survey gives no runouts, and one beside them is told",
          "[compare]") {
    ComparedFlow flow(200);
    Survey survey;
    survey.footprint = {{box(50, 50, 300, 120)}, "", "survey.geojson"};
    survey.path_source = "track.geojson";
    const auto of = [&](const Polyline& path) {
        survey.path = path;
        return compare(flow.run(), survey);
    };
    const Comparison stray = of({{60, 175}, {400, 175}});
    CHECK_THAT(stray.stray_path, Catch::Contains("track.geojson: found a line that touches neither"));
    CHECK(std::isnan(stray.trace.runout));
    CHECK(std::isnan(stray.surveyed_runout));
    CHECK(stray.trace.areas.simulated() == Approx(15000));
    REQUIRE(stray.remarks.size() == 1);
    CHECK_THAT(stray.remarks[0], Catch::Contains(stray.stray_path + "; runouts are not known"));

    const Comparison by_survey = of({{230, 100}, {400, 100}}), by_flow = of({{60, 140}, {400, 140}});
    CHECK(by_survey.stray_path + by_flow.stray_path == "");
    REQUIRE(by_survey.remarks.size() == 2);
    CHECK_THAT(by_survey.remarks[0], Catch::Contains("the path does not touch what was simulated"));
    CHECK_THAT(by_survey.remarks[1], Catch::Contains("begins 135.1 m from the nearest place where material"));
    REQUIRE(by_flow.remarks.size() == 1);
    CHECK_THAT(by_flow.remarks[0], Catch::Contains("the path does not touch what was surveyed"));
    CHECK(of({{60, 100}, {400, 100}}).remarks.empty());

    // Where nothing lay at the start it is near where material came in, also at another node of that.
    for (double& time : flow.arrival.values) time += 10.0;
    SimulatedRun later = flow.run();
    survey.path = Polyline{{60, 60}, {400, 60}};
    later.starts = {Vec2(75, 105)};
    CHECK(compare(later, survey).remarks.empty());
    later.starts = {Vec2(175, 105)};
    REQUIRE(compare(later, survey).remarks.size() == 1);
    CHECK_THAT(compare(later, survey).remarks[0], Catch::Contains("the path begins"));
}

TEST_CASE("Without a footprint a given path has to come to the flow or to changes of the ground", "[compare]") {
    const ComparedFlow flow(200);
    const Raster still = made([](double, double) { return 0.0; });
    SimulatedRun run = flow.run();
    run.bed_change = &still;
    Survey survey;
    survey.bed_change = made([](double x, double y) { return within(x, y, 250, 50, 300, 150) ? -0.5 : 0.05; });
    survey.bed_change_source = "dod.tif";
    survey.path_source = "track.geojson";
    survey.path = Polyline{{60, 175}, {400, 175}};
    const Comparison stray = compare(run, survey);
    CHECK_FALSE(stray.stray_path.empty());
    CHECK(stray.bed_change_steps.empty());
    CHECK(stray.bed_change.has_value());
    survey.path = Polyline{{60, 175}, {400, 175}, {275, 100}};
    const Comparison found = compare(run, survey);
    CHECK(found.stray_path.empty());
    CHECK_FALSE(found.bed_change_steps.empty());
}

TEST_CASE("Where the flow leaves the way of water, the runout is put in doubt") {
    ComparedFlow flow(300);
    // a valley across: the water turns north at x = 300 m, the survey goes on up the opposite slope
    flow.bed = made([](double x, double y) { return 300.0 + 0.5 * std::abs(x - 305.0) - 0.1 * y; });
    Survey survey;
    survey.footprint = {{box(50, 50, 450, 150)}, "", "survey.geojson"};
    const Comparison c = compare(flow.run(), survey);
    CHECK(c.trace.reach < c.surveyed_reach - 140.0);
    REQUIRE(c.remarks.size() == 1);
    CHECK_THAT(c.remarks[0], Catch::Contains("--path"));
}

TEST_CASE("Without terrain, or with nothing covered, there is no runout but there are scores", "[nan]") {
    ComparedFlow flow(300);
    Survey survey;
    survey.footprint = {{box(50, 50, 300, 250)}, "", "survey.geojson"};
    SimulatedRun run = flow.run();
    run.bed = nullptr;
    const Comparison c = compare(run, survey);
    CHECK(std::isnan(c.trace.runout));
    CHECK(c.trace.areas.recall() == Approx(0.5));
    CHECK(c.trace.areas.missed_outside == Approx(250 * 50));
    REQUIRE(c.remarks.size() == 2);
    CHECK_THAT(c.remarks[1], Catch::Contains("12500 m2 of the survey (25 %) lie outside"));

    for (double& h : flow.peak.values) h = 0.0;
    const Comparison dry = compare(flow.run(), survey);
    CHECK(dry.outline.empty());
    CHECK(std::isnan(dry.trace.runout));
    CHECK(dry.trace.areas.iou() == 0.0);
}

TEST_CASE("A deposit of known volumes has the error that they have") {
    // simulated 1 m on [0, 100] x [0, 100]; surveyed 2 m on [50, 150] x [0, 100]
    const Raster simulated = made([](double x, double y) { return within(x, y, 0, 0, 100, 100) ? 1.0 : 0.0; });
    Raster surveyed = made([](double x, double y) { return within(x, y, 50, 0, 150, 100) ? 2.0 : 0.0; });
    DepositErrors errors = deposit_errors(simulated, surveyed, 0.1);
    CHECK(errors.simulated_volume == Approx(10000));
    CHECK(errors.surveyed_volume == Approx(20000));
    CHECK(errors.volume_error() == Approx(-0.5));
    CHECK(errors.compared_area == Approx(15000));
    CHECK(errors.mae == Approx(4.0 / 3.0));        // 1, 1 and 2 m on 5000 m2 each
    CHECK(errors.rmse == Approx(std::sqrt(2.0)));  // 1, 1 and 4 m2
    CHECK(errors.unsurveyed_volume == 0.0);

    surveyed.at(0, 0) = Raster::nodata;
    surveyed.at(59, 19) = -0.5;
    errors = deposit_errors(simulated, surveyed, 0.1);
    CHECK(errors.simulated_volume == Approx(9900));
    CHECK(errors.unsurveyed_volume == Approx(100));
    CHECK(errors.surveyed_volume == Approx(20000 - 50));
    CHECK(errors.negative == 1);
}

TEST_CASE("A surveyed deposit may reach beyond the simulated raster; its volume there counts") {
    const Raster simulated = made([](double, double) { return 1.0; });
    GridGeometry wide = slope_grid();
    wide.x0 -= 3 * cell;
    wide.nx += 3;
    wide.ny += 2;
    const Raster surveyed = Raster::filled(wide, 1.0);
    const DepositErrors errors = deposit_errors(simulated, surveyed, 0.1);
    CHECK(errors.simulated_volume == Approx(600 * 200));
    CHECK(errors.surveyed_volume == Approx(630 * 220));
    CHECK(errors.mae == Approx((630.0 * 220 - 600 * 200) / (630 * 220)));
}

TEST_CASE("What layer after layer buried counts as ever covered: the extent at the end is a part of it",
          "[compare][deposition]") {
    const ComparedFlow flow(300);
    const Raster left =
        made([](double x, double y) { return within(x, y, 250, 50, 400, 150) ? 0.5 : 0.0; });  // 100 m farther
    SimulatedRun run = flow.run();
    run.deposited_depth = &left;
    Survey survey;
    survey.footprint.parts = {box(50, 50, 400, 150)};
    const Comparison found = compare(run, survey);
    CHECK(found.trace.areas.simulated() == Approx(350.0 * 100.0));
    CHECK(found.trace.areas.iou() == Approx(1.0));
    CHECK(found.final->areas.simulated() == Approx(200.0 * 100.0));
    CHECK(found.trace.runout - found.surveyed_runout == Approx(0.0).margin(1e-9));
}
