// What is looked at does not change what happens: a run has the same bits whatever the time between its frames.
#include <sstream>

#include "analytic_scene.h"
#include "catch.h"
#include "channel_with_wall.h"
#include "coupling/staged_run.h"
#include "observe/memory_archive.h"
#include "run/run_loop.h"

using namespace frana;
using namespace frana::test;

namespace {

/// A slab in a gully three cells wide that comes to rest in part: points split, merge, leave, and sleep.
Scene gully() {
    Scene scene = scene_on(61, 25, 5.0, [](double x, double y) {
        const double rest = std::max(0.0, 230.0 - x), across = std::min(15.0, std::abs(y - 60.0));
        return 1.1e-3 * rest * rest + 0.02 * across * across;
    });
    scene.bed_law = bed::Voellmy{0.2, 400.0};
    scene.rheology = rheology::Bingham{200.0, 50.0};
    fill(scene, [](double x, double y) { return x > 20 && x < 90 && y > 40 && y < 80 ? 1.5 : 0.0; });
    return scene;
}

/// Notes down when frames are, and whether they are whole.
class Times final : public Observer {
public:
    explicit Times(std::vector<double>& times) : times_(times) {}
    std::string name() const override { return "times"; }
    void observe(const Frame& frame) override {
        times_.push_back(frame.status.time);
        double mass = 0.0;
        const Field& masses = *frame.particle("mass");
        for (Index p = 0; p < masses.count; ++p) mass += masses.data[p];
        if (times_.size() == 1) whole_ = mass;
        CHECK(mass + frame.status.mass_left == Approx(whole_).epsilon(1e-12));
    }

private:
    std::vector<double>& times_;
    double whole_ = 0.0;
};

struct Outcome {
    std::map<std::string, MemoryArchive::Entry> state;
    std::vector<double> frames;
    RunSummary summary;
};

template <class Model>
Outcome run_with(const Scene& scene, double every, double end) {
    Outcome outcome;
    Model simulation(scene);
    Observers observers;
    observers.push_back(std::make_unique<Times>(outcome.frames));
    std::ostringstream stream;
    Progress progress(stream, Progress::Style::silent, scene.density);
    outcome.summary = run(simulation, {end, every, false}, observers, Interrupt(), progress);
    MemoryArchive archive;
    simulation.serialize(archive);
    outcome.state = archive.entries();
    return outcome;
}

}  // namespace

namespace {

/// All bits of the frames that it is shown. Requests an interrupt with the frame of that number.
class FrameBits final : public Observer {
public:
    FrameBits(std::vector<std::vector<double>>& frames, Interrupt* interrupt, std::size_t at)
        : frames_(frames), interrupt_(interrupt), at_(at) {}
    std::string name() const override { return "bits"; }
    void observe(const Frame& frame) override {
        std::vector<double> bits = {frame.status.time};
        for (const auto* fields : {&frame.particles, &frame.nodes})
            for (const Field& field : *fields)
                bits.insert(bits.end(), field.data, field.data + field.count * field.components);
        frames_.push_back(std::move(bits));
        if (interrupt_ && frames_.size() == at_) interrupt_->request();
    }

private:
    std::vector<std::vector<double>>& frames_;
    Interrupt* interrupt_;
    std::size_t at_;
};

class InMemory final : public StateKeeper {
public:
    bool due() const override { return false; }
    void save(double, const State& state) override {
        kept_.emplace();
        state(*kept_);
    }
    bool load(const State& state) override {
        if (kept_) state(kept_->rewind());
        return kept_.has_value();
    }

private:
    std::optional<MemoryArchive> kept_;
};

/// Frames of a run whose steps pass several outputs each.
std::vector<std::vector<double>> frames_of(const Scene& scene, InMemory* keeper, bool resumed, std::size_t until = 0) {
    std::vector<std::vector<double>> frames;
    Interrupt interrupt;
    DepthAveraged simulation(scene, resumed ? Start::resumed : Start::placed);
    Observers observers;
    observers.push_back(std::make_unique<FrameBits>(frames, until > 0 ? &interrupt : nullptr, until));
    std::ostringstream stream;
    Progress progress(stream, Progress::Style::silent, scene.density);
    run(simulation, {2.0, 0.05, false}, observers, interrupt, progress, keeper);
    return frames;
}

}  // namespace

TEST_CASE("Frames of a run that was stopped between outputs of one step have the same bits when it goes on",
          "[conserve][resume]") {
    const Scene scene = gully();
    const auto whole = frames_of(scene, nullptr, false);
    REQUIRE(whole.size() == 41);
    for (const std::size_t until : {2, 3, 7, 8, 9}) {
        InMemory keeper;
        auto frames = frames_of(scene, &keeper, false, until);
        REQUIRE(frames.size() >= until);
        REQUIRE(frames.size() < whole.size());
        const std::size_t before = frames.size();
        for (auto& frame : frames_of(scene, &keeper, true)) frames.push_back(std::move(frame));
        CAPTURE(until, before);
        REQUIRE(frames.size() == whole.size());
        for (std::size_t n = 0; n < whole.size(); ++n) CHECK((frames[n] == whole[n]));
    }
}

TEST_CASE("A run has the same bits whatever the time between its frames, which are hit exactly", "[conserve]") {
    constexpr double kEnd = 40.0;
    for (const Scheme& scheme : {Scheme{}, [] {
                                     Scheme s;
                                     s.precision = Precision::single;
                                     return s;
                                 }()}) {
        Scene scene = gully();
        scene.scheme = scheme;
        const Outcome seldom = run_with<DepthAveraged>(scene, 1000.0, kEnd);
        CHECK(seldom.frames == std::vector<double>{0.0, kEnd});
        for (const double every : {0.05, 0.7, 5.0}) {  // several in a step, one in a few, rare
            const Outcome often = run_with<DepthAveraged>(scene, every, kEnd);
            CAPTURE(every);
            REQUIRE(often.frames.size() >= 8);
            for (std::size_t k = 0; k + 1 < often.frames.size(); ++k)
                REQUIRE(often.frames[k] == static_cast<double>(k) * every);
            CHECK(often.frames.back() == kEnd);
            CHECK(often.summary.steps == seldom.summary.steps);
            CHECK(often.summary.extremes.max_speed == seldom.summary.extremes.max_speed);
            REQUIRE(often.state.size() == seldom.state.size());
            for (const auto& [name, entry] : seldom.state) {
                if (name.rfind("clock", 0) == 0) continue;  // wall time
                INFO(name);
                CHECK((often.state.at(name) == entry));
            }
        }
    }
}

TEST_CASE("3D points alone have the same bits whatever the time between frames, and so have loads of barriers",
          "[conserve][stages][barrier]") {
    constexpr double kEnd = 1.3;
    Scene scene = coarse_channel(0.6);
    scene.end = 10.0;
    if (GENERATE(true, false)) scene.solid->until = 1.1035;  // in the step that a frame at 1.104 is in
    const Outcome seldom = run_with<StagedRun>(scene, 1000.0, kEnd);
    for (const double every : {0.008, 0.06, 0.5}) {  // as long as a step, a few, many
        const Outcome often = run_with<StagedRun>(scene, every, kEnd);
        CAPTURE(every);
        REQUIRE(often.frames.size() >= 3);
        for (std::size_t k = 0; k + 1 < often.frames.size(); ++k)
            REQUIRE(often.frames[k] == static_cast<double>(k) * every);
        CHECK(often.summary.steps == seldom.summary.steps);
        REQUIRE(often.state.size() == seldom.state.size());
        for (const auto& [name, entry] : seldom.state) {
            // What lies in pieces is found at outputs.
            if (name.find("clock") != name.npos || name.find("apart") != name.npos || name == "pieces") continue;
            INFO(name);
            CHECK((often.state.at(name) == entry));
        }
    }
}

namespace {

/// What frames show of peaks, one after the other.
class PeaksOfFrames final : public Observer {
public:
    std::string name() const override { return "peaks"; }
    void observe(const Frame& frame) override {
        for (const char* field : {"peak_depth", "peak_speed", "peak_pressure", "peak_dynamic_pressure"}) {
            const std::vector<double> now = values_of(frame, field);
            std::vector<double>& before = before_[field];
            for (std::size_t k = 0; k < before.size(); ++k) fallen_ += now[k] < before[k];
            before = now;
        }
        const std::vector<double> now = values_of(frame, "arrival_time");
        std::vector<double>& before = before_["arrival_time"];
        for (std::size_t k = 0; k < before.size(); ++k) fallen_ += before[k] >= 0.0 && now[k] != before[k];
        for (const double arrival : now) ahead_ += arrival > frame.status.time;
        before = now;
        largest_ = *std::max_element(before_["peak_depth"].begin(), before_["peak_depth"].end());
    }
    void end(const Frame& last) override { at_end_ = values_of(last, "peak_depth"); }

    Index fallen() const { return fallen_; }  ///< nodes whose peak fell, or whose arrival changed, between two frames
    Index ahead() const { return ahead_; }    ///< nodes that were reached after the frame's time
    double largest() const { return largest_; }  ///< peak depth of the last frame [m]
    bool ends_with_last() const { return at_end_ == before_.at("peak_depth"); }
    const std::vector<double>& last(const char* field) const { return before_.at(field); }

private:
    static std::vector<double> values_of(const Frame& frame, const char* name) {
        const Field& field = *frame.node(name);
        return {field.data, field.data + field.count};
    }
    std::map<std::string, std::vector<double>> before_;
    std::vector<double> at_end_;
    Index fallen_ = 0, ahead_ = 0;
    double largest_ = 0.0;
};

}  // namespace

TEST_CASE("Peaks never fall from one frame to the next, nor do times of arrival change", "[conserve][peaks]") {
    Scene scene = gully();
    if (GENERATE(false, true)) scene.deposition = Deposition{0.5};
    for (const double every : {0.05, 0.23}) {
        DepthAveraged simulation(scene);
        Observers observers;
        observers.push_back(std::make_unique<PeaksOfFrames>());
        const auto& peaks = static_cast<const PeaksOfFrames&>(*observers.back());
        std::ostringstream stream;
        Progress progress(stream, Progress::Style::silent, scene.density);
        const RunSummary summary = run(simulation, {20.0, every, false}, observers, Interrupt(), progress);
        REQUIRE(summary.frames > summary.steps / 4);
        CHECK(peaks.fallen() == 0);
        CHECK(peaks.ahead() == 0);
        CHECK(peaks.ends_with_last());
        CHECK(peaks.largest() == summary.extremes.max_depth);
    }
}

TEST_CASE("Peaks of structured solids and of water never fall either, and are those of the run's own steps",
          "[conserve][peaks][structured][water]") {
    Scene scene = gully();
    const bool solids = GENERATE(true, false), water = GENERATE(true, false);
    if (!solids && !water) return;
    CAPTURE(solids, water);
    if (solids) {
        Structure structure;
        structure.material.young = 2e6, structure.material.critical_strain = 0.05, structure.cohesion = 600.0;
        scene.structure = structure;
    }
    if (water) scene.water.emplace(), scene.water->share = solids ? 0.3 : 1.0;
    std::vector<double> seldom;
    for (const double every : {1000.0, 0.23, 0.05}) {
        const std::unique_ptr<Simulation> simulation = make_simulation(scene);
        Observers observers;
        observers.push_back(std::make_unique<PeaksOfFrames>());
        const auto& peaks = static_cast<const PeaksOfFrames&>(*observers.back());
        std::ostringstream stream;
        Progress progress(stream, Progress::Style::silent, scene.density);
        run(*simulation, {6.0, every, false}, observers, Interrupt(), progress);
        CAPTURE(every);
        CHECK(peaks.fallen() == 0);
        CHECK(peaks.ahead() == 0);
        if (seldom.empty()) seldom = peaks.last("peak_dynamic_pressure");
        CHECK((peaks.last("peak_dynamic_pressure") == seldom));
    }
    CHECK(*std::max_element(seldom.begin(), seldom.end()) > 0.0);
}

TEST_CASE("The status of a frame without its fields has the same bits", "[conserve]") {
    const Scene scene = gully();
    DepthAveraged looked_at(scene), asked(scene);
    for (int k = 0; k < 60; ++k) {
        const Status whole = looked_at.frame().status, alone = asked.frame_status();
        REQUIRE(whole.kinetic == alone.kinetic);
        REQUIRE(whole.dissipated == alone.dissipated);
        REQUIRE(whole.momentum == alone.momentum);
        REQUIRE(whole.impulse == alone.impulse);
        REQUIRE(whole.max_speed == alone.max_speed);
        REQUIRE(whole.max_speed_on_map == alone.max_speed_on_map);
        looked_at.advance(1e9);
        asked.advance(1e9);
    }
    CHECK(looked_at.frame().status.max_speed > 0.0);
}

TEST_CASE("With all of FLIP the first frame shows the velocities that points start with", "[conserve]") {
    Scene scene = gully();
    scene.scheme.transfer = Transfer::flip;
    scene.scheme.flip_ratio = 1.0;
    for (std::size_t p = 0; p < scene.particles.vx.size(); ++p)
        scene.particles.vx[p] = std::sin(static_cast<double>(p));
    DepthAveraged simulation(scene);
    const Frame first = simulation.frame();
    const Particles& points = simulation.flow().particles;
    const Field& velocity = *first.particle("velocity");
    double largest = 0.0;
    for (Index p = 0; p < velocity.count; ++p) {
        largest = std::max(largest, points.vx[p]);
        CHECK(velocity.data[velocity.components * p] == Approx(points.vx[p]).margin(1e-13));
    }
    CHECK(largest > 0.9);
}
