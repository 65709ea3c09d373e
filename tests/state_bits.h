#pragma once
// All bits of a depth-averaged run's state but its wall clock, by name.
#include <iterator>
#include <map>
#include <string>

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

}  // namespace frana::test
