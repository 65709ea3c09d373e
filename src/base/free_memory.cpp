#include "base/free_memory.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

namespace frana {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::infinity();

/// MemAvailable of Linux: free pages and caches that can be dropped.
double system_memory() {
    std::ifstream file("/proc/meminfo");
    std::string key, unit;
    for (double number = 0.0; file >> key >> number;) {
        if (key == "MemAvailable:") return 1024.0 * number;
        std::getline(file, unit);
    }
    return kUnknown;
}

/// What is left below the limit of control group version 2; "max" stands for none.
double container_memory() {
    double limit = 0.0, used = 0.0;
    std::ifstream most("/sys/fs/cgroup/memory.max"), now("/sys/fs/cgroup/memory.current");
    if (!(most >> limit) || !(now >> used)) return kUnknown;
    return std::max(0.0, limit - used);
}

}  // namespace

double free_memory() { return std::min(system_memory(), container_memory()); }

}  // namespace frana
