// Curved tracks: where a thin blob stops on the energy line, and how it swings in a circular bowl.
#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "checks/verify/exact_track.h"
#include "checks/verify/library.h"
#include "checks/verify/slide.h"

namespace frana::verify {
namespace {

using constants::kDegree;

using TrackPointer = std::shared_ptr<const Track>;

/// A track extruded across, its fall line turned, and the blob's way on it.
struct Course {
    Slide slide;
    Function z;
};

Course course(const TrackPointer& track, const Setup& setup, double cell, double turn, double start, double reach) {
    Course made{{cell, turn, start, reach}, [track](double s, double) { return track->z(s); }};
    made.slide.per_side = setup.per_side;
    return made;
}

Trial on_course(const Course& course, const Setup& setup, double mu, Curvature curvature) {
    Scene scene = course.slide.scene(course.z);
    scene.bed_law = bed::Coulomb{mu};
    scene.curvature = curvature;
    scene.scheme.curvature_length = 0.0;  // a formula has no roughness to smooth
    return Trial(std::move(scene), setup);
}

/// Release on the energy line: a track and where on it the blob starts.
struct Release {
    TrackPointer track;
    double mu, start;
};

/// Cells per kilometre. The blob has a few points within 1.2 cells. Paths of points that start apart cross before they
/// stop, which a field of velocities cannot follow. For so small a blob that loss is second order in the cell.
Measurement run_energy_line(const Release& release, const Setup& setup) {
    const double cell = 1000.0 / static_cast<double>(setup.cells), latest = 400.0;
    const Track& track = *release.track;
    const double line = energy_line(track, release.mu, release.start);
    Measurement m;
    const auto run = [&](double turn, Curvature curvature, const auto& error) {
        const Course way = course(release.track, setup, cell, turn * kDegree, release.start, line + 10.0);
        Trial trial = on_course(way, setup, release.mu, curvature);
        const BlobState start = blob_state(trial, way.slide, way.z);
        trial.run_to_rest(latest);
        const BlobState end = blob_state(trial, way.slide, way.z);
        if (m.steps == 0) m = trial.measure();
        return error(start, end);
    };
    const auto off_line = [&](const BlobState& from, const BlobState& to) {
        return to.along - from.along - (from.height - to.height) / release.mu;
    };
    const auto off_path = [&](const BlobState& from, const BlobState& to) {
        return to.along - stop_of(track, release.mu, from.along, Normal::full);
    };
    const double straight = run(0.0, Curvature::inertia, off_line);
    m.add("stop_error", straight, "m");
    m.add("turned_15", run(15.0, Curvature::inertia, off_line), "m");
    m.add("turned_45", run(45.0, Curvature::inertia, off_line), "m");
    m.add("full_normal", run(0.0, Curvature::full, off_path), "m");
    return m;
}

Problem energy_problem(const std::string& name, const std::string& title, const Release& release, double gate,
                       const std::string& source) {
    Problem problem{name,
                    title,
                    {100, 200, 400},
                    [release] { return track_residuals(*release.track, release.mu, release.start); },
                    [release](const Setup& setup) { return run_energy_line(release, setup); }};
    problem.order_of = "stop_error";
    for (const char* quantity : {"stop_error", "turned_15", "turned_45", "full_normal"}) {
        problem.gates.push_back({200, quantity, gate, source});
        problem.gates.push_back({400, quantity, gate / std::pow(2.0, 1.5), source + ", order 1.5"});
    }
    problem.gates.push_back({0, "mass_error", 1e-13, "round-off"});
    return problem;
}

constexpr double kTrackRadius = 100.0, kAngle = 35.0;

/// A bowl that is round: the track turned about its middle.
Trial bowl_trial(const Setup& setup, Course& way, double turn, double mu) {
    const double start = -kTrackRadius * std::sin(kAngle * kDegree);
    way = course(circle(kTrackRadius), setup, 100.0 / static_cast<double>(setup.cells), turn * kDegree, start, -start);
    way.z = [track = circle(kTrackRadius)](double s, double n) { return track->z(std::hypot(s, n)); };
    return on_course(way, setup, mu, Curvature::full);
}

/// Swings 40 s without friction (2 periods), along the grid and turned; and comes to rest with friction 0.2. Cells per
/// radius.
Measurement run_bowl(const Setup& setup) {
    const TrackPointer track = circle(kTrackRadius);
    Course way;
    Measurement m;
    for (const double turn : {0.0, 27.0}) {
        Trial trial = bowl_trial(setup, way, turn, 0.0);
        const BlobState start = blob_state(trial, way.slide, way.z);
        const std::string name = turn == 0.0 ? "" : "_turned";
        for (const double time : {20.0, 40.0}) {
            trial.run_to(time);
            const BlobState now = blob_state(trial, way.slide, way.z);
            const std::string at = (time == 20.0 ? "_20" : "_40") + name;
            m.add("place" + at, now.along - place_of(*track, start.along, time), "m");
            m.add("energy" + at, now.energy / start.energy - 1);
        }
        if (turn > 0.0) continue;
        const std::vector<Extra> extras = m.extras;
        m = trial.measure();
        m.extras = extras;
    }
    constexpr double kMu = 0.2;
    Trial trial = bowl_trial(setup, way, 0.0, kMu);
    const double start = blob_state(trial, way.slide, way.z).along;
    trial.run_to_rest(100.0);
    m.add("stop_error", blob_state(trial, way.slide, way.z).along - stop_of(*track, kMu, start, Normal::full), "m");
    return m;
}

}  // namespace

std::vector<Problem> track_problems() {
    const Release parabola_660{parabola(std::tan(40 * kDegree), 660.0), 0.4, 30.0};
    const Release hockey{hockey_stick(34, 100), 0.4, -650.0};
    // AvaFrame's avaParabola; the centre of its release polygon.
    const Release avaframe{parabola(2 * std::tan(34 * kDegree), 2200 / std::tan(34 * kDegree)), 0.4, 1692.5};
    Problem bowl{"bowl",
                 "thin blob swinging in a spherical bowl of 100 m from 35 degrees, against the pendulum",
                 {25, 50, 100},
                 [] { return pendulum_residuals(kTrackRadius, kAngle); },
                 run_bowl};
    bowl.order_of = "stop_error";
    const std::string earlier = "what an earlier code had";
    bowl.gates = {{0, "mass_error", 1e-13, "round-off"}, {100, "stop_error", 0.077, earlier}};
    for (const std::string turned : {"", "_turned"}) {
        bowl.gates.push_back({100, "energy_20" + turned, 2.7e-3, earlier});
        bowl.gates.push_back({100, "energy_40" + turned, 4.5e-3, earlier});
        bowl.gates.push_back({100, "place_40" + turned, 0.09, earlier});
    }
    return {energy_problem("energy_parabola", "energy line of a thin blob on a parabola from 40 to 0 degrees",
                           parabola_660, 0.1, "goal; an earlier code 0.06 m"),
            energy_problem("energy_hockey", "energy line of a thin blob on 34 degrees, an arc of 100 m and a flat",
                           hockey, 0.5, "goal; an earlier code 0.41 m"),
            energy_problem("energy_avaframe", "energy line on AvaFrame's avaParabola (its single points: 0.006 m)",
                           avaframe, 0.1, "as the other parabola"),
            bowl};
}

}  // namespace frana::verify
