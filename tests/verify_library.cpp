// The references themselves: a wrong exact answer must not hide behind a small error. And what `frana verify` makes of
// tables. The scheme's own figures are in verification.txt, which the test "verification" runs again.
#include <set>

#include "catch.h"
#include "checks/verify/library.h"
#include "checks/verify/table.h"
#include "checks/verify/trial.h"
#include "scene/build_scene.h"
#include "scene/case_file.h"

using namespace frana;

TEST_CASE("Every exact answer satisfies its own equations", "[verify]") {
    int checked = 0;
    for (const verify::Problem& problem : verify::library()) {
        if (!problem.residuals) continue;
        for (const verify::Residual& residual : problem.residuals()) {
            CAPTURE(problem.name, residual.what);
            CHECK(std::abs(residual.value) <= residual.bound);
            ++checked;
        }
    }
    CHECK(checked > 50);
}

TEST_CASE("Problems have names of their own, grids, and gates on quantities that they measure", "[verify]") {
    std::set<std::string> names;
    for (const verify::Problem& problem : verify::library()) {
        CAPTURE(problem.name);
        CHECK(names.insert(problem.name).second);
        CHECK_FALSE(problem.grids.empty());
        CHECK_FALSE(problem.title.empty());
        for (const verify::Gate& gate : problem.gates) CHECK_FALSE(gate.source.empty());
    }
    for (const char* name : {"lake_z1", "lake_z2", "lake_island", "ritter", "stoker", "thacker_planar",
                             "thacker_radial", "radial_dam", "pile", "obstacle", "conversion"})
        CHECK(names.count(name) == 1);
}

TEST_CASE("A gate is missed by what is too large, missing or not a number, and only by that", "[verify]") {
    verify::Problem problem;
    problem.name = "p";
    problem.gates = {{100, "l1_depth", 1e-2, "s"}, {0, "extra", 1.0, "s"}};
    verify::Measurement m;
    m.preset = "default";
    m.cells = 100;
    m.l1_depth = 0.9e-2;
    m.add("extra", -0.5);
    CHECK(verify::missed_gates(problem, {m}).empty());
    m.l1_depth = 1.1e-2;
    CHECK(verify::missed_gates(problem, {m}).size() == 1);
    m.l1_depth = verify::kNone;
    m.extras.clear();
    CHECK(verify::missed_gates(problem, {m}).size() == 2);
}

TEST_CASE("Tables differ by more than the tolerance, by another word and by another line", "[verify]") {
    const std::string table = "# a date\nstoker 100 1.00e-02 -  4.0e-14\n";
    CHECK(verify::differences(table, "# another\nstoker  100 1.03e-02 - 9.0e-15\n", 0.05).empty());
    CHECK(verify::differences(table, "stoker 100 1.10e-02 - 4.0e-14\n", 0.05).size() == 1);
    CHECK(verify::differences(table, "ritter 100 1.00e-02 - 4.0e-14\n", 0.05).size() == 1);
    CHECK(verify::differences(table, table + "missed: stoker\n", 0.05).size() == 1);
    CHECK(verify::differences(table, "stoker 100 1.00e-02 -\n", 0.05).size() == 1);
}

TEST_CASE("Problems that take long go without their finest grid, others have all", "[verify]") {
    Index shorter = 0;
    for (const auto& problem : verify::library()) {
        const std::vector<Index> coarse = verify::grids_of(problem, true);
        CAPTURE(problem.name);
        CHECK(verify::grids_of(problem, false) == problem.grids);
        CHECK(coarse.size() + (problem.finest_is_long ? 1 : 0) == problem.grids.size());
        CHECK(std::equal(coarse.begin(), coarse.end(), problem.grids.begin()));
        shorter += problem.finest_is_long;
    }
    CHECK(shorter > 0);
}

// Errors of these fall at first order: those of a grid 1.5 times as coarse are 1.5 times as large.
TEST_CASE("The preset fast takes fewer points, and errs by no more than a grid 1.5 times as coarse", "[verify]") {
    double share = 0.0;
    for (const char* name : {"ritter", "stoker", "thacker_radial", "coulomb_slope"}) {
        const verify::Problem* problem = verify::find_problem(name);
        REQUIRE(problem != nullptr);
        verify::Setup setup;
        setup.cells = problem->grids[problem->grids.size() - 2];
        const verify::Measurement usual = problem->run(setup);
        setup.preset = "fast";
        const verify::Measurement fast = problem->run(setup);
        CAPTURE(name, usual.l1_depth, fast.l1_depth, usual.steps, fast.steps);
        CHECK(fast.particles <= usual.particles);
        share += 0.25 * static_cast<double>(fast.particles) / static_cast<double>(usual.particles);
        CHECK(fast.l1_depth < 1.5 * usual.l1_depth);
    }
    CHECK(share < 0.95);
}
