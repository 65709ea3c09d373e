#include "checks/bench/suite.h"

#include <fmt/core.h>
#include <omp.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "checks/bench/blob.h"
#include "checks/bench/body.h"
#include "checks/bench/structured.h"

namespace frana::bench {
namespace {

constexpr Index kReference = 500000, kFewest = 1000;
constexpr double kEmptiness = 100.0;      ///< of the wide grid
constexpr Index kWideParticles = 671089;  ///< fill one per cent of 4096 x 4096 cells: a larger grid fills the memory

/// Scenes that are compared with one another, timed in turns with one thread. Other work of the machine meets all
/// alike.
struct Group {
    std::vector<std::string> models;
    std::vector<Scene> scenes;
    int rounds = 1;  ///< runs from the start; the fastest counts
    void add(const char* model, const Blob& blob) { models.push_back(model), scenes.push_back(blob_scene(blob)); }
};

/// What a scene does not need: friction and rheology; topography; and structure, water and grains, which it may have.
Group with_and_without(Index particles) {
    Blob full, bare, level;
    full.particles = bare.particles = level.particles = particles;
    bare.friction = bare.rheology = false;
    level.topography = false;
    level.sleeps = false;  // level ground stops the blob before the last window
    Group group;
    group.add("depth_averaged_in_turns", full);
    group.add("depth_averaged_bare", bare);
    group.add("depth_averaged_level", level);
    for (const ParticlesThat what :
         {ParticlesThat::hold, ParticlesThat::break_up, ParticlesThat::are_grains, ParticlesThat::drain}) {
        group.models.push_back(name_of(what));
        group.scenes.push_back(structured_blob(what, particles));
    }
    return group;
}

/// Loose ground below the flow, and friction by zones. All have the steps that loose ground needs.
Group with_ground(Index particles) {
    Blob plain;
    plain.particles = particles;
    Blob loose = plain, zones = plain;
    loose.erodes = zones.zones = true;
    Group group;
    group.rounds = 2;
    group.add("depth_averaged_rock", plain);
    group.add("depth_averaged_erodible", loose);
    group.add("depth_averaged_zones", zones);
    for (Scene& scene : group.scenes) scene.scheme.cfl = 0.5;
    return group;
}

/// A village beyond the flow, on a grid that has room for it.
Group with_houses(Index particles) {
    Blob none;
    none.particles = particles;
    none.emptiness = 4.0;
    Blob village = none;
    village.houses = 500;
    Group group;
    group.rounds = 2;
    group.add("depth_averaged_no_houses", none);
    group.add("depth_averaged_houses", village);
    return group;
}

Group asleep_and_awake(Index particles) {
    Blob asleep;
    asleep.particles = particles;
    asleep.topography = false;
    asleep.resting = 0.9;
    Blob awake = asleep;
    awake.sleeps = false;
    Group group;
    group.add("depth_averaged_resting", asleep);
    group.add("depth_averaged_resting_awake", awake);
    group.rounds = 3;  // a run has one window between falling asleep and the end of all motion
    return group;
}

Group tight_and_wide(Index particles) {
    Blob tight;
    tight.particles = particles;
    Blob wide = tight;
    wide.emptiness = kEmptiness;
    Group group;
    group.add("depth_averaged_tight", tight);
    group.add("depth_averaged_wide", wide);
    return group;
}

Plan plan_for(const Options& options, const std::string& model, Index particles, int threads) {
    Plan plan;
    if (model.find("_resting") != std::string::npos) {  // once the first sleep, and before the last have come to rest
        plan.warm_steps = 9;
        plan.windows = 1;
        return plan;
    }
    plan.threads = threads;
    plan.windows = options.quick ? 3 : particles <= 100000 ? 12 : particles <= 1000000 ? 7 : 3;
    return plan;
}

/// The same short run with different numbers of threads.
std::map<int, std::uint64_t> hashes(const Options& options) {
    Blob blob;
    blob.particles = std::min<Index>(20000, reference_particles(options));
    const Scene scene = blob_scene(blob);
    Plan plan;
    plan.windows = 2;
    std::map<int, std::uint64_t> found;
    std::vector<int> threads = options.threads;
    threads.insert(threads.end(), {1, 2, 4});
    for (const int n : threads) {
        plan.threads = n;
        if (!found.count(n)) found[n] = measure(scene, plan).hash;
    }
    return found;
}

void require_sensible(const Options& options) {
    const auto refuse = [](const char* option, Index found, const std::string& expected) {
        throw UserError(
            fmt::format("{}: found {}; expected {}; choose a number in this range", option, found, expected));
    };
    for (const Index count : options.particles)
        if (count < kFewest || count > 100000000) refuse("--particles", count, fmt::format("{} to 100000000", kFewest));
    for (const int threads : options.threads)
        if (threads < 1 || threads > 1024) refuse("--threads", threads, "1 to 1024");
    expect(!options.particles.empty() && !options.threads.empty(), "a bench without particles or threads");
}

void time_in_turns(Report& report, const Group& group, const std::function<void(const std::string&)>& say) {
    const Index particles = group.scenes.front().particles.count();
    std::string names;
    for (const std::string& model : group.models) names += (names.empty() ? "" : ", ") + model;
    say(fmt::format("in turns: {}: {} particles, 1 thread", names, particles));
    const Plan plan = plan_for(report.options, group.models.front(), particles, 1);
    std::vector<Cost> best = measure_in_turns(group.scenes, plan);
    for (int round = 1; round < group.rounds; ++round) {
        const std::vector<Cost> again = measure_in_turns(group.scenes, plan);
        for (std::size_t n = 0; n < best.size(); ++n)
            if (again[n].ns(again[n].full()) < best[n].ns(best[n].full())) best[n] = again[n];
    }
    for (std::size_t n = 0; n < best.size(); ++n) report.timed.push_back({group.models[n], "double", best[n]});
}

std::vector<int> with_one(std::vector<int> threads) {
    threads.push_back(1);
    std::sort(threads.begin(), threads.end());
    threads.erase(std::unique(threads.begin(), threads.end()), threads.end());
    return threads;
}

}  // namespace

Report run(const Options& wanted, const std::function<void(const std::string&)>& say) {
    require_sensible(wanted);
    Report report;
    Options& options = report.options = wanted;
    options.threads = with_one(options.threads);  // ratios need it
    CalibrationPlan plan;
    plan.threads = options.threads;
    plan.array_bytes = options.array_bytes;
    if (options.quick) plan.rounds = 5;
    say("calibrating: triad and node-touch");
    report.calibration = calibrate(plan);

    const auto time = [&](const std::string& model, const Scene& scene, int threads) {
        const char* precision = scene.scheme.precision == Precision::single ? "float" : "double";
        const Index particles = scene.particles.count();
        say(fmt::format("{}: {} particles, {} threads", model, particles, threads));
        report.timed.push_back({model, precision, measure(scene, plan_for(options, model, particles, threads))});
    };
    for (const Index particles : options.particles) {
        if (options.quick && particles > kReference) continue;
        Blob blob;
        blob.particles = particles;
        const Scene scene = blob_scene(blob);
        for (const int threads : options.threads) time("depth_averaged", scene, threads);
    }
    Blob single;
    single.particles = reference_particles(options);
    single.single = true;
    for (const int threads : options.threads) time("depth_averaged", blob_scene(single), threads);
    for (const BodyLaw law : {BodyLaw::fluid, BodyLaw::bingham, BodyLaw::drucker_prager}) {
        const SolidScene scene = body_scene(law, reference_particles(options));
        const auto points = static_cast<Index>(scene.points.mass.size());
        for (const int threads : options.threads) {
            say(fmt::format("{}: {} points, {} threads", name_of(law), points, threads));
            const Plan timing = plan_for(options, name_of(law), points, threads);
            report.timed.push_back({name_of(law), "double", measure(scene, timing)});
        }
    }
    const Index reference = reference_particles(options);
    time_in_turns(report, with_and_without(reference), say);
    time_in_turns(report, with_ground(reference), say);
    time_in_turns(report, with_houses(reference), say);
    time_in_turns(report, asleep_and_awake(reference), say);
    if (!options.quick || reference < kReference)
        time_in_turns(report, tight_and_wide(reference >= kReference ? kWideParticles : reference), say);
    if (!options.writers.empty()) {
        say("frames: made and written");
        report.frames =
            time_frames(reference_particles(options), options.writers, std::filesystem::temp_directory_path());
    }
    say("the same run with different numbers of threads");
    report.hashes = hashes(options);
    return report;
}

const Timed* find(const Report& report, const std::string& model, Index particles, int threads,
                  const std::string& precision) {
    for (const Timed& timed : report.timed) {
        const bool counted = particles == 0 || timed.cost.particles == particles;
        if (counted && timed.model == model && timed.precision == precision && timed.cost.threads == threads)
            return &timed;
    }
    return nullptr;
}

Index reference_particles(const Options& options) {
    return *std::min_element(options.particles.begin(), options.particles.end(),
                             [](Index a, Index b) { return std::abs(a - kReference) < std::abs(b - kReference); });
}

}  // namespace frana::bench
