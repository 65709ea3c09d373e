#pragma once
#include <omp.h>

/// Gives back the number of threads that was set before a test changed it.
class Threads {
public:
    Threads() = default;
    explicit Threads(int count) { omp_set_num_threads(count); }
    ~Threads() { omp_set_num_threads(before_); }
    Threads(const Threads&) = delete;
    Threads& operator=(const Threads&) = delete;

private:
    int before_ = omp_get_max_threads();
};
