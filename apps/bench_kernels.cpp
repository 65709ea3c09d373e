// The kernels of a step alone, on a flow that has moved: Google Benchmark's own options apply.
//   frana_bench_kernels --benchmark_filter=deposit
// Times are of a whole sweep; items are particles.
#include <benchmark/benchmark.h>
#include <omp.h>

#include "checks/bench/blob.h"
#include "shallow/depth_averaged.h"
#include "shallow/shock.h"

namespace {

using namespace frana;

/// A flow after some steps, and its kernels.
struct Bed {
    explicit Bed(Index particles)
        : scene(scene_with(particles)),
          flow(scene),
          transfer(make_transfer(scene)),
          grid_update(make_grid_update(scene)) {
        DepthAveraged simulation(scene);
        for (int n = 0; n < 6; ++n) simulation.advance(1e9);
        flow.particles = simulation.flow().particles;
        TileSorter().sort(flow.particles, flow.grid, {}, flow.active);  // as they lie
        step = simulation.status().dt;
        transfer->deposit(flow, step);
        surface();
        grid_update->update(flow, step, step);
    }
    void surface() {
        depth_pass(flow, {0.1, {0.0, 0.0}});
        mark_margin(flow);
        shock_pass(flow, 0.0);
        filter(flow);
        shoreline(flow);
    }
    static Scene scene_with(Index particles) {
        bench::Blob blob;
        blob.particles = particles;
        return bench::blob_scene(blob);
    }
    Scene scene;
    Flow flow;
    std::unique_ptr<TransferKernel> transfer;
    std::unique_ptr<GridUpdateKernel> grid_update;
    TileSorter sorter;
    double step = 0.0;  ///< [s]
};

/// Built once per size: most of it is the scene.
Bed& bed_of(benchmark::State& state) {
    static std::unique_ptr<Bed> bed;
    static Index held = 0;
    if (held != state.range(0)) bed.reset(new Bed(held = state.range(0)));
    return *bed;
}

template <class Body>
void sweep(benchmark::State& state, Body&& body) {
    omp_set_num_threads(1);
    Bed& bed = bed_of(state);
    for (auto unused : state) {
        (void)unused;
        body(bed);
    }
    state.SetItemsProcessed(state.iterations() * bed.flow.particles.count());
}

void deposit(benchmark::State& state) {
    sweep(state, [](Bed& b) { benchmark::DoNotOptimize(b.transfer->deposit(b.flow, b.step)); });
}
/// With a step of no length: the same work, and the points stay where they are.
void gather(benchmark::State& state) {
    sweep(state, [](Bed& b) { benchmark::DoNotOptimize(b.transfer->gather(b.flow, 0.0)); });
}
void update_nodes(benchmark::State& state) {
    sweep(state, [](Bed& b) { benchmark::DoNotOptimize(b.grid_update->update(b.flow, b.step, b.step)); });
}
void depth_to_shoreline(benchmark::State& state) {
    sweep(state, [](Bed& b) { b.surface(); });
}
void shock(benchmark::State& state) {
    sweep(state, [](Bed& b) { shock_pass(b.flow, 0.0); });
}
void sort_by_tile(benchmark::State& state) {
    sweep(state, [](Bed& b) { b.sorter.sort(b.flow.particles, b.flow.grid, {}, b.flow.active); });
}

BENCHMARK(deposit)->Arg(70000)->Arg(500000)->Unit(benchmark::kMillisecond);
BENCHMARK(gather)->Arg(70000)->Arg(500000)->Unit(benchmark::kMillisecond);
BENCHMARK(update_nodes)->Arg(70000)->Arg(500000)->Unit(benchmark::kMillisecond);
BENCHMARK(depth_to_shoreline)->Arg(70000)->Arg(500000)->Unit(benchmark::kMillisecond);
BENCHMARK(shock)->Arg(70000)->Arg(500000)->Unit(benchmark::kMillisecond);
BENCHMARK(sort_by_tile)->Arg(70000)->Arg(500000)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
