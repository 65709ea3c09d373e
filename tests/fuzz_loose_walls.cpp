// Random scenes whose ground sinks or rises, with a wall across.
#include "catch.h"
#include "checks/fuzz/dice.h"
#include "checks/fuzz/draw.h"
#include "checks/fuzz/trial.h"

using namespace frana;
using namespace frana::fuzz;

namespace {

bool bed_changes(const Draft& draft) {
    return draft.has("erodible.law") || draft.has("deposition.law") || draft.has("forest.detrainment");
}

/// A wall from one random place to another, up to five cells high. Nothing is its own mirror image any more.
void wall_across(Dice& dice, Draft& draft) {
    const GridGeometry& g = draft.dem().geometry;
    draft.keys["barrier#0.line"] = line_across(dice, g);
    draft.keys["barrier#0.height"] = toml_number(g.cell * dice.decades(0.1, 5.0));
    draft.claims = {};
    draft.claims.threads = draft.claims.resumes = true;
}

}  // namespace

TEST_CASE("Walls in ground that changes: no invariant breaks in random scenes", "[fuzz][barrier]") {
    Index walled = 0;
    Dice dice(20261128);
    for (std::uint64_t n = 0; n < 180; ++n) {
        Draft draft = draw(20261128, n);
        if (!bed_changes(draft) || draft.has("inflow#0.name")) continue;
        wall_across(dice, draft);
        CAPTURE(n, toml_of(draft));
        const Verdict verdict = examine(draft);
        if (verdict.refused) continue;
        ++walled;
        CAPTURE(verdict.broken ? verdict.broken->text : "");
        CHECK_FALSE(verdict.broken);
    }
    CHECK(walled > 30);
}
