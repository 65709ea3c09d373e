// Preloaded into the program by fault_runs (LD_PRELOAD): at each look the wall clock stands ten days before or behind, as
// when somebody sets it. Clocks that only measure spans are left alone: no setting moves them.
#include <dlfcn.h>
#include <sys/time.h>
#include <time.h>

#include <atomic>

namespace {

time_t jump() {
    static std::atomic<unsigned> looks{0};
    constexpr time_t kTenDays = 10 * 86400;
    return looks++ % 2 == 0 ? kTenDays : -kTenDays;
}

}  // namespace

extern "C" {

int clock_gettime(clockid_t which, timespec* now) {
    static const auto real = reinterpret_cast<int (*)(clockid_t, timespec*)>(dlsym(RTLD_NEXT, "clock_gettime"));
    const int result = real(which, now);
    if (which == CLOCK_REALTIME && result == 0) now->tv_sec += jump();
    return result;
}

time_t time(time_t* now) {
    timespec at{};
    clock_gettime(CLOCK_REALTIME, &at);
    if (now) *now = at.tv_sec;
    return at.tv_sec;
}

int gettimeofday(timeval* now, void*) {
    timespec at{};
    clock_gettime(CLOCK_REALTIME, &at);
    *now = {at.tv_sec, at.tv_nsec / 1000};
    return 0;
}
}
