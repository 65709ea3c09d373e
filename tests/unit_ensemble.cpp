// Samples of an ensemble, its file, and the maps that are made of its runs.
#include <algorithm>
#include <cmath>
#include <fstream>

#include "base/atomic_file.h"
#include "base/error.h"
#include "catch.h"
#include "ensemble/plan.h"
#include "ensemble/sample_run.h"
#include "ensemble/sensitivity.h"
#include "ensemble/statistics.h"
#include "ensemble/vary_words.h"
#include "fresh_folder.h"
#include "growing_slide.h"
#include "run/interrupt.h"
#include "scene/bed_over.h"
#include "scene/build_scene.h"
#include "slope_case.h"
#include "terrain/part_of.h"

using namespace frana;
using Catch::Contains;

namespace {

std::vector<double> column(const Design& design, std::size_t key) {
    std::vector<double> all;
    for (const auto& point : design.points) all.push_back(point.at(key));
    return all;
}

/// How many of the numbers lie in each of so many slices of (0, 1).
std::vector<int> in_slices(const std::vector<double>& numbers, std::size_t slices) {
    std::vector<int> counts(slices, 0);
    for (const double u : numbers) {
        REQUIRE(u > 0.0);
        REQUIRE(u < 1.0);
        ++counts[static_cast<std::size_t>(u * static_cast<double>(slices))];
    }
    return counts;
}

/// Largest distance of the share of numbers below from the uniform one (Kolmogorov and Smirnov).
double from_uniform(std::vector<double> numbers) {
    std::sort(numbers.begin(), numbers.end());
    double most = 0.0;
    const double n = static_cast<double>(numbers.size());
    for (std::size_t k = 0; k < numbers.size(); ++k)
        most = std::max({most, std::abs(numbers[k] - static_cast<double>(k) / n),
                         std::abs(numbers[k] - static_cast<double>(k + 1) / n)});
    return most;
}

Distribution numbers_of(Distribution::Kind kind, double low, double high, double middle = 0.0, double spread = 1.0) {
    Distribution of;
    of.kind = kind, of.low = low, of.high = high, of.middle = middle, of.spread = spread;
    return of;
}

/// An ensemble file beside a case, and what is said of it.
class EnsembleFile {
public:
    EnsembleFile() {
        write("case.toml", "[terrain]\ndem = \"dem.asc\"\n");
        for (const char* name : {"dem.tif", "release.geojson", "gone.geojson"}) write(name, "read by nobody");
    }
    void write(const std::string& name, const std::string& text) const { write_text(folder_.path() / name, text); }
    EnsemblePlan read(const std::string& text) const {
        write("many.toml", text);
        return read_ensemble(folder_.path() / "many.toml");
    }
    std::string complaint(const std::string& text) const {
        try {
            read(text);
        } catch (const UserError& error) {
            return error.what();
        }
        return "";
    }

private:
    FreshFolder folder_;
};

const std::string head = "[ensemble]\ncase = \"case.toml\"\nsamples = 8\n";
const std::string mu = "[[ensemble.vary]]\nkey = \"material.bed.mu\"\nrange = [0.1, 0.3]\n";

SparseRasters row_of(std::int64_t first, const std::vector<float>& values) {
    return {{{first, static_cast<std::int64_t>(values.size())}}, {values}};
}

}  // namespace

TEST_CASE("Latin hypercube samples hit each slice of each key once", "[ensemble]") {
    const Design design = make_design(Method::lhs, 50, 3, 7);
    for (std::size_t key = 0; key < 3; ++key) CHECK(in_slices(column(design, key), 50) == std::vector<int>(50, 1));
    CHECK(column(design, 0) != column(design, 1));
    CHECK(column(make_design(Method::lhs, 50, 3, 8), 0) != column(design, 0));
}

TEST_CASE("Sobol samples fill slices evenly and stay when more are added", "[ensemble]") {
    const Design design = make_design(Method::sobol, 128, 4, 3), half = make_design(Method::sobol, 64, 4, 3);
    for (std::size_t key = 0; key < 4; ++key) {
        CHECK(in_slices(column(design, key), 128) == std::vector<int>(128, 1));
        CHECK(in_slices(column(half, key), 64) == std::vector<int>(64, 1));
    }
    CHECK(std::equal(half.points.begin(), half.points.end(), design.points.begin()));
    CHECK(make_design(Method::sobol, 64, 4, 4).points != half.points);
    CHECK_THROWS_WITH(make_design(Method::sobol, 2, 4000, 1), Contains("expected at most 3667"));
}

TEST_CASE("Random samples are uniform, and each hangs on the seed and its number alone", "[ensemble]") {
    const Design design = make_design(Method::random, 2000, 2, 11);
    // 1.95 / sqrt(n): what one of a thousand uniform samples exceeds (Smirnov 1948).
    for (std::size_t key = 0; key < 2; ++key) CHECK(from_uniform(column(design, key)) < 1.95 / std::sqrt(2000.0));
    const Design few = make_design(Method::random, 10, 2, 11);
    CHECK(std::equal(few.points.begin(), few.points.end(), design.points.begin()));
    CHECK(design.points[5][1] == unit_at(11, 5, 1));
}

TEST_CASE("Distributions have the quantiles that tables have", "[ensemble]") {
    using Kind = Distribution::Kind;
    CHECK(numbers_of(Kind::uniform, 2.0, 6.0).number(0.25) == Approx(3.0));
    CHECK(numbers_of(Kind::loguniform, 1.0, 100.0).number(0.5) == Approx(10.0));
    const double infinite = std::numeric_limits<double>::infinity();
    CHECK(numbers_of(Kind::normal, -infinite, infinite, 1.0, 2.0).number(0.975) == Approx(1.0 + 2.0 * 1.959963984540));
    CHECK(numbers_of(Kind::lognormal, 0.0, infinite, 500.0, 1.5).number(0.8413447460685429) == Approx(750.0));
    CHECK(numbers_of(Kind::triangular, 0.0, 4.0, 1.0).number(0.25) == Approx(1.0));  // the mode
    CHECK(numbers_of(Kind::triangular, 0.0, 4.0, 1.0).number(0.75) == Approx(4.0 - std::sqrt(3.0)));
    Distribution beta = numbers_of(Kind::beta, 10.0, 20.0);
    beta.alpha = 2.0, beta.beta = 1.0;  // its distribution function is x^2
    CHECK(beta.number(0.49) == Approx(17.0));
    const Distribution cut = numbers_of(Kind::normal, 0.0, 1.0, 0.0, 1.0);
    // Half of what lies between 0 and 1 lies below.
    CHECK(std::erf(cut.number(0.5) / std::sqrt(2.0)) == Approx(0.5 * std::erf(1.0 / std::sqrt(2.0))));
    CHECK(cut.number(1e-9) >= 0.0);
    CHECK(cut.number(1.0 - 1e-9) <= 1.0);
    Distribution choice;
    choice.kind = Kind::discrete, choice.values = {"1", "2", "3"}, choice.weights = {0.2, 0.5, 0.3};
    CHECK(choice.text(0.19) == "1");
    CHECK(choice.text(0.21) == "2");
    CHECK(choice.text(0.999) == "3");
}

TEST_CASE("An ensemble's file becomes overrides of a case, the same ones each time", "[ensemble]") {
    const EnsembleFile file;
    const std::string text = head + "seed = 5\nmethod = \"sobol\"\nexceed = { peak_depth = [0.5] }\n" + mu +
                             "[[ensemble.vary]]\nkey = \"release.0.outline\"\ndistribution = \"discrete\"\n"
                             "values = [\"a.geojson\", \"b.geojson\"]\nweights = [0.7, 0.3]\n";
    const EnsemblePlan plan = file.read(text);
    REQUIRE(plan.points.size() == 8);
    CHECK(plan.exceed.at("peak_depth") == std::vector<double>{0.5});
    const std::vector<std::string> sets = plan.sets_of(3);
    REQUIRE(sets.size() == 2);
    CHECK_THAT(sets[0], Catch::StartsWith("material.bed.mu=0."));
    CHECK((sets[1] == "release.0.outline='a.geojson'" || sets[1] == "release.0.outline='b.geojson'" ||
           sets[1] == "release.0.outline=\"a.geojson\"" || sets[1] == "release.0.outline=\"b.geojson\""));
    CHECK(file.read(text).sets_of(3) == sets);
}

TEST_CASE("A grid takes all combinations, with the weights of what is chosen of", "[ensemble]") {
    const EnsembleFile file;
    const EnsemblePlan plan = file.read("[ensemble]\ncase = \"case.toml\"\nmethod = \"grid\"\n" + mu +
                                        "levels = 2\n[[ensemble.vary]]\nkey = \"material.bed.xi\"\n"
                                        "distribution = \"discrete\"\nvalues = [300, 500.5]\nweights = [0.7, 0.3]\n");
    REQUIRE(plan.samples == 4);
    CHECK(plan.sets_of(0) == std::vector<std::string>{"material.bed.mu=0.15", "material.bed.xi=300"});
    CHECK(plan.sets_of(3) == std::vector<std::string>{"material.bed.mu=0.25", "material.bed.xi=500.5"});
    CHECK(plan.points[0].weight == Approx(1.4));
    CHECK(plan.points[1].weight == Approx(0.6));
}

TEST_CASE("A key without a range has the prior of the kind of mass, and says so", "[ensemble][parameters]") {
    const EnsembleFile file;
    const auto vary = [&](const std::string& keys) { return head + "[[ensemble.vary]]\nkey = \"" + keys + "\"\n"; };
    CHECK_THAT(file.complaint(vary("material.bed.mu")), Contains("ensemble.vary.0.range: found no range"));
    file.write("case.toml", "[case]\nkind = \"debris_flow\"\n[material.bed]\nlaw = \"voellmy\"\n");
    const Vary mu_of_kind = file.read(vary("material.bed.mu")).vary.at(0);
    CHECK(mu_of_kind.distribution.kind == Distribution::Kind::triangular);
    CHECK((mu_of_kind.distribution.low == 0.05 && mu_of_kind.distribution.middle == 0.12));
    CHECK(mu_of_kind.distribution.high == 0.3);
    CHECK(mu_of_kind.prior ==
          "material.bed.mu: without a range it has the prior of case.kind = \"debris_flow\": triangular, 0.05 to 0.3, "
          "most likely 0.12; see cases/PARAMETERS.md");
    const Vary xi = file.read(vary("material.bed.xi")).vary.at(0);
    CHECK(xi.distribution.number(0.5) == Approx(300.0));
    const Vary rate = file.read(vary("erodible.rate")).vary.at(0);  // of the range
    CHECK((rate.distribution.kind == Distribution::Kind::uniform && rate.distribution.low == 0.0125));
    CHECK(rate.distribution.high == 0.05);
    CHECK(file.read(vary("material.bed.mu") + "range = [0.1, 0.2]\n").vary.at(0).prior.empty());
    CHECK_THAT(file.complaint(vary("release.0.depth")),
               Contains("found no range") && Contains("case.kind = \"debris_flow\" has no prior of it"));
    file.write("case.toml", "[case]\nkind = \"debris_flow\"\n[material.bed]\nlaw = \"coulomb\"\n");
    CHECK(file.read(vary("material.bed.mu")).vary.at(0).distribution.kind == Distribution::Kind::uniform);
}

TEST_CASE("What an ensemble's file cannot have is told in one sentence each", "[ensemble]") {
    const EnsembleFile file;
    CHECK_THAT(file.complaint(head), Contains("ensemble.vary: found no [[ensemble.vary]]"));
    CHECK_THAT(file.complaint(head + "sample = 3\n" + mu),
               Contains("ensemble.sample") && Contains("is samples meant?"));
    CHECK_THAT(file.complaint(head + "method = \"dice\"\n" + mu),
               Contains("found \"dice\"") && Contains("lhs, sobol, random, grid, saltelli, morris or table"));
    CHECK_THAT(file.complaint(head + mu + mu), Contains("found \"material.bed.mu\" a second time"));
    CHECK_THAT(file.complaint(head + "[[ensemble.vary]]\nkey = \"material.bed.nu\"\nrange = [1, 2]\n"),
               Contains("found \"material.bed.nu\"; expected a key of a case file"));
    CHECK_THAT(file.complaint(head + "[[ensemble.vary]]\nkey = \"grid.cell\"\nrange = [1, 2]\n"),
               Contains("maps need one terrain"));
    CHECK_THAT(file.complaint(head + "[[ensemble.vary]]\nkey = \"material.bed.mu\"\nrange = [-0.1, 0.2]\n"),
               Contains("found values from -0.1 to 0.2") && Contains("material.bed.mu"));
    CHECK_THAT(file.complaint(head + "[[ensemble.vary]]\nkey = \"material.bed.xi\"\ndistribution = \"normal\"\n"
                                     "mean = 500\nsd = 100\n"),
               Contains("found values from -inf to inf") && Contains("cuts normal"));
    CHECK_THAT(file.complaint(head + "[[ensemble.vary]]\nkey = \"release.0.depth\"\ndistribution = \"discrete\"\n"
                                     "values = [1, 2]\nweights = [0.5, 0.6]\n"),
               Contains("2 weights with the sum 1.1"));
    CHECK_THAT(file.complaint(head + "exceed = { peak_speed = [-1] }\n" + mu), Contains("found -1"));
    CHECK_THAT(file.complaint(head + "exceed = { depth = [1] }\n" + mu), Contains("ensemble.exceed.depth"));
    CHECK_THAT(file.complaint("[ensemble]\ncase = \"none.toml\"\nsamples = 3\n" + mu), Contains("none.toml"));
    CHECK_THAT(file.complaint("[ensemble\n"), Contains("TOML"));
    CHECK_THAT(file.complaint("[grid]\ncell = 3\n" + head + mu), Contains("expected [ensemble] alone"));
    CHECK_THAT(file.complaint(head + "[[ensemble.vary]]\nkey = \"release.0.depth\"\ndistribution = \"normal\"\n"
                                     "mean = 0.1\nsd = 0.01\nrange = [5, 6]\n"),
               Contains("far out in the distribution"));
    CHECK_THAT(file.complaint(head + "vary = [1]\n"), Contains("that is no table"));
    file.write("rows.csv", "grid.cell\n3\n");
    CHECK_THAT(file.complaint("[ensemble]\ncase = \"case.toml\"\nmethod = \"table\"\ntable = \"rows.csv\"\n"),
               Contains("maps need one terrain"));
    EnsemblePlan plan = file.read(head + mu);
    add_exceedance(plan, "peak_depth=1.3");
    CHECK(plan.exceed.at("peak_depth").back() == 1.3);
    CHECK_THROWS_WITH(add_exceedance(plan, "depth=1"), Contains("--exceed: found \"depth=1\""));
    CHECK_THROWS_WITH(add_exceedance(plan, "peak_depth=much"), Contains("expected FIELD=VALUE"));
}

TEST_CASE("Samples can come from a table, with weights", "[ensemble]") {
    const EnsembleFile file;
    const std::string text = "[ensemble]\ncase = \"case.toml\"\nmethod = \"table\"\ntable = \"rows.csv\"\n";
    file.write("rows.csv", "material.bed.mu, weight,material.bed.xi\n0.1,1,300\n0.2,3,400\r\n");
    const EnsemblePlan plan = file.read(text);
    REQUIRE(plan.samples == 2);
    CHECK(plan.sets_of(1) == std::vector<std::string>{"material.bed.mu=0.2", "material.bed.xi=400"});
    CHECK(plan.points[1].weight == 1.5);
    file.write("rows.csv", "\xEF\xBB\xBFmaterial.bed.mu\r\n0.15\r\n");  // as Excel does
    CHECK(file.read(text).sets_of(0) == std::vector<std::string>{"material.bed.mu=0.15"});
    file.write("rows.csv", "material.bed.nu\n0.1,3\n");
    CHECK_THAT(file.complaint(text), Contains("found \"material.bed.nu\"; expected a key of a case file, or weight") &&
                                         Contains("found 2 values; expected 1"));
    file.write("rows.csv", "material.bed.mu,weight\n0.1,much\n");
    CHECK_THAT(file.complaint(text), Contains("found the weight \"much\""));
    file.write("rows.csv", "material.bed.mu,weight,weight\n0.1,1,9\n0.2,9,1\n");  // the last one counted
    CHECK_THAT(file.complaint(text), Contains("found 2 columns \"weight\"; expected one"));
    CHECK_THAT(file.complaint(text + mu), Contains("ensemble.vary"));
}

TEST_CASE("Numbers that make no distribution are told by the key, and are no mistake of the program", "[ensemble]") {
    const EnsembleFile file;
    const auto complaint = [&](const std::string& numbers) {
        return file.complaint(head + "[[ensemble.vary]]\nkey = \"material.bed.mu\"\ndistribution = " + numbers + "\n");
    };
    for (const char* numbers : {"factor = 1.0", "factor = 0.5", "median = 0", "median = -0.2", "factor = 0"})
        CHECK_THAT(complaint(std::string("\"lognormal\"\nrange = [0.1, 0.3]\n") + numbers),
                   Contains("expected a median above 0 and a factor above 1"));
    CHECK_THAT(complaint("\"normal\"\nmean = 0.2\nsd = 0\nrange = [0.1, 0.3]"), Contains("sd: found 0; expected"));
    CHECK_THAT(complaint("\"normal\"\nmean = 0.2\nsd = -1\nrange = [0.1, 0.3]"), Contains("sd: found -1; expected"));
    for (const char* numbers : {"\"triangular\"\nrange = [0.1, 0.4, 0.3]", "\"triangular\"\nrange = [0.1, 0.3]",
                                "\"uniform\"\nrange = [0.3, 0.1]", "\"loguniform\"\nrange = [0.2, 0.2]"})
        CHECK_THAT(complaint(numbers), Contains("found no range, or one that does not grow"));
    CHECK_THAT(complaint("\"loguniform\"\nrange = [0, 0.2]"), Contains("found 0; expected numbers above 0"));
    CHECK_THAT(complaint("\"beta\"\nalpha = 0\nrange = [0.1, 0.2]"), Contains("found alpha 0 and beta 1"));
}

TEST_CASE("A table of samples has quotes and numbers as frana's own tables have them", "[ensemble]") {
    const EnsembleFile file;
    const std::string text = "[ensemble]\ncase = \"case.toml\"\nmethod = \"table\"\ntable = \"rows.csv\"\n";
    file.write(
        "rows.csv",
        "sample,\"release.0.outline\", material.bed.mu\n7, \"a,b.geojson\" ,0.1\n9,\"say \"\"a\"\".geojson\",0.2\r\n");
    const EnsemblePlan plan = file.read(text);
    REQUIRE(plan.samples == 2);
    CHECK(plan.sets_of(0) == std::vector<std::string>{"release.0.outline=a,b.geojson", "material.bed.mu=0.1"});
    CHECK(plan.sets_of(1) == std::vector<std::string>{"release.0.outline=say \"a\".geojson", "material.bed.mu=0.2"});
    CHECK(plan.points[1].weight == 1.0);
    file.write("rows.csv", "material.bed.mu,weight\n0.1,\n");
    CHECK_THAT(file.complaint(text), Contains("found the weight \"\""));
    CHECK(shown_value("'a.geojson'") == "a.geojson");
    CHECK(shown_value("\"a.geojson\"") == "a.geojson");
    CHECK(shown_value("'t Zand.geojson") == "'t Zand.geojson");
    CHECK(shown_value("0.5") == "0.5");
}

TEST_CASE("Sparse rasters hold what exceeds a limit, on the pixels of the whole terrain", "[ensemble]") {
    const GridGeometry whole{6, 4, 0.0, 0.0, 2.0}, part{3, 2, 4.0, 2.0, 2.0};  // from node (2, 1) on
    const std::vector<double> depth = {0.5, 0.05, 0.6, NAN, 0.7, 0.8}, speed = {1.0, 2.0, 3.0, 4.0, NAN, 6.0};
    const SparseRasters sparse = sparse_of({depth.data(), speed.data()}, depth.data(), part, whole, 0.1);
    CHECK(sparse.pixels() == 4);
    std::vector<Index> pixels;
    sparse.for_each([&](Index pixel, std::size_t) { pixels.push_back(pixel); });
    CHECK(pixels == std::vector<Index>{8, 10, 15, 16});
    CHECK(sparse.values[0] == std::vector<float>{0.5F, 0.6F, 0.7F, 0.8F});
    CHECK(sparse.values[1] == std::vector<float>{1.0F, 3.0F, 0.0F, 6.0F});
    // Where the flow was thin, what lies there covers the ground: pixel 9.
    const std::vector<double> cover = {0.5, 0.15, 0.6, NAN, 0.7, 0.8};
    const SparseRasters buried = sparse_of({depth.data()}, cover.data(), part, whole, 0.1);
    CHECK(buried.values[0] == std::vector<float>{0.5F, 0.05F, 0.6F, 0.7F, 0.8F});
    CHECK_THROWS_AS(sparse_of({depth.data()}, depth.data(), {3, 2, 10.0, 2.0, 2.0}, whole, 0.1), InternalError);
}

TEST_CASE("Quantiles of a bed that sinks in some runs and rises in others put runs that do not come between",
          "[ensemble]") {
    const GridGeometry grid{1, 1, 0.0, 0.0, 1.0};
    const SparseRasters sinks = row_of(0, {-2.0F}), less = row_of(0, {-1.0F}), rises = row_of(0, {3.0F});
    SparseRasters none;
    none.values.resize(1);
    PixelValues pixels(grid);
    const PeaksInMemory four({&sinks, &rises, &none, &less});
    pixels.gather(four, {1.0, 1.0, 1.0, 1.0}, 0);
    const std::vector<std::pair<double, double>> expected = {{0.25, -2.0}, {0.5, -1.0}, {0.75, 0.0}, {0.95, 3.0}};
    for (const auto& [share, value] : expected) CHECK(pixels.quantile(share).values[0] == value);
    const PeaksInMemory two({&sinks, &less});
    pixels.gather(two, {1.0, 1.0}, 0);
    CHECK(pixels.quantile(0.95).values[0] == -1.0);
    CHECK(pixels.mean().values[0] == -1.5);
}

TEST_CASE("Maps of many runs count weights: above a threshold, below a quantile, on the mean", "[ensemble]") {
    const GridGeometry grid{4, 1, 0.0, 0.0, 1.0};
    const SparseRasters a = row_of(0, {1.0F, 2.0F, 3.0F}), b = row_of(1, {4.0F, 5.0F}), none;
    SparseRasters empty = none;
    empty.values.resize(1);
    PixelValues pixels(grid);
    pixels.gather(PeaksInMemory({&a, &b, &empty}), {0.5, 0.3, 0.2}, 0);
    const auto near = [](const Raster& found, const std::vector<double>& expected) {
        for (std::size_t k = 0; k < expected.size(); ++k) CHECK(found.values[k] == Approx(expected[k]).margin(1e-7));
    };
    near(pixels.exceeds(2.0), {0.0, 0.3, 0.8, 0.0});  // 2 does not exceed 2
    CHECK(pixels.largest() == 5.0);
    near(pixels.reached(), {0.5, 0.8, 0.8, 0.0});
    near(pixels.mean(), {0.5, 2.2, 3.0, 0.0});
    near(pixels.quantile(0.1), {0.0, 0.0, 0.0, 0.0});  // a fifth did not come
    near(pixels.quantile(0.5), {0.0, 2.0, 3.0, 0.0});
    near(pixels.quantile(0.95), {1.0, 4.0, 5.0, 0.0});
    const std::vector<double> shares{0.95, 0.1, 0.5, 0.5, 0.2, 0.95, 0.7};
    std::vector<std::size_t> given;
    pixels.for_each_quantile(shares, [&](std::size_t n, const Raster& map) {
        given.push_back(n);
        CHECK(map.values == pixels.quantile(shares.at(n)).values);
    });
    CHECK(given == std::vector<std::size_t>{0, 1, 2, 3, 4, 5, 6});
    const SparseRasters all = row_of(0, {1.0F});
    pixels.gather(PeaksInMemory({&all, &all, &all}), {1.2, 1.2, 0.6}, 0);  // weights with no exact sum
    CHECK(standard_error(pixels.exceeds(0.3).values[0], 3.0) == 0.0);
    CHECK(effective_number({1.0, 1.0, 1.0}) == Approx(3.0));
    CHECK(effective_number({2.0, 1.0}) == Approx(1.8));
    CHECK(standard_error(0.5, 100.0) == Approx(0.05));
}

TEST_CASE("Indices of Ishigami's function are those that are known", "[ensemble]") {
    // Ishigami and Homma (1990): sin x + 7 sin^2 y + 0.1 z^4 sin x, each key uniform in (-pi, pi).
    const double pi = std::acos(-1.0);
    const Design design = make_sensitivity_design(Method::saltelli, 4096, 3, 1);
    REQUIRE(design.points.size() == 5 * 4096);
    const double level = GENERATE(0.0, 100.0);  // adds nothing to what is shared out
    std::vector<std::optional<double>> outcomes;
    for (const auto& u : design.points) {
        const double x = pi * (2.0 * u[0] - 1.0), y = pi * (2.0 * u[1] - 1.0), z = pi * (2.0 * u[2] - 1.0);
        outcomes.emplace_back(level + std::sin(x) + 7.0 * std::sin(y) * std::sin(y) +
                              0.1 * std::pow(z, 4) * std::sin(x));
    }
    const double first[] = {0.3139, 0.4424, 0.0}, total[] = {0.5576, 0.4424, 0.2437};
    const auto found = sensitivities(Method::saltelli, design, outcomes);
    REQUIRE(found.size() == 3);
    // Independent samples would err by about 1 / sqrt(n) = 0.016; Sobol's do better.
    for (std::size_t k = 0; k < 3; ++k) {
        CHECK(found[k].first == Approx(first[k]).margin(0.016));
        CHECK(found[k].total == Approx(total[k]).margin(0.016));
    }
    outcomes[7].reset();  // its whole group goes
    CHECK(sensitivities(Method::saltelli, design, outcomes)[1].first == Approx(0.4424).margin(0.016));
    CHECK(
        sensitivities(Method::saltelli, design, std::vector<std::optional<double>>(design.points.size(), 1.0)).empty());
}

TEST_CASE("Morris' ways change one key at a time, and find the slopes of what is linear", "[ensemble]") {
    const Design design = make_sensitivity_design(Method::morris, 10, 3, 1);
    REQUIRE(design.points.size() == 40);
    std::vector<std::optional<double>> outcomes;
    for (const auto& u : design.points) outcomes.emplace_back(3.0 * u[0] - 2.0 * u[1] + u[1] * u[2]);
    for (std::size_t start = 0; start < 40; start += 4)
        for (std::size_t m = 0; m < 3; ++m) {
            int changed = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                const double step = std::abs(design.points[start + m + 1][k] - design.points[start + m][k]);
                changed += step > 0.0;
                CHECK((step == 0.0 || step == 0.5));
            }
            CHECK(changed == 1);
        }
    const auto found = sensitivities(Method::morris, design, outcomes);
    CHECK(found[0].first == Approx(3.0));
    CHECK(found[0].total == Approx(0.0).margin(1e-7));  // a difference of squares
    CHECK(found[1].total > 0.05);                       // its slope is -2 + z
    CHECK(found[2].total > 0.05);
}

namespace {

/// A plane that falls to the west, of which a run that begins in the east holds a part.
frana::test::LargeGis long_plane() {
    frana::test::LargeGis gis({3000, 60, 2.5, 2.5, 5.0});
    gis.polygons["release.geojson"] = rectangle(12000, 100, 12040, 140);
    return gis;
}

const std::string on_long_plane =
    "[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\ndepth = 2\n[time]\nend = 20\n"
    "[material.bed]\nlaw = \"coulomb\"\nmu = 0.2\n";

}  // namespace

TEST_CASE("The path of an ensemble's runouts leads to the edge of the terrain, of which runs begin with a part",
          "[ensemble]") {
    const frana::test::LargeGis gis = long_plane();
    const EnsembleFile file;
    file.write("case.toml", on_long_plane);
    const EnsemblePlan plan = file.read(head + mu);
    const EnsembleBase base = ensemble_base(plan, gis, {});
    REQUIRE(base.bed.geometry.x0 > 8000.0);  // some 600 nodes west of the release
    REQUIRE(base.start);
    REQUIRE(base.path.size() > 1);
    CHECK(base.path.front().x() == Approx(base.start->x()).margin(2.5));
    CHECK(base.path.back().x() == 2.5);

    file.write("case.toml", on_long_plane + "[output]\nextent = \"terrain\"\n");
    const EnsembleBase all = ensemble_base(plan, gis, {});
    REQUIRE(all.bed.geometry == base.whole);
    CHECK(all.path == base.path);
}

TEST_CASE("The bed over what was shown is that of the terrain, and of what a scene holds", "[ensemble]") {
    const frana::test::LargeGis gis = long_plane();
    const EnsembleFile file;
    file.write("case.toml", on_long_plane);
    const Scene scene = build_scene(CaseFile::read(file.read(head + mu).case_file), gis);
    REQUIRE(scene.wider);
    const NodeBox west{100, 10, 50, 20};
    const Raster bed = bed_over(scene.bed, scene.wider.get(), west.of(scene.wider->grid));
    CHECK(bed.geometry == united(west, scene.wider->held).of(scene.wider->grid));
    CHECK(bed.values == gis.plane_on(united(west, scene.wider->held)).values);
    CHECK(bed_over(scene.bed, nullptr, west.of(scene.wider->grid)).geometry == scene.bed.geometry);
}

TEST_CASE("A varied key of a numbered table that the case does not have is refused", "[ensemble]") {
    const FakeGis gis = frana::test::slope_gis();
    const EnsembleFile file;
    file.write("case.toml", on_long_plane);
    const auto complaint = [&](const std::string& key) -> std::string {
        const EnsemblePlan plan = file.read(head + "[[ensemble.vary]]\nkey = \"" + key + "\"\nrange = [0.1, 0.3]\n");
        try {
            ensemble_base(plan, gis, {});
        } catch (const UserError& error) {
            return error.what();
        }
        return "";
    };
    CHECK(complaint("release.0.depth").empty());
    CHECK(complaint("material.bed.mu").empty());
    CHECK_THAT(complaint("release.1.depth"),
               Contains("many.toml: release.1.depth: found a varied key of a table that ") &&
                   Contains("case.toml does not have; it has 1 [[release]], which count from 0"));
    CHECK_THAT(complaint("material.zone.0.mu"), Contains("it has 0 [[material.zone]]"));
}

TEST_CASE("An ensemble says where zones set a key of the bed that varies", "[ensemble]") {
    const FakeGis gis = frana::test::slope_gis();
    const EnsembleFile file;
    const auto remarks = [&](const std::string& zones, const std::string& more) {
        file.write("case.toml", on_long_plane + zones);
        const EnsemblePlan plan =
            file.read(head + "[[ensemble.vary]]\nkey = \"material.bed.mu\"\nrange = [0.1, 0.3]\n" + more);
        std::string found;
        for (const std::string& remark : ensemble_base(plan, gis, {}).remarks)
            if (remark.find("holds outside of zones") != std::string::npos) found += remark;
        return found;
    };
    const std::string zone = "[[material.zone]]\nbelow = 5000\nmu = 0.2\n";
    CHECK(remarks("", "").empty());
    CHECK(remarks(zone, "[[ensemble.vary]]\nkey = \"material.zone.0.mu\"\nrange = [0.1, 0.3]\n").empty());
    CHECK(remarks(zone, "") ==
          "material.bed.mu holds outside of zones that set it (material.zone.0); vary material.zone.0.mu as well if it "
          "is meant");
}

TEST_CASE("What varies is told with its distribution's numbers", "[ensemble]") {
    const EnsembleFile file;
    const auto words = [&](const std::string& method, const std::string& vary) {
        return words_of(
            file.read("[ensemble]\ncase = \"case.toml\"\n" + method + "[[ensemble.vary]]\n" + vary).vary[0]);
    };
    const std::string lhs = "samples = 2\n", depth = "key = \"release.0.depth\"\n";
    CHECK(words(lhs, depth + "range = [0.5, 2]\n") == "uniform, 0.5 to 2 m");
    CHECK(words("method = \"grid\"\n", depth + "range = [0.5, 2]\nlevels = 3\n") == "uniform, 0.5 to 2 m, on 3 levels");
    CHECK(words(lhs, depth + "distribution = \"triangular\"\nrange = [0.5, 1, 2]\n") ==
          "triangular, 0.5 to 2 m, most likely 1 m");
    CHECK(words(lhs, depth + "distribution = \"normal\"\nmean = 1\nsd = 0.2\nrange = [0.5, 2]\n") ==
          "normal, mean 1 m, standard deviation 0.2 m, cut to 0.5 to 2 m");
    const std::string xi = "key = \"material.bed.xi\"\n";
    CHECK(words(lhs, xi + "distribution = \"lognormal\"\nmedian = 400\nfactor = 2\nrange = [100, 2000]\n") ==
          "lognormal, median 400 m/s^2, factor 2, cut to 100 to 2000 m/s^2");
    CHECK(words(lhs, depth + "distribution = \"beta\"\nrange = [0.5, 2]\nalpha = 2\nbeta = 5\n") ==
          "beta, 0.5 to 2 m, alpha 2, beta 5");
    CHECK(words(lhs, depth + "distribution = \"discrete\"\nvalues = [1, 2]\nweights = [0.75, 0.25]\nreturn_periods = "
                             "[30, 100]\n") ==
          "discrete, 1 m with weight 0.75 (30 years), 2 m with weight 0.25 (100 years)");
}

TEST_CASE("Fields of a bed that no run changes are told", "[ensemble]") {
    const FakeGis gis = frana::test::slope_gis();
    const EnsembleFile file;
    file.write(
        "case.toml",
        "[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\ndepth = 2\n[time]\nend = 20\n");
    const auto told = [&](const std::string& key) {
        const EnsemblePlan plan = file.read(
            "[ensemble]\ncase = \"case.toml\"\nsamples = 2\nfields = [\"peak_depth\", "
            "\"eroded_depth\"]\n[[ensemble.vary]]\nkey = \"" +
            key + "\"\nrange = [1.0, 1.5]\n");
        const std::vector<std::string> remarks = ensemble_base(plan, gis, {}).remarks;
        return std::count_if(remarks.begin(), remarks.end(), [](const std::string& remark) {
            return remark.find("found \"eroded_depth\"; expected a field of this case") != std::string::npos;
        });
    };
    CHECK(told("release.0.depth") == 1);
    CHECK(told("erodible.depth") == 0);
}

TEST_CASE("An ensemble has the remarks of its case, and those of a sample that are others", "[ensemble]") {
    const FakeGis gis = frana::test::slope_gis();
    const EnsembleFile file;
    file.write("case.toml",
               "[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\ndepth = 2\n[time]\nend = "
               "20\n[material.bed]\nlaw = \"voellmy\"\ntable = \"voellmy-salm\"\n");
    const auto plan_of = [&](const std::string& key, const std::string& rest) {
        return file.read(head + "[[ensemble.vary]]\nkey = \"" + key + "\"\n" + rest + "\n");
    };
    const EnsemblePlan plan = plan_of("release.0.depth", "range = [1.0, 1.5]");
    const EnsembleBase base = ensemble_base(plan, gis, {});
    const auto tells = [](const std::string& remark) { return remark.find("m3 are released") != std::string::npos; };
    CHECK(std::count_if(base.remarks.begin(), base.remarks.end(), tells) == 1);
    // The volume follows from the depth, and is in one of the remarks.
    const std::vector<std::string> others = remarks_of_sample(plan, base, 0, gis, {});
    REQUIRE(others.size() == 1);
    CHECK_THAT(others[0], Contains("sample 0: ") && Contains("m3 are released"));
    CHECK(remarks_of_sample(plan_of("time.end", "range = [1.0, 1.5]"), base, 0, gis, {}).empty());
    // Of every sample, among what its run says.
    for (const Index sample : {Index{0}, Index{1}}) {
        const auto result = run_sample(plan, base, sample, gis, {}, Interrupt());
        REQUIRE(result);
        CHECK(std::count_if(result->remarks.begin(), result->remarks.end(),
                            [&](const EndRemark& remark) { return tells(remark.text); }) == 1);
    }
    const EnsemblePlan refused =
        plan_of("release.0.outline", "distribution = \"discrete\"\nvalues = [\"gone.geojson\"]");
    CHECK(remarks_of_sample(refused, base, 0, gis, {}).empty());
}
