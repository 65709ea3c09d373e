#pragma once
// Runs that have to be the same, to the last bit.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <string>

#include "analytic_scene.h"
#include "catch.h"
#include "observe/budget.h"
#include "observe/memory_archive.h"
#include "shallow/depth_averaged.h"
#include "threads_of_test.h"

namespace frana::test {

inline void check_same(const std::map<std::string, MemoryArchive::Entry>& found,
                       const std::map<std::string, MemoryArchive::Entry>& expected) {
    REQUIRE(found.size() == expected.size());
    REQUIRE(found.size() > 20);
    for (const auto& [name, entry] : expected) {
        INFO(name);
        CHECK((found.at(name) == entry));
    }
}

/// The states of two runs.
inline void check_same(Simulation& found, Simulation& expected) { check_same(state_bits(found), state_bits(expected)); }

/// Two runs that change their beds: the beds are the same too, which a state has not. `ledger`: of the bed, that both keep.
inline void check_same(DepthAveraged& a, DepthAveraged& b, const std::string& ledger) {
    const auto of_b = state_bits(b);
    REQUIRE(of_b.count(ledger) == 1);
    check_same(state_bits(a), of_b);
    const BedGeometry &x = a.flow().bed, &y = b.flow().bed;
    const auto size = static_cast<std::size_t>(a.flow().grid.size()) * sizeof(double);
    for (const auto field : {&BedGeometry::z, &BedGeometry::ground, &BedGeometry::z_min, &BedGeometry::slope_x,
                             &BedGeometry::slope_y, &BedGeometry::hxx, &BedGeometry::hxy})
        CHECK(std::memcmp((x.*field).data(), (y.*field).data(), size) == 0);
    CHECK(std::memcmp(x.smooth.data(), y.smooth.data(), 2 * size) == 0);
}

/// A run on one thread is put away after every so many steps. It goes on from each on 4 and 2 threads, and runs anew on as
/// many: same(such a run, the first) each. Returns the extras of the first.
template <class Same>
Extras check_resumed_often(const Scene& scene, double end, Index steps, Same&& same) {
    const Threads one(1);
    DepthAveraged straight(scene);
    std::vector<MemoryArchive> kept;
    while (straight.status().time < end) {
        if (straight.status().step % steps == 0) straight.serialize(kept.emplace_back());
        straight.advance(end);
    }
    REQUIRE(kept.size() > 4);
    for (std::size_t n = 0; n < kept.size(); ++n) {
        const Threads several(n % 2 == 0 ? 4 : 2);
        DepthAveraged resumed(scene, Start::resumed);
        resumed.serialize(kept[n].rewind());
        INFO("kept at " << resumed.status().time << " s");
        run_to(resumed, end);
        same(resumed, straight);
    }
    for (const int threads : {2, 4}) {
        const Threads several(threads);
        DepthAveraged again(scene);
        run_to(again, end);
        same(again, straight);
    }
    return straight.extras();
}

/// A run on 1, 2, and 4 threads, and one that goes on from a state of half of the time. Mass and momentum are kept.
inline void check_threads_and_resume(const Scene& scene, double end) {
    const double half = 0.5 * end;
    const Threads one(1);
    DepthAveraged alone(scene);
    const Status first = alone.frame().status;
    run_to(alone, half);
    MemoryArchive kept;
    alone.serialize(kept);
    run_to(alone, end);
    for (const int threads : {2, 4}) {
        const Threads several_threads(threads);
        DepthAveraged several(scene);
        run_to(several, half), run_to(several, end);
        check_same(several, alone);
    }
    DepthAveraged resumed(scene, Start::resumed);
    resumed.serialize(kept.rewind());
    run_to(resumed, end);
    check_same(resumed, alone);
    const Budget left_over = budget(first, alone.frame().status);
    CHECK(std::abs(left_over.mass_error) <= 1e-13);
    double impulse = 0.0;
    for (const double part : alone.status().impulse) impulse = std::max(impulse, std::abs(part));
    for (const double residual : left_over.momentum_residual) CHECK(std::abs(residual) <= 1e-11 * impulse);
}

}  // namespace frana::test
