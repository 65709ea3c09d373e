// Tables of discharge, uniform flow, and rows.
#include <cmath>

#include "base/error.h"
#include "catch.h"
#include "fresh_folder.h"
#include "law/bed/normal_flow.h"
#include "scene/inflow_table.h"
#include "shallow/feed.h"

using namespace frana;

namespace {

std::string problem_of_table(const std::string& text) {
    try {
        parse_hydrograph(text, "q.csv");
    } catch (const UserError& error) {
        return error.what();
    }
    return "";
}

Inflow inflow_of(std::vector<double> time, std::vector<double> discharge, std::vector<double> speed) {
    Inflow inflow;
    inflow.line = {{0, 0}, {0, 10}};
    inflow.spacing = 2.5;
    inflow.time = std::move(time), inflow.discharge = std::move(discharge), inflow.speed = std::move(speed);
    return inflow;
}

}  // namespace

TEST_CASE("A table of discharge is read whatever its marks and units", "[inflow]") {
    const Hydrograph plain = parse_hydrograph("t [s], discharge [m3/s]\n0, 1\n60, 3\n", "q.csv");
    CHECK(plain.time == std::vector<double>{0, 60});
    CHECK(plain.discharge == std::vector<double>{1, 3});
    CHECK(plain.velocity.empty());
    CHECK(plain.volume() == 120.0);
    const Hydrograph minutes = parse_hydrograph("# a flood\nt_min;Q [m3/s];v [m/s]\r\n0;1;2\r\n1;3;4\r\n", "q.csv");
    CHECK(minutes.time == std::vector<double>{0, 60});
    CHECK(minutes.velocity == std::vector<double>{2, 4});
    CHECK(parse_hydrograph("t_h discharge [m3/s]\n0 1\n0.5 3\n", "q.csv").time[1] == 1800.0);
    CHECK(parse_hydrograph("time [min]\tdischarge [m^3/s]\n0\t1\n2\t3\n", "q.csv").time[1] == 120.0);
}

TEST_CASE("A table of discharge may begin with the byte-order mark that Excel writes", "[inflow]") {
    const FreshFolder folder;
    std::ofstream(folder.path() / "q.csv") << "\xEF\xBB\xBFt [s],discharge [m3/s]\r\n0,1\r\n60,3\r\n";
    CHECK(read_hydrograph(folder.path() / "q.csv").discharge == std::vector<double>{1, 3});
    CHECK_THROWS_AS(read_hydrograph(folder.path() / "none.csv"), UserError);
    CHECK_THROWS_AS(read_hydrograph(folder.path()), UserError);
}

TEST_CASE("What is wrong with a table is said in a sentence", "[inflow]") {
    const std::string head = "t [s], discharge [m3/s]\n";
    CHECK(
        problem_of_table("t, discharge [m3/s]\n0, 1\n").rfind("q.csv: found the column \"t\"; expected a header", 0) ==
        0);
    CHECK(problem_of_table("t [s], discharge [l/s]\n0, 1\n").rfind("q.csv: found the column \"discharge [l/s]\"", 0) ==
          0);
    CHECK(problem_of_table("t [s], t_min\n0, 1\n").rfind("q.csv: found 2 columns of time, 0 of discharge", 0) == 0);
    CHECK(problem_of_table("").rfind("q.csv: found an empty file", 0) == 0);
    CHECK(problem_of_table(head + "0, 1\n").rfind("q.csv: found 1 row; expected two or more", 0) == 0);
    CHECK(problem_of_table(head + "0, 1\n5\n") ==
          "q.csv:3: found a gap, \"5\"; expected 2 columns as in the first line; fill it, or remove the row");
    for (const char* row : {"5,", "5, ", ",3", "5, , 7"})
        CHECK(problem_of_table(head + "0, 1\n" + row + "\n").rfind("q.csv:3: found ", 0) == 0);
    CHECK(problem_of_table(head + "0, 1\n5,\n") ==
          "q.csv:3: found a gap; expected a number in each column; fill it, or remove the row");
    CHECK(problem_of_table(head + "0, 1\n5, 6, 7\n") ==
          "q.csv:3: found 3 columns, \"5, 6, 7\"; expected 2 columns as in the first line; correct the row");
    CHECK(problem_of_table(head + "0, 1\n5, nan\n").rfind("q.csv:3: found \"nan\"; expected a number", 0) == 0);
    CHECK(problem_of_table(head + "0, 1\n0, 2\n").rfind("q.csv: row 2 (t = 0 s): found a time that is not later", 0) ==
          0);
    CHECK(problem_of_table(head + "-1, 1\n0, 2\n").rfind("q.csv: row 1 (t = -1 s): found a time before 0", 0) == 0);
    CHECK(problem_of_table(head + "0, 1\n9, -2\n").rfind("q.csv: row 2 (t = 9 s): found a discharge of -2 m3/s", 0) ==
          0);
    CHECK(problem_of_table(head + "0, 0\n9, 0\n").rfind("q.csv: found no discharge above 0", 0) == 0);
    CHECK(problem_of_table("t [s], discharge [m3/s], velocity [m/s]\n0, 0, 0\n9, 2, 0\n")
              .rfind("q.csv: row 2 (t = 9 s): found a velocity of 0 m/s with 2 m3/s", 0) == 0);
}

TEST_CASE("Rows of r.avaflow are read, with or without their header, and their phases summed", "[inflow]") {
    const Hydrograph one = parse_hydrograph("T\tQ1\tv1\n0\t0\t2\n60\t3\t4\n", "q.txt");
    CHECK(one.time == std::vector<double>{0, 60});
    CHECK(one.discharge == std::vector<double>{0, 3});
    CHECK(one.velocity == std::vector<double>{2, 4});
    CHECK(one.remark == "q.txt: taken for rows of r.avaflow, t [s] and Q [m3/s], v [m/s] of 1 phase");
    // 1 at 8 and 3 at 4 m/s: 4 m3/s that carry 8 + 12 m4/s2.
    const Hydrograph two = parse_hydrograph("0 1 8 3 4\n10 0 2 0 5\n", "q.txt");
    CHECK(two.discharge == std::vector<double>{4, 0});
    CHECK(two.velocity == std::vector<double>{5, 5});
    CHECK(two.remark.find("of 2 phases, which come in as one: their discharges are summed") != std::string::npos);
    CHECK(parse_hydrograph("t Q1 v1 Q2 v2 Q3 v3\n0 1 1 1 1 1 1\n9 1 1 1 1 1 1\n", "q.txt").volume() == 27.0);
    CHECK(problem_of_table("0 1 1\n5 -1 1\n").rfind("q.csv:2: found -1; expected discharges and velocities", 0) == 0);
    CHECK(problem_of_table("0 1 1\n5 1 1 1\n").rfind("q.csv:2: found 4 columns, \"5 1 1 1\"; expected 3", 0) == 0);
    CHECK(problem_of_table("0 1 1\n5 nan 1\n").rfind("q.csv:2: found \"nan\"", 0) == 0);
    CHECK(
        problem_of_table("t, v, Q\n0, 1, 1\n9, 1, 1\n").rfind("q.csv: found the column \"t\"; expected a header", 0) ==
        0);
    CHECK(parse_hydrograph("t [s], discharge [m3/s]\n0, 1\n60, 3\n", "q.csv").remark.empty());
}

// Values of V = 1e3, 1e4, 1e5 by a pocket calculator, to three digits.
TEST_CASE("Empirical peaks and their triangles", "[inflow]") {
    const std::vector<std::vector<double>> known = {{29.5, 178, 1072}, {4.40, 27.2, 168}, {31.6, 215, 1462}};
    for (std::size_t n = 0; n < 3; ++n)
        for (std::size_t k = 0; k < 3; ++k)
            CHECK(peak_discharge(peak_formulas()[n], std::pow(10.0, 3.0 + double(k))) ==
                  Approx(known[n][k]).epsilon(3e-3));
    const Hydrograph t = triangle(25000.0, 100.0);
    CHECK(t.time == std::vector<double>{0, 50, 500});
    CHECK(t.discharge == std::vector<double>{0, 100, 0});
    CHECK(t.volume() == 25000.0);
    const Hydrograph later = triangle(25000.0, 100.0, 20.0, 200.0);
    CHECK(later.time == std::vector<double>{20, 220, 520});
    CHECK(later.volume() == 25000.0);
}

// Closed forms on a slope of 0.2 with 4 m2/s, their figures from an independent calculation to seven digits.
TEST_CASE("Uniform flow by any bed law", "[inflow]") {
    const bed::Plane plane{0.2, 9.81, 1800.0};
    const auto flow = [&](const BedLaw& law) { return bed::normal_flow(law, 4.0, plane); };
    CHECK(flow(bed::Voellmy{0.08, 400}).thickness == Approx(0.697908).epsilon(1e-6));
    CHECK(flow(bed::Voellmy{0.08, 400}).speed == Approx(5.731411).epsilon(1e-6));
    const double s = 0.2 / std::sqrt(1.04);
    CHECK(flow(bed::Manning{0.05, 0.0}).thickness == Approx(std::pow(0.05 * 4.0 / std::sqrt(s), 0.6)).epsilon(1e-12));
    CHECK(flow(bed::Manning{0.05, 0.0}).speed == Approx(6.444600).epsilon(1e-6));
    CHECK(flow(bed::Bingham{200.0, 400.0}).thickness == Approx(0.946309).epsilon(1e-6));
    CHECK(flow(bed::Bingham{200.0, 400.0}).speed == Approx(4.226949).epsilon(1e-6));
    CHECK(std::isinf(flow(bed::Coulomb{0.1}).speed));
    CHECK(std::isinf(flow(bed::None{}).speed));
    CHECK(flow(bed::Voellmy{0.25, 400}).speed == 0.0);
    CHECK(flow(bed::Coulomb{0.25}).speed == 0.0);
}

TEST_CASE("Rows bring a table's volume and momentum, each over a way of one spacing", "[inflow]") {
    const Inflow of = inflow_of({5, 20, 30, 50, 80}, {0, 12, 12, 3, 0}, {1, 4, 6, 2, 2});
    const std::vector<InflowRow> rows = rows_of(of);
    double volume = 0.0, momentum = 0.0, moment = 0.0, before = 5.0;
    for (const InflowRow& row : rows) {
        CHECK(row.volume > 0.0);
        CHECK(row.complete > before);
        CHECK(row.mean_time > before);
        CHECK(row.mean_time < row.complete);
        if (&row != &rows.back()) CHECK(row.length == Approx(of.spacing).epsilon(1e-9));
        before = row.complete;
        volume += row.volume, momentum += row.volume * row.speed, moment += row.volume * row.mean_time;
    }
    CHECK(rows.back().complete == 80.0);
    CHECK(volume == Approx(90.0 + 120.0 + 150.0 + 45.0).epsilon(1e-14));
    // Of Simpson's rule, which is exact for products of two linear functions.
    double exact = 0.0, first = 0.0;
    for (std::size_t n = 0; n + 1 < of.time.size(); ++n) {
        const double q0 = of.discharge[n], q1 = of.discharge[n + 1], v0 = of.speed[n], v1 = of.speed[n + 1];
        const double dt = of.time[n + 1] - of.time[n], tm = 0.5 * (of.time[n] + of.time[n + 1]);
        exact += dt / 6.0 * (q0 * v0 + (q0 + q1) * (v0 + v1) + q1 * v1);
        first += dt / 6.0 * (q0 * of.time[n] + 2.0 * (q0 + q1) * tm + q1 * of.time[n + 1]);
    }
    CHECK(momentum == Approx(exact).epsilon(1e-13));
    CHECK(moment == Approx(first).epsilon(1e-13));
}

TEST_CASE("Nothing comes between two floods of a table", "[inflow]") {
    const std::vector<InflowRow> rows =
        rows_of(inflow_of({0, 10, 11, 99, 100, 110}, {8, 8, 0, 0, 8, 8}, {3, 3, 3, 3, 3, 3}));
    for (const InflowRow& row : rows) CHECK((row.mean_time < 11.0 || row.mean_time > 99.0));
    double volume = 0.0;
    for (const InflowRow& row : rows) volume += row.volume;
    CHECK(volume == Approx(168.0).epsilon(1e-14));
}
