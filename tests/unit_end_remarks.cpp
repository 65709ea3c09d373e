// Remarks that several runs share.
#include <fmt/core.h>

#include "catch.h"
#include "fake_simulation.h"
#include "run/end_remarks.h"

using Catch::Contains;
using namespace frana;

TEST_CASE("Remarks that differ in numbers only are one, told with the run that it matters most for", "[ensemble]") {
    RemarkTally tally;
    tally.add(0, {{"the flow is 5 cells wide (25 m); expected 6", -5.0}, {"late: its 30 m3 did not enter: none came"}});
    tally.add(1, {{"the flow is 4.2 cells wide (1.2e-05 m); expected 6", -4.2}});
    tally.add(3, {{"the flow is 5.5 cells wide (-1e+03 m); expected 6", -5.5}});
    CHECK(tally.sentences(4) ==
          std::vector<std::string>{
              "in 3 of 4 runs, worst in sample 1: the flow is 4.2 cells wide (1.2e-05 m); expected 6",
              "in 1 of 4 runs, sample 0: late: its 30 m3 did not enter: none came"});
}

TEST_CASE("Of remarks on two things with numbers in their names each is told", "[ensemble]") {
    RemarkTally tally;
    tally.add(0, {{"gully 1: its 30 m3 did not enter"}, {"gully 2: its 40 m3 did not enter"}});
    tally.add(1, {{"gully 2: its 41 m3 did not enter"}});
    tally.add(2, {{"holes: lost in cell_3"}, {"holes: lost in cell_4"}});
    const auto all = tally.all();
    REQUIRE(all.size() == 4);
    CHECK(all.front().text == "gully 2: its 40 m3 did not enter");
    CHECK(all.front().runs == 2);
    CHECK(all.front().sentence(3) == "in 2 of 3 runs, such as sample 0: gully 2: its 40 m3 did not enter");
}

TEST_CASE("A run with the same remark on two things is one run", "[ensemble]") {
    RemarkTally tally;
    tally.add(0, {{"the outline has no depth on 3 % of its area"}, {"the outline has no depth on 5 % of its area"}});
    tally.add(1, {{"the outline has no depth on 4 % of its area"}});
    CHECK(tally.sentences(2).front().rfind("in 2 of 2 runs", 0) == 0);
}

TEST_CASE("Energy that motion got by virtual mass is remarked on from a hundredth on") {
    struct : FakeSimulation {
        double drag = 0.0;
        Extras extras() const override {
            Extras all;
            all.water.emplace();
            all.water->drag = drag;
            return all;
        }
    } simulation;
    RunSummary summary;
    summary.last.kinetic = 60e6, summary.last.dissipated = 40e6;
    const auto remarks = [&](double drag) {
        simulation.drag = drag;
        std::vector<std::string> about;
        for (const auto& remark : remarks_at_end(simulation, summary))
            if (remark.text.find("virtual_mass") != std::string::npos) about.push_back(remark.text);
        return about;
    };
    CHECK(remarks(26e6).empty());
    CHECK(remarks(-0.9e6).empty());
    REQUIRE(remarks(-42e6).size() == 1);
    CHECK_THAT(remarks(-42e6).front(), Contains("got 4.2e+07 J") && Contains("42 %"));
}

TEST_CASE("Work of the ground on 3D points is remarked on from a twentieth on") {
    const FakeSimulation simulation;
    RunSummary summary;
    summary.last.kinetic = 60e6, summary.last.dissipated = 40e6;
    const auto remarks = [&](double lost) {
        summary.last.in_3d.walls = lost;
        std::vector<std::string> about;
        for (const auto& remark : remarks_at_end(simulation, summary))
            if (remark.text.find("3D points: got") != std::string::npos) about.push_back(remark.text);
        return about;
    };
    CHECK(remarks(30e6).empty());
    CHECK(remarks(-4.9e6).empty());
    REQUIRE(remarks(-20e6).size() == 1);
    CHECK_THAT(remarks(-20e6).front(), Contains("got 2e+07 J from the ground") && Contains("20 %"));
}

TEST_CASE("Of very many remarks the first are told, and how many more there are", "[ensemble]") {
    RemarkTally tally;
    for (int k = 0; k < 50; ++k) tally.add(k, {{fmt::format("from {} s: began", k)}});
    CHECK(tally.all().size() == 50);
    REQUIRE(tally.sentences(50).size() == 21);
    CHECK_THAT(tally.sentences(50).back(), Contains("30 more remarks"));
}

TEST_CASE("A flow that was nowhere deeper than the footprint depth is remarked upon at its end", "[remarks]") {
    const frana::FakeSimulation simulation;
    frana::RunSummary summary;
    summary.reason = "end", summary.extremes.max_depth = 0.8;
    const auto said = frana::remarks_at_end(simulation, summary);
    REQUIRE(said.size() == 1);
    CHECK_THAT(said.front().text, Contains("output.footprint_depth: found a flow of 0.8 m at most, nowhere deeper"));
    summary.extremes.max_covered_area = 25.0;
    CHECK(frana::remarks_at_end(simulation, summary).empty());
    summary.extremes = {};
    CHECK(frana::remarks_at_end(simulation, summary).empty());
}

TEST_CASE("Free water that was nowhere deeper than the footprint depth is remarked upon as well", "[remarks][water]") {
    struct Water : frana::FakeSimulation {
        frana::Extras extras() const override {
            frana::Extras extras;
            extras.water.emplace();
            return extras;
        }
    };
    frana::RunSummary summary;
    summary.reason = "end", summary.extremes.max_depth = 0.08;
    const auto said = frana::remarks_at_end(Water(), summary);
    REQUIRE(said.size() == 1);
    CHECK_THAT(said.front().text, Contains("found a flow of 0.08 m at most"));
    summary.extremes.max_covered_area = 25.0;
    CHECK(frana::remarks_at_end(Water(), summary).empty());
}
