// Maps of an ensemble with closed answers: indices per pixel, times of arrival, bounds of probabilities.
#include <cmath>

#include "catch.h"
#include "ensemble/sensitivity.h"
#include "ensemble/statistics.h"

using namespace frana;

namespace {

/// A raster for each run, on all pixels of a row: `field(u, pixel)`.
template <class Field>
std::vector<SparseRasters> runs_of(const Design& design, Index pixels, Field&& field) {
    std::vector<SparseRasters> runs;
    for (const auto& u : design.points) {
        SparseRasters& run = runs.emplace_back();
        run.rows.push_back({0, pixels});
        run.values.emplace_back();
        for (Index pixel = 0; pixel < pixels; ++pixel) run.values[0].push_back(static_cast<float>(field(u, pixel)));
    }
    return runs;
}

struct Gathered {
    explicit Gathered(const std::vector<SparseRasters>& runs, Index pixels) : values({pixels, 1, 0.0, 0.0, 1.0}) {
        std::vector<const SparseRasters*> all;
        for (std::size_t k = 0; k < runs.size(); ++k) all.push_back(&runs[k]), samples.push_back(static_cast<Index>(k));
        values.gather(PeaksInMemory(all), std::vector<double>(runs.size(), 1.0), 0);
    }
    PixelValues values;
    std::vector<Index> samples;
};

}  // namespace

TEST_CASE("Maps of Sobol's indices are those of the function that each pixel is of the keys", "[ensemble]") {
    const Design design = make_sensitivity_design(Method::saltelli, 4096, 2, 1);
    // x + c y: shares 1 : c^2. x y: each alone 3/7, together 4/7. A constant, though above 1.
    const auto runs = runs_of(design, 4, [](const std::vector<double>& u, Index pixel) {
        return pixel == 0 ? u[0] : pixel == 1 ? u[0] + 2.0 * u[1] : pixel == 2 ? u[0] * u[1] : 3.3;
    });
    const Gathered all(runs, 4);
    const SensitivityMaps maps = sensitivity_maps(Method::saltelli, design, all.samples, all.values);
    REQUIRE(maps.first.size() == 2);
    // Independent samples would err by about 1 / sqrt(n) = 0.016; Sobol's do better.
    const double first[2][3] = {{1.0, 0.2, 3.0 / 7.0}, {0.0, 0.8, 3.0 / 7.0}},
                 total[2][3] = {{1.0, 0.2, 4.0 / 7.0}, {0.0, 0.8, 4.0 / 7.0}};
    for (std::size_t key = 0; key < 2; ++key)
        for (std::size_t pixel = 0; pixel < 3; ++pixel) {
            CHECK(maps.first[key].values[pixel] == Approx(first[key][pixel]).margin(0.016));
            CHECK(maps.total[key].values[pixel] == Approx(total[key][pixel]).margin(0.016));
        }
    CHECK(maps.first[0].values[0] == Approx(1.0));  // exactly: no other key is in it
    CHECK(maps.total[1].values[0] == Approx(0.0).margin(1e-15));
    for (std::size_t key = 0; key < 2; ++key) {
        CHECK(std::isnan(maps.first[key].values[3]));
        CHECK(std::isnan(maps.total[key].values[3]));
    }
}

TEST_CASE("Where only some runs come, an index counts the others as zero; a failed run takes its group along",
          "[ensemble]") {
    const Design design = make_sensitivity_design(Method::saltelli, 64, 2, 3);
    std::vector<SparseRasters> runs;
    std::vector<Index> samples;
    std::vector<std::optional<double>> outcomes(design.points.size());
    for (std::size_t k = 0; k < design.points.size(); ++k) {
        if (k == 5) continue;  // failed
        const double value = design.points[k][0] > 0.5 ? 1.0 + design.points[k][1] : 0.0;
        SparseRasters& run = runs.emplace_back();
        run.values.emplace_back();
        if (value > 0.0) run.rows.push_back({1, 1}), run.values[0].push_back(static_cast<float>(value));
        samples.push_back(static_cast<Index>(k));
        outcomes[k] = static_cast<double>(static_cast<float>(value));
    }
    const Gathered all(runs, 2);
    const SensitivityMaps maps = sensitivity_maps(Method::saltelli, design, samples, all.values);
    const auto expected = sensitivities(Method::saltelli, design, outcomes);
    for (std::size_t key = 0; key < 2; ++key) {
        CHECK(maps.first[key].values[1] == Approx(expected.at(key).first).epsilon(1e-14));
        CHECK(maps.total[key].values[1] == Approx(expected.at(key).total).epsilon(1e-14));
        CHECK(std::isnan(maps.first[key].values[0]));  // no run comes there
    }
}

TEST_CASE("Maps of Morris' mean effects are the slopes of what is linear", "[ensemble]") {
    const Design design = make_sensitivity_design(Method::morris, 8, 2, 1);
    const auto runs = runs_of(design, 2, [](const std::vector<double>& u, Index pixel) {
        return pixel == 0 ? 10.0 - 3.0 * u[0] + 0.5 * u[1] : 7.7;
    });
    const Gathered all(runs, 2);
    const SensitivityMaps maps = sensitivity_maps(Method::morris, design, all.samples, all.values);
    // Float32 of numbers up to 10, over steps of a half.
    CHECK(maps.first[0].values[0] == Approx(3.0).margin(4e-6));
    CHECK(maps.first[1].values[0] == Approx(0.5).margin(4e-6));
    CHECK(std::isnan(maps.first[0].values[1]));
}

TEST_CASE("The time by which a share of the runs has come: never is later than any", "[ensemble]") {
    const auto run = [](const std::vector<float>& times) {
        SparseRasters one;
        if (!times.empty()) one.rows.push_back({0, static_cast<std::int64_t>(times.size())});
        one.values.push_back(times);
        return one;
    };
    // Pixel 0: at 10, 20, 30 and never. Pixel 1: at 5 once in four. Pixel 2: a time below zero is none. Pixel 3: no run.
    const SparseRasters a = run({10.0F, 5.0F, -1.0F}), b = run({30.0F}), c = run({20.0F}), d = run({});
    PixelValues pixels({4, 1, 0.0, 0.0, 1.0});
    pixels.gather(PeaksInMemory({&a, &b, &c, &d}), {1.0, 1.0, 1.0, 1.0}, 0);
    const Raster quarter = pixels.arrival_quantile(0.25), half = pixels.arrival_quantile(0.5),
                 most = pixels.arrival_quantile(0.75), all = pixels.arrival_quantile(0.95);
    CHECK(quarter.values[0] == 10.0);
    CHECK(half.values[0] == 20.0);
    CHECK(most.values[0] == 30.0);
    CHECK(std::isnan(all.values[0]));
    CHECK(quarter.values[1] == 5.0);
    CHECK(std::isnan(half.values[1]));
    for (const Raster* map : {&quarter, &half, &most, &all})
        for (const std::size_t pixel : {2, 3}) CHECK(std::isnan(map->values[pixel]));
    pixels.gather(PeaksInMemory({&a, &b, &c, &d}), {2.0, 0.5, 0.5, 1.0}, 0);  // weights count
    CHECK(pixels.arrival_quantile(0.5).values[0] == 10.0);
}

TEST_CASE("Wilson's bounds are the probabilities that are a normal error away from what was found", "[ensemble]") {
    for (const double n : {1.0, 10.0, 1000.0})
        for (const double p : {0.0, 0.1, 0.5, 1.0}) {
            CAPTURE(n, p);
            const auto [low, high] = wilson_bounds(p, n);
            // Their definition: (p - q)^2 = z^2 q (1 - q) / n at both ends.
            const auto off = [&](double q) { return (p - q) * (p - q) - 3.841458820694124 * q * (1.0 - q) / n; };
            CHECK(off(low) == Approx(0.0).margin(1e-14));
            CHECK(off(high) == Approx(0.0).margin(1e-14));
            CHECK(low <= p);
            CHECK(high >= p);
        }
    CHECK(wilson_bounds(1.0, 10.0).first == Approx(10.0 / (10.0 + 3.841458820694124)).epsilon(1e-12));
    CHECK(wilson_bounds(0.3, 0.0) == std::pair{0.0, 1.0});
}

TEST_CASE("The shares of the runs above a ladder of thresholds are those above each of them", "[ensemble]") {
    std::vector<SparseRasters> runs;
    std::vector<const SparseRasters*> all;
    std::vector<double> weights;
    for (int k = 0; k < 40; ++k) {
        runs.emplace_back();
        runs.back().rows.push_back({k % 3, 2});  // pixels 0 to 3 of five
        runs.back().values.push_back({0.1F * static_cast<float>(k % 7), 0.05F * static_cast<float>(k)});
    }
    for (const SparseRasters& run : runs)
        all.push_back(&run), weights.push_back(1.0 + static_cast<double>(all.size() % 4));
    PixelValues values({5, 1, 0.0, 0.0, 1.0});
    values.gather(PeaksInMemory(all), weights, 0);
    const std::vector<double> thresholds = {0.0, 0.1, 0.3, 0.35, 1.2, 5.0};  // 0.1 and 0.3 are values of runs too
    Index pixels = 0;
    values.for_each_curve(thresholds, [&](Index pixel, const std::vector<double>& shares) {
        ++pixels;
        REQUIRE(shares.size() == thresholds.size());
        for (std::size_t k = 0; k < shares.size(); ++k)
            CHECK(shares[k] ==
                  Approx(values.exceeds(thresholds[k]).values[static_cast<std::size_t>(pixel)]).margin(1e-15));
    });
    CHECK(pixels == 4);
}
