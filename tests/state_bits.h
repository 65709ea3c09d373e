#pragma once
// All bits of a depth-averaged run's state but its wall clock, by name.
#include <cstring>
#include <iterator>
#include <map>
#include <string>

#include "catch.h"
#include "observe/memory_archive.h"
#include "shallow/depth_averaged.h"

namespace frana::test {

inline std::map<std::string, MemoryArchive::Entry> bits(DepthAveraged& simulation) {
    MemoryArchive archive;
    simulation.serialize(archive);
    auto entries = archive.entries();
    for (auto entry = entries.begin(); entry != entries.end();)
        entry = entry->first.rfind("clock/", 0) == 0 ? entries.erase(entry) : std::next(entry);
    return entries;
}

/// Two runs have the same bits, and those of their beds, which a state has not. `ledger`: of the bed, that both keep.
inline void check_same(DepthAveraged& a, DepthAveraged& b, const std::string& ledger) {
    const auto of_a = bits(a), of_b = bits(b);
    REQUIRE(of_a.size() == of_b.size());
    REQUIRE(of_a.count(ledger) == 1);
    for (const auto& [name, entry] : of_a) {
        INFO(name);
        CHECK((of_b.at(name) == entry));
    }
    const BedGeometry &x = a.flow().bed, &y = b.flow().bed;
    const auto size = static_cast<std::size_t>(a.flow().grid.size()) * sizeof(double);
    for (const auto field : {&BedGeometry::z, &BedGeometry::ground, &BedGeometry::z_min, &BedGeometry::slope_x,
                             &BedGeometry::slope_y, &BedGeometry::hxx, &BedGeometry::hxy})
        CHECK(std::memcmp((x.*field).data(), (y.*field).data(), size) == 0);
    CHECK(std::memcmp(x.smooth.data(), y.smooth.data(), 2 * size) == 0);
}

}  // namespace frana::test
