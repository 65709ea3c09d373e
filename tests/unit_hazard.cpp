// Classes of hazard: whatever strengths and return periods, the class is that of the table.
#include "base/atomic_file.h"
#include "base/error.h"
#include "catch.h"
#include "ensemble/hazard.h"
#include "ensemble/plan.h"
#include "fresh_folder.h"

using namespace frana;
using Catch::Contains;

namespace {

/// One pixel with a peak of each field.
SparseRasters pixel_of(const std::vector<float>& peaks) {
    SparseRasters one;
    one.rows.push_back({0, 1});
    for (const float peak : peaks) one.values.push_back({peak});
    return one;
}

/// What a run with this depth on one pixel reaches of a table.
ReachedLevels reached_by(const HazardTable& table, float depth) {
    return reached_levels(table, {"peak_depth"}, pixel_of({depth}));
}

const HazardTable& preset(const std::string& name) {
    for (const HazardTable& table : hazard_presets())
        if (table.preset == name) return table;
    throw std::runtime_error("no such preset");
}

/// Name of the class where one scenario alone comes with these peaks.
std::string class_of(const HazardTable& table, const std::vector<std::string>& fields, const std::vector<float>& peaks,
                     double years) {
    const SparseRasters run = pixel_of(peaks);
    const ReachedLevels reached = reached_levels(table, fields, run);
    const std::size_t number = hazard_classes(table, {{&reached, 1.0, years}}, 1).at(0);
    return number > 0 ? table.classes[number - 1].name : "none";
}

/// Two strengths, by depth alone; three columns.
HazardTable own_table() {
    HazardTable table;
    table.classes = {{"one", {}}, {"two", {}}, {"three", {}}};
    table.levels = {{"weak", {}, {2, 1, 0}}, {"strong", {{"peak_depth", 1.0}}, {3, 2, 1}}};
    table.years = {30.0, 100.0};
    return table;
}

const std::string ensemble_case =
    "[ensemble]\ncase = \"case.toml\"\nmethod = \"grid\"\n"
    "[[ensemble.vary]]\nkey = \"release.0.depth\"\ndistribution = \"discrete\"\nvalues = [0.5, 1.5]\n";
const std::string periods = "return_periods = [30, 300]\n";

std::string complaint(const std::string& more) {
    const FreshFolder folder;
    write_text(folder.path() / "case.toml", "[terrain]\ndem = \"dem.asc\"\n");
    write_text(folder.path() / "many.toml", more);
    try {
        read_ensemble(folder.path() / "many.toml");
    } catch (const UserError& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST_CASE("Swiss classes of flowing avalanches are those of the pressure and the return period", "[ensemble][hazard]") {
    const std::vector<std::string> fields = {"peak_depth", "peak_dynamic_pressure"};
    const auto found = [&](float pressure, double years) {
        return class_of(preset("swiss_avalanche"), fields, {0.5F, pressure}, years);
    };
    // Red: 30 kPa or more up to once in 300 years, and anything up to once in 30 years.
    for (const double years : {10.0, 30.0, 100.0, 300.0}) CHECK(found(30e3F, years) == "high");
    CHECK(found(1e3F, 30.0) == "high");
    // Blue: less, once in 30 to 300 years.
    for (const double years : {30.1, 100.0, 300.0}) CHECK(found(29.9e3F, years) == "medium");
    CHECK(found(40e3F, 300.1) == "residual");
}

TEST_CASE("Swiss classes of debris flows are those of depth, speed and the return period", "[ensemble][hazard]") {
    const std::vector<std::string> fields = {"peak_depth", "peak_speed"};
    const auto found = [&](float depth, float speed, double years) {
        return class_of(preset("swiss_debris_flow"), fields, {depth, speed}, years);
    };
    for (const double years : {30.0, 100.0, 300.0}) CHECK(found(1.0F, 1.0F, years) == "high");
    for (const double years : {30.0, 100.0}) {
        CHECK(found(0.9F, 5.0F, years) == "medium");  // both have to be reached
        CHECK(found(5.0F, 0.9F, years) == "medium");
    }
    CHECK(found(0.9F, 5.0F, 300.0) == "low");
    CHECK(found(2.0F, 5.0F, 1000.0) == "residual");
}

TEST_CASE("A scenario has the strength that enough of its runs reach, and the worst scenario counts",
          "[ensemble][hazard]") {
    HazardTable table = own_table();
    const ReachedLevels weak = reached_by(table, 0.5F), strong = reached_by(table, 1.5F), none;
    const auto classes = [&](const std::vector<HazardRun>& runs) {
        return static_cast<int>(hazard_classes(table, runs, 1).at(0));
    };
    CHECK(classes({{&strong, 1.0, 30.0}, {&weak, 1.0, 30.0}}) == 3);  // a half is enough
    CHECK(classes({{&strong, 0.9, 30.0}, {&weak, 1.1, 30.0}}) == 2);  // by weight
    CHECK(classes({{&strong, 1.0, 30.0}, {&none, 1.0, 30.0}, {&none, 1.0, 30.0}}) == 0);
    CHECK(classes({{&none, 1.0, 30.0}, {&strong, 1.0, 100.0}, {&weak, 1.0, 1000.0}}) == 2);
    CHECK(classes({{&weak, 1.0, 30.0}, {&strong, 1.0, 1000.0}}) == 2);
    table.share = 0.9;
    CHECK(classes({{&strong, 1.0, 30.0}, {&weak, 1.0, 30.0}}) == 2);
}

TEST_CASE("Runs of one event give each strength the return period of the event over their share",
          "[ensemble][hazard]") {
    HazardTable table = own_table();
    table.event_years = 10.0;
    const ReachedLevels weak = reached_by(table, 0.5F), strong = reached_by(table, 1.5F), none;
    const auto classes = [&](int strongs, int weaks, int nones) {
        std::vector<HazardRun> runs;
        for (int k = 0; k < strongs; ++k) runs.push_back({&strong, 1.0, 0.0});
        for (int k = 0; k < weaks; ++k) runs.push_back({&weak, 1.0, 0.0});
        for (int k = 0; k < nones; ++k) runs.push_back({&none, 1.0, 0.0});
        return static_cast<int>(hazard_classes(table, runs, 1).at(0));
    };
    CHECK(classes(1, 0, 2) == 3);  // strong once in 10 / (1/3) = 30 years
    CHECK(classes(1, 0, 3) == 2);  // once in 40
    CHECK(classes(1, 0, 9) == 2);  // once in 100
    CHECK(classes(1, 9, 0) == 2);  // and weak once in 10
    CHECK(classes(1, 0, 10) == 1);
    CHECK(classes(0, 1, 9) == 1);
    CHECK(classes(0, 1, 10) == 0);
    CHECK(classes(0, 0, 3) == 0);
}

TEST_CASE("A file gives a table of hazard, by a preset or its own, and what is wrong is told", "[ensemble][hazard]") {
    const std::string own =
        "[ensemble.hazard]\nyears = [30]\n[[ensemble.hazard.class]]\nname = \"blue\"\ncolour = \"#0000ff\"\n"
        "[[ensemble.hazard.level]]\nname = \"deep\"\npeak_depth = 1.0\nclasses = [\"blue\", \"none\"]\n";
    const FreshFolder folder;
    write_text(folder.path() / "case.toml", "[terrain]\ndem = \"dem.asc\"\n");
    write_text(folder.path() / "many.toml", ensemble_case + periods + own);
    const EnsemblePlan plan = read_ensemble(folder.path() / "many.toml");
    REQUIRE(plan.hazard);
    CHECK(plan.hazard->classes.at(0).colour == std::array<std::uint8_t, 3>{0, 0, 255});
    CHECK(plan.hazard->levels.at(0).classes == std::vector<std::size_t>{1, 0});
    CHECK(plan.points.at(0).return_period == 30.0);
    CHECK(plan.points.at(1).return_period == 300.0);
    CHECK(complaint(ensemble_case + periods + "[ensemble.hazard]\npreset = \"swiss_avalanche\"\n").empty());
    CHECK(complaint(ensemble_case + "[ensemble.hazard]\npreset = \"swiss_avalanche\"\nreturn_period = 100\n").empty());
    CHECK_THAT(complaint(ensemble_case + periods + "[ensemble.hazard]\npreset = \"french\"\n"),
               Contains("found \"french\"") && Contains("swiss_avalanche or swiss_debris_flow"));
    CHECK_THAT(complaint(ensemble_case + own), Contains("found neither it nor return periods of scenarios"));
    CHECK_THAT(complaint(ensemble_case + periods + own + "[ensemble.hazard.none]\n"),
               Contains("found a key that is not used"));
    CHECK_THAT(complaint(ensemble_case + "return_periods = [30]\n" + own),
               Contains("expected 2 numbers of years above 0"));
    CHECK_THAT(complaint(ensemble_case + periods + "[ensemble.hazard]\nyears = [30]\n"),
               Contains("found no [[ensemble.hazard.class]]"));
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string changed = ensemble_case + periods + own;
        return complaint(changed.replace(changed.find(from), from.size(), to));
    };
    CHECK_THAT(with("#0000ff", "blue"), Contains("expected red, green and blue"));
    CHECK_THAT(with("[\"blue\", \"none\"]", "[\"blue\"]"), Contains("found 1 of them; expected 2"));
    CHECK_THAT(with("[\"blue\", \"none\"]", "[\"blue\", \"red\"]"), Contains("found \"red\"; expected none or blue"));
    CHECK_THAT(with("peak_depth = 1.0", "peak_pressure = 1.0"), Contains("unless ensemble.fields names it"));
    CHECK_THAT(with("years = [30]", "years = [300, 30]"), Contains("found no return periods that grow"));
    CHECK_THAT(with("years = [30]", "years = [30, 30]"), Contains("found no return periods that grow"));
    CHECK_THAT(with("#0000ff", "#0x12ab"), Contains("expected red, green and blue"));
    const std::string shallower =
        "[[ensemble.hazard.level]]\npeak_depth = 0.5\nclasses = [\"blue\", \"none\"]\n[ensemble.hazard.x]\n";
    CHECK_THAT(complaint(ensemble_case + periods + own + shallower), Contains("found 0.5, less than 1 of \"deep\""));
    CHECK_THAT(complaint("[ensemble]\ncase = \"case.toml\"\nmethod = \"grid\"\nfields = [\"peak_depth\"]\n" +
                         ensemble_case.substr(ensemble_case.find("[[")) + periods +
                         "[ensemble.hazard]\npreset = \"swiss_debris_flow\"\n"),
               Contains("expected peak_speed among ensemble.fields"));
}

TEST_CASE("Runs without an answer bound the classes from below and above", "[ensemble][hazard]") {
    HazardTable table = own_table();
    const ReachedLevels weak = reached_by(table, 0.5F), strong = reached_by(table, 1.5F), dry;
    const auto number = [&](const std::vector<HazardRun>& runs, Unanswered how) {
        return static_cast<int>(hazard_classes(table, runs, 1, how).at(0));
    };
    // A scenario of 30 years, share 0.5: one run strong, one weak, two without an answer.
    const std::vector<HazardRun> four = {{&strong, 1, 30}, {&weak, 1, 30}, {nullptr, 1, 30}, {nullptr, 1, 30}};
    CHECK(number(four, Unanswered::left_out) == 3);      // half of two is strong
    CHECK(number(four, Unanswered::came_nowhere) == 2);  // a quarter of four is; half of them come
    CHECK(number(four, Unanswered::came_everywhere) == 3);
    const std::vector<HazardRun> three = {{&weak, 1, 30}, {nullptr, 1, 30}, {nullptr, 1, 30}};
    CHECK(number(three, Unanswered::left_out) == 2);
    CHECK(number(three, Unanswered::came_nowhere) == 0);  // a third of the runs come
    CHECK(number(three, Unanswered::came_everywhere) == 3);
    // A scenario without any answer: left out it has no class, and at most the greatest, where another one came.
    const std::vector<HazardRun> lost = {{&weak, 1, 100}, {nullptr, 1, 30}};
    CHECK(number(lost, Unanswered::left_out) == 1);
    CHECK(number(lost, Unanswered::came_nowhere) == 1);
    CHECK(number(lost, Unanswered::came_everywhere) == 3);
    CHECK(number({{&dry, 1, 30}, {nullptr, 1, 30}}, Unanswered::came_everywhere) == 0);
    // Of one event: half of its runs come, or one and two thirds of three.
    const std::vector<HazardRun> event = {{&weak, 1, 0}, {&dry, 1, 0}, {nullptr, 1, 0}};
    table.event_years = 50.0;
    CHECK(number(event, Unanswered::left_out) == 1);      // once in 100 years
    CHECK(number(event, Unanswered::came_nowhere) == 0);  // once in 150
    table.event_years = 30.0;
    CHECK(number(event, Unanswered::came_everywhere) == 2);  // strong once in 90
}
