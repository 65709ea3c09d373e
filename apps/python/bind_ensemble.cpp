// Ensembles: the program's own, on threads of their own, and what their folders hold.
#include <atomic>
#include <chrono>
#include <stdexcept>
#include <utility>

#include "base/error.h"
#include "bindings.h"
#include "io/band_words.h"
#include "run/ensemble/ensemble_run.h"
#include "waiting.h"

namespace frana {
namespace {

using Seconds = std::chrono::duration<double>;

EnsemblePlan plan_of_file(const std::string& file, const std::vector<std::string>& exceed) {
    return aside([&] {
        EnsemblePlan plan = read_ensemble(file);
        for (const std::string& wish : exceed) add_exceedance(plan, wish);
        return plan;
    });
}

/// What runs may tell of while Python waits for them.
struct Told {
    std::atomic<std::size_t> all{0}, done{0}, failed{0};
};

/// Runs and maps on a thread of their own. Whatever ends the wait for it, the interrupt is requested and the thread over before
/// this is gone.
class Work {
public:
    Work(EnsemblePlan plan, std::string dir, int threads, bool resume) {
        over_ = std::async(std::launch::async, [this, plan = std::move(plan), dir = std::move(dir), threads, resume] {
            return work(plan, dir, threads, resume);
        });
    }
    ~Work() {
        if (!over_.valid()) return;
        interrupt_.request();
        const py::gil_scoped_release release;
        over_.wait();
    }
    Work(const Work&) = delete;
    Work& operator=(const Work&) = delete;

    bool wait(std::chrono::milliseconds time) {
        const py::gil_scoped_release release;
        return over_.wait_for(time) == std::future_status::ready;
    }
    EnsembleSummary summary() { return over_.get(); }
    const Told& told() const { return told_; }

private:
    EnsembleSummary work(const EnsemblePlan& plan, const std::string& dir, int threads, bool resume) {
        const auto start = std::chrono::steady_clock::now();
        const EnsembleRun ensemble(plan, dir);
        const std::vector<Index> samples = ensemble.left_to_run(Shard{}, resume);
        told_.all = samples.size();
        ensemble.run(Shard{}, samples, threads, interrupt_,
                     [this](bool failed) { told_.failed += failed, ++told_.done; });
        if (interrupt_.requested()) return {};
        return ensemble.join(Seconds(std::chrono::steady_clock::now() - start).count());
    }

    Interrupt interrupt_;
    Told told_;
    std::future<EnsembleSummary> over_;
};

/// `progress` gets done, all and failed, up to five times a second. Ctrl-C and what it raises end the runs.
py::dict run_ensemble(EnsemblePlan plan, const std::string& dir, int threads, bool resume, const py::object& progress) {
    const Waiting waiting;
    Work work(std::move(plan), dir, threads, resume);
    constexpr int kTold = 4;  // samples between two calls
    for (int look = 1;; ++look) {
        const bool over = work.wait(std::chrono::milliseconds(50));
        if (Waiting::outlived())
            throw std::runtime_error("Python is ending; what has run is kept: resume=True goes on");
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        const Told& told = work.told();
        if (!progress.is_none() && told.all > 0 && (over || look % kTold == 0))
            progress(told.done.load(), told.all.load(), told.failed.load());
        if (over) break;
    }
    const EnsembleSummary summary = work.summary();
    py::dict found;
    found["run"] = summary.run, found["samples"] = summary.samples, found["failed"] = summary.failed;
    found["too_many_failed"] = summary.too_many_failed(), found["sentence"] = runs_sentence(summary);
    return found;
}

py::tuple map_of_file(const std::string& file, const std::string& name) {
    const Raster raster = aside([&] {
        std::vector<std::string> log;
        const double far = 1e300;
        return GdalReader().read_raster(file, {-far, -far, far, far}, "", log);
    });
    const auto [unit, meaning] = aside([&] { return band_words(file); });
    return py::make_tuple(name, unit, meaning, north_up(raster));
}

py::tuple probability(const std::string& dir, const std::string& field, double above) {
    const Raster raster =
        aside([&] { return EnsembleRun(read_ensemble(origin_of_ensemble(dir)), dir).probability(field, above); });
    const std::string meaning = meaning_of_exceedance(peak_field(field), above);
    return py::make_tuple("probability_" + field, "1", meaning, north_up(raster));
}

}  // namespace

void bind_ensemble(py::module_& module) {
    py::class_<EnsemblePlan>(module, "EnsemblePlan")
        .def_readonly("samples", &EnsemblePlan::samples)
        .def_readonly("method", &EnsemblePlan::method_name)
        .def_readonly("fields", &EnsemblePlan::fields)
        .def_property_readonly("keys", [](const EnsemblePlan& plan) {
            std::vector<std::string> keys;
            for (const Vary& vary : plan.vary) keys.push_back(vary.key);
            return keys;
        });
    module.def("ensemble_plan", &plan_of_file);
    module.def("run_ensemble", &run_ensemble);
    module.def("ensemble_map", &map_of_file);
    module.def("ensemble_probability", &probability);
}

}  // namespace frana
