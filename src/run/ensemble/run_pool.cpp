#include "run/ensemble/run_pool.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <omp.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "vtk_io/barrier_mesh.h"

namespace frana {
namespace {

/// One run allocates what the last one freed. Held back, it does not come from the system page by page again. That took
/// a third of a short run. Arrays so large that most of their pages are never used still come from the system.
void keep_memory() {
#ifdef __GLIBC__
    constexpr int large = 4 << 20, kept = 1 << 30;  // [bytes]
    mallopt(M_MMAP_THRESHOLD, large);
    mallopt(M_TRIM_THRESHOLD, kept);
#endif
}

/// Maps and pictures come after the runs.
void give_memory_back() {
#ifdef __GLIBC__
    constexpr int usual = 128 << 10;  // [bytes]
    mallopt(M_TRIM_THRESHOLD, usual);
    malloc_trim(0);
#endif
}

}  // namespace

void for_each_run(std::size_t count, int threads, const Interrupt& interrupt,
                  const std::function<void(std::size_t)>& body) {
    std::atomic<std::size_t> next{0};
    std::atomic<bool> stop{false};
    std::mutex mutex;
    std::exception_ptr failure;
    keep_memory();
    const auto work = [&] {
        omp_set_num_threads(1);  // of this thread alone
        try {
            for (std::size_t k = next++; k < count && !stop && !interrupt.requested(); k = next++) body(k);
        } catch (...) {  // goes on in the thread that waits for this one
            const std::lock_guard<std::mutex> alone(mutex);
            if (!failure) failure = std::current_exception();
            stop = true;
        }
    };
    std::vector<std::thread> pool;
    const std::size_t wanted = std::min(count, static_cast<std::size_t>(threads));
    try {
        while (pool.size() < wanted) pool.emplace_back(work);
    } catch (const std::system_error&) {  // the system gives no more threads: those that started do all of the work
        if (pool.empty()) throw;
    }
    for (std::thread& thread : pool) thread.join();
    give_memory_back();
    if (failure) std::rethrow_exception(failure);
}

int threads_for_runs(int given) { return given > 0 ? given : omp_get_max_threads(); }

MeshReader meshes_in_turn() {
    return [mutex = std::make_shared<std::mutex>()](const std::filesystem::path& file, const MeshSampling& sampling) {
        const std::lock_guard<std::mutex> alone(*mutex);
        return barrier_mesh_of(file, sampling);
    };
}

}  // namespace frana
