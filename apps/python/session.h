#pragma once
// A run that stands still where somebody wants to observe it, and goes on when told to. It is the program's own run.
// The time loop works on a thread of its own, and the last of its observers makes it wait. It is without Python.
#include <sys/types.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "particles/seeds.h"
#include "run/folder/run_case.h"

namespace frana {

/// What a frame's fields point into, for its readers. While the run stands that is the simulation's own memory. When it
/// goes on and a reader is left, the memory is the reader's.
struct FrameMemory {
    std::shared_ptr<const void> given;
};

class Session {
public:
    struct Wishes {
        RunWishes run;
        bool in_folder = true;  ///< false: nothing is written, and run.out, resume and overwrite have no effect
        int threads = 0;        ///< 0: as OMP_NUM_THREADS or the machine says
        double tick = 0.0;      ///< stand about so often, to report progress [s]; 0: never
    };
    /// Where it is. All but `runs` stand still.
    enum class State { runs, ready, at_frame, tick, paused, over };

    /// Begins to build the scene; wait() tells when it is `ready`.
    Session(CaseFile file, Wishes wishes);
    /// Ends the run as Ctrl-C would, and waits for that.
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    /// Goes on to the next output, or to the first moment at or after `until` [s]; infinity: to the end.
    void go_to_output() { go(true, std::numeric_limits<double>::infinity()); }
    void go_to(double until) { go(false, until); }
    /// Goes on to wherever it was going.
    void go_on() { go(to_output_, until_); }
    /// Requests a stand after the present step.
    void pause() { pause_ = true; }
    /// Requests an end, without any more stands.
    void end();
    /// Material that enters with the next step, while it stands.
    void add(const Seeds& particles) { added_.append(particles, 0, particles.count()); }
    /// Whether it stands, or came to stand within the time.
    bool wait(std::chrono::milliseconds time);

    // The following while it stands.
    State state() const {
        const std::lock_guard<std::mutex> lock(mutex_);
        return state_;
    }
    const Frame* frame() const { return frame_; }  ///< nullptr unless `at_frame`
    Index frames() const { return frames_; }       ///< that it has stood at, this one included
    const std::shared_ptr<FrameMemory>& memory() const { return memory_; }
    const Status& status() const { return status_; }  ///< of the last step
    double planned_end() const { return planned_end_; }
    double density() const { return density_; }      ///< of the case [kg/m3]
    double cell() const { return cell_; }            ///< of the case [m]
    const std::string& crs() const { return crs_; }  ///< of the case, WKT
    /// The elevation model's heights on the nodes of a frame, with the bed's change in it [m]. Unlike the frame's own
    /// "elevation" they are not averaged. Before it is `over`; nothing where the frame is on other nodes.
    std::optional<Raster> ground_of(const Frame& frame) const;
    /// nullptr before it is `ready` and once it is `over`.
    Simulation* simulation() const { return simulation_; }
    const std::vector<std::string>& remarks() const { return record_.warnings; }
    /// Why it did not begin or went wrong on the way, once it is `over`; null: it did not.
    const std::exception_ptr& failure() const { return failure_; }
    const RunRecord& record() const { return record_; }  ///< whole once it is `over`
    const std::vector<ProductRaster>& rasters() const { return rasters_; }

private:
    class Gate;
    void go(bool to_output, double until);
    void work();
    void run_in_folder(const CaseFile& file);
    void run_in_memory(const CaseFile& file);
    void begin(const Scene& scene, Simulation& simulation);
    void stand(State state);
    void enter();

    Wishes wishes_;
    CaseFile file_;
    Interrupt interrupt_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    State state_ = State::runs;
    std::atomic<bool> to_output_{true};
    std::atomic<double> until_{std::numeric_limits<double>::infinity()};
    std::atomic<bool> pause_{false}, ending_{false};

    Simulation* simulation_ = nullptr;
    const Scene* scene_ = nullptr;  ///< as long as there is a simulation
    const Frame* frame_ = nullptr;
    Index frames_ = 0;
    std::shared_ptr<FrameMemory> memory_ = std::make_shared<FrameMemory>();
    Status status_;
    double planned_end_ = 0.0, density_ = 1.0, cell_ = 1.0;
    std::string crs_;
    Seeds added_;
    std::exception_ptr failure_;
    RunRecord record_;
    std::vector<ProductRaster> rasters_;
    std::thread thread_;
};

}  // namespace frana
