#include "session.h"

#include <omp.h>

#include <sstream>

#include "run/folder/run_job.h"
#include "terrain/part_of.h"

namespace frana {

/// The last of the observers: those before it have written their output when the user sees the frame.
class Session::Gate final : public Observer {
public:
    explicit Gate(Session& session) : session_(session) {}
    std::string name() const override { return "python"; }
    void step(const Status& now, const Probe&) override {
        if (first_step_ < 0) first_step_ = now.step;
        if (session_.pause_ || tick_due()) {
            session_.status_ = now;
            session_.stand(session_.pause_ ? State::paused : State::tick);
            last_tick_ = std::chrono::steady_clock::now();
        }
        if (now.step > first_step_) session_.enter();
    }
    bool wants_frame(const Status& now) override { return !session_.to_output_ && now.time >= session_.until_; }
    void observe_between(const Frame& frame) override { show(frame); }
    void observe(const Frame& frame) override {
        if (session_.to_output_ || frame.status.time >= session_.until_) show(frame);
    }

private:
    bool tick_due() const {
        if (!(session_.wishes_.tick > 0.0)) return false;
        const std::chrono::duration<double> since = std::chrono::steady_clock::now() - last_tick_;
        return since.count() >= session_.wishes_.tick;
    }

    void show(const Frame& frame) {
        session_.status_ = frame.status;
        session_.frame_ = &frame;
        ++session_.frames_;
        session_.stand(State::at_frame);
        session_.frame_ = nullptr;
        std::shared_ptr<FrameMemory>& memory = session_.memory_;
        if (memory.use_count() > 1) {  // else no reader is left, and none can begin
            memory->given = session_.simulation_->give_frame_away();
            memory = std::make_shared<FrameMemory>();
        }
    }

    Session& session_;
    Index first_step_ = -1;  ///< where it began
    std::chrono::steady_clock::time_point last_tick_{};
};

Session::Session(CaseFile file, Wishes wishes) : wishes_(std::move(wishes)), file_(std::move(file)) {
    thread_ = std::thread([this] { work(); });
}

Session::~Session() {
    end();
    thread_.join();
}

void Session::end() {
    interrupt_.request();
    ending_ = true;
    go_to(std::numeric_limits<double>::infinity());
}

void Session::go(bool to_output, double until) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (state_ == State::over) return;
    to_output_ = to_output, until_ = until;
    pause_ = false;
    state_ = State::runs;
    changed_.notify_all();
}

bool Session::wait(std::chrono::milliseconds time) {
    std::unique_lock<std::mutex> lock(mutex_);
    return changed_.wait_for(lock, time, [this] { return state_ != State::runs; });
}

std::optional<Raster> Session::ground_of(const Frame& frame) const {
    const Raster& all = simulation_->ground() != nullptr ? *simulation_->ground() : scene_->bed;
    const std::optional<NodeBox> shown = box_of(frame.grid, all.geometry);
    if (!shown) return {};
    Raster ground = part_of(all, *shown);
    ground.crs_wkt = crs_;
    const Field* const change = scene_->bed_evolves() ? frame.node("bed_change") : nullptr;
    if (change == nullptr) return ground;
    for (std::size_t n = 0; n < ground.values.size(); ++n) ground.values[n] += change->data[n];
    return ground;
}

/// On the run's thread.
void Session::stand(State state) {
    std::unique_lock<std::mutex> lock(mutex_);
    if (ending_) return;
    state_ = state;
    changed_.notify_all();
    changed_.wait(lock, [this] { return state_ == State::runs; });
}

/// What was added while it stood, after a step. Then nothing that is shown changes any more, and a saved state has been
/// restored. A run that ends takes nothing in. On the run's thread.
void Session::enter() {
    if (added_.count() == 0) return;
    if (!ending_) simulation_->add(added_);
    added_ = {};
}

void Session::work() {
    try {
        if (wishes_.threads > 0) omp_set_num_threads(wishes_.threads);  // of this thread's own work alone
        wishes_.in_folder ? run_in_folder(file_) : run_in_memory(file_);
        failure_ = record_.summary.failure;
        status_ = record_.summary.last;
    } catch (...) {
        failure_ = std::current_exception();
    }
    simulation_ = nullptr, scene_ = nullptr;
    const std::lock_guard<std::mutex> lock(mutex_);
    state_ = State::over;
    changed_.notify_all();
}

void Session::begin(const Scene& scene, Simulation& simulation) {
    simulation_ = &simulation, scene_ = &scene;
    status_ = simulation.status();
    planned_end_ = scene.end, density_ = scene.density, cell_ = scene.bed.geometry.cell, crs_ = scene.bed.crs_wkt;
    stand(State::ready);
}

void Session::run_in_folder(const CaseFile& file) {
    CaseRun run(file, wishes_.run);
    record_ = run.record();
    begin(run.scene(), run.simulation());
    std::ostringstream unheard;
    Progress progress(unheard, Progress::Style::silent, run.scene().density);
    Observers gate;
    gate.push_back(std::make_unique<Gate>(*this));
    record_ = run.carry_out(interrupt_, progress, std::move(gate), &rasters_);
}

void Session::run_in_memory(const CaseFile& file) {
    const Scene scene = scene_to_run(file, wishes_.run.until, wishes_.run.say);
    const std::unique_ptr<Simulation> simulation = make_simulation(scene);
    record_ = begin_record(scene, file);
    record_.threads = omp_get_max_threads();
    begin(scene, *simulation);
    std::ostringstream unheard;
    Progress progress(unheard, Progress::Style::silent, scene.density);
    Observers gate;
    gate.push_back(std::make_unique<Gate>(*this));
    RunRecord record = record_;
    record_ =
        carry_out_in_memory(scene, *simulation, std::move(record), interrupt_, progress, std::move(gate), rasters_);
}

}  // namespace frana
