#include "observe/barriers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace frana {
namespace {

std::vector<std::string> columns_of(std::size_t faces) {
    if (faces == 0) return {"t [s]", "run_up [m]", "overtopped [m3]"};
    std::vector<std::string> columns = {"t [s]",    "fx [N]",   "fy [N]",         "fz [N]",     "mx [N m]",
                                        "my [N m]", "mz [N m]", "mean_force [N]", "run_up [m]", "overtopped [m3]"};
    for (std::size_t face = 0; face < faces; ++face) {
        for (const char axis : {'x', 'y', 'z'}) columns.push_back(fmt::format("f{}{} [N]", face, axis));
        for (const char axis : {'x', 'y', 'z'}) columns.push_back(fmt::format("m{}{} [N m]", face, axis));
    }
    return columns;
}

}  // namespace

std::vector<std::string> remarks_on_rising(const std::vector<BarrierSummary>& barriers, const ForcesEnd& end) {
    std::vector<std::string> remarks;
    for (const BarrierSummary& barrier : barriers) {
        if (barrier.means.empty()) continue;
        if (!(barrier.blur > 0.0)) {  // no point came to it
            if (std::isfinite(barrier.run_up) || barrier.overtopped > 0.0)
                remarks.push_back(
                    fmt::format("{}: found the flow at it, but no 3D point until {} at {:.6g} s: no force on it is "
                                "known; let stage.window hold it, and give a later {}",
                                barrier.name, end.at, end.time, end.later));
            continue;
        }
        const MeanForce& longest = barrier.means.back();  // windows ascend
        if (!(longest.largest > 0.0) || longest.time < end.time - longest.window) continue;
        remarks.push_back(
            fmt::format("{}: found the largest mean of its force over {:g} s, {:.4g} kN, up to {:.6g} s, where {} at "
                        "{:.6g} s; expected it to end {:g} s before or earlier, since the force may have been rising "
                        "still; give a later {}",
                        barrier.name, longest.window, 1e-3 * longest.largest, longest.time, end.at, end.time,
                        longest.window, end.later));
    }
    return remarks;
}

Barriers::Barriers(std::filesystem::path run_dir, const std::vector<NamedBarrier>& barriers,
                   std::vector<BarrierSummary>& summaries)
    : run_dir_(std::move(run_dir)), summaries_(summaries) {
    summaries_.resize(barriers.size());
    for (std::size_t n = 0; n < barriers.size(); ++n) {
        names_.push_back(barriers[n].name);
        summaries_[n].name = names_[n];
        for (const double window : barriers[n].windows) summaries_[n].means.emplace_back().window = window;
    }
}

void Barriers::begin(const BarrierLoads& loads) {
    expect(loads.barriers.size() == names_.size(), "every barrier has a name");
    if (!has_tables()) return;
    watched_.resize(names_.size());
    for (std::size_t n = 0; n < names_.size(); ++n) {
        tables_.emplace_back(run_dir_ / "barriers" / (names_[n] + ".csv"), columns_of(loads.barriers[n].faces.size()));
        watched_[n].before.resize(loads.barriers[n].faces.size());
        watched_[n].lately.emplace_back().time = time_;
    }
}

void Barriers::step(const Status& now, const Probe& probe) {
    const BarrierLoads* const loads = probe.loads();
    const double dt = now.time - time_;
    if (loads != nullptr && watched_.empty()) begin(*loads);
    time_ = now.time;
    if (loads == nullptr || !(dt > 0.0)) return;
    if (!has_tables()) return step_without_forces(*loads);
    for (std::size_t n = 0; n < names_.size(); ++n) {
        const BarrierLoad& load = loads->barriers[n];
        if (!loads->measures || load.faces.empty()) {
            step_without_force(n, now.time, load);
            continue;
        }
        Watched& watched = watched_[n];
        BarrierSummary& summary = summaries_[n];
        std::vector<double> row(10), faces;
        Vec3 force(0, 0, 0), moment(0, 0, 0);
        Received all;
        all.time = now.time;
        for (std::size_t face = 0; face < load.faces.size(); ++face) {
            const Vec3 f = (load.faces[face].impulse - watched.before[face].impulse) / dt;
            const Vec3 m = (load.faces[face].moment - watched.before[face].moment) / dt;
            force += f, moment += m;
            all.impulse += load.faces[face].impulse, all.moment += load.faces[face].moment;
            faces.insert(faces.end(), {f[0], f[1], f[2], m[0], m[1], m[2]});
        }
        watched.before = load.faces;
        const double mean = note_means(watched, all, loads->blur, summary.means);
        row = {now.time,  force[0],  force[1], force[2],    moment[0],
               moment[1], moment[2], mean,     load.run_up, load.overtopped};
        row.insert(row.end(), faces.begin(), faces.end());
        tables_[n].add(row);
        if (mean > summary.peak_force) summary.peak_force = mean, summary.peak_force_time = now.time;
        if (summary.first_contact < 0.0 && load.touched) note_contact(summary, now.time);
        summary.raw_peak_force = std::max(summary.raw_peak_force, force.head<2>().norm());
        summary.blur = loads->blur;
        summary.impulse = all.impulse;
        take(n, load);
    }
}

/// What pressed before is the blow of this contact, felt from a cell away: no mean ends before it.
void Barriers::note_contact(BarrierSummary& summary, double time) {
    summary.first_contact = time;
    if (summary.peak_force > 0.0) summary.peak_force_time = time;
    for (MeanForce& mean : summary.means)
        if (mean.largest > 0.0) mean.time = time;
}

/// What is known of particles too.
void Barriers::take(std::size_t n, const BarrierLoad& load) {
    summaries_[n].about = load.about;
    summaries_[n].run_up = load.run_up;
    summaries_[n].overtopped = load.overtopped;
}

/// A row of a table where points are no more, or never are. Of a barrier that no point ever came to no force is known.
void Barriers::step_without_force(std::size_t n, double time, const BarrierLoad& load) {
    std::vector<double> row = {time, load.run_up, load.overtopped};
    if (!load.faces.empty()) {
        row.insert(row.begin() + 1, 7, TableWriter::empty);
        row.resize(row.size() + 6 * load.faces.size(), TableWriter::empty);
    }
    tables_[n].add(row);
    if (!load.touched) summaries_[n].blur = 0.0;
    take(n, load);
}

void Barriers::step_without_forces(const BarrierLoads& loads) {
    for (std::size_t n = 0; n < names_.size(); ++n) take(n, loads.barriers[n]);
}

/// Stores what means need, and the largest ones. Returns the horizontal force's over `blur`.
double Barriers::note_means(Watched& watched, const Received& now, double blur, std::vector<MeanForce>& means) {
    double longest = blur;
    for (const MeanForce& mean : means) longest = std::max(longest, mean.window);
    std::vector<Received>& lately = watched.lately;
    lately.push_back(now);
    while (watched.first + 2 < lately.size() && lately[watched.first + 1].time <= now.time - longest) ++watched.first;
    if (watched.first > lately.size() / 2) {  // not at every step: it moves all that is left
        lately.erase(lately.begin(), lately.begin() + static_cast<std::ptrdiff_t>(watched.first));
        watched.first = 0;
    }
    for (MeanForce& largest : means)
        if (const MeanForce mean = mean_over(watched, largest.window); mean.largest > largest.largest) largest = mean;
    return blur > 0.0 ? mean_over(watched, blur).largest : 0.0;
}

/// From what was received up to now and up to `window` ago, or to the beginning.
MeanForce Barriers::mean_over(const Watched& watched, double window) {
    const auto first = watched.lately.begin() + static_cast<std::ptrdiff_t>(watched.first), end = watched.lately.end();
    const Received& now = watched.lately.back();
    const double start = now.time - window;
    const auto later =
        std::upper_bound(first + 1, end - 1, start, [](double time, const Received& r) { return time < r.time; });
    const Received &a = *(later - 1), &b = *later;
    const double share = std::clamp((start - a.time) / (b.time - a.time), 0.0, 1.0);
    MeanForce mean;
    mean.window = window, mean.time = now.time;
    mean.force = (now.impulse - a.impulse - share * (b.impulse - a.impulse)) / window;
    mean.moment = (now.moment - a.moment - share * (b.moment - a.moment)) / window;
    mean.largest = mean.force.head<2>().norm();
    return mean;
}

void Barriers::observe(const Frame&) {
    for (TableWriter& table : tables_) table.flush();
}

void Barriers::serialize_without_tables(Archive& archive) {
    std::vector<double> all;
    for (const BarrierSummary& s : summaries_)
        all.insert(all.end(), {s.about[0], s.about[1], s.about[2], s.run_up, s.overtopped});
    archive.array("summaries", all);
    if (!archive.loading()) return;
    expect(all.size() == 5 * summaries_.size(), "a state has the barriers of its case");
    for (std::size_t n = 0; n < summaries_.size(); ++n) {
        for (int axis = 0; axis < 3; ++axis) summaries_[n].about[axis] = all[5 * n + static_cast<std::size_t>(axis)];
        summaries_[n].run_up = all[5 * n + 3], summaries_[n].overtopped = all[5 * n + 4];
    }
}

void Barriers::serialize(Archive& archive) {
    archive.numbers("time", {&time_});
    if (!has_tables()) return serialize_without_tables(archive);
    Index begun = watched_.empty() ? 0 : 1;
    archive.number("begun", begun);
    if (!begun) return;
    std::vector<Index> faces;
    for (const Watched& watched : watched_) faces.push_back(static_cast<Index>(watched.before.size()));
    archive.array("faces", faces);
    if (archive.loading()) {
        BarrierLoads loads;
        for (const Index count : faces) loads.barriers.emplace_back().faces.resize(static_cast<std::size_t>(count));
        begin(loads);
    }
    for (std::size_t n = 0; n < names_.size(); ++n) {
        const Archive::Part part(archive, fmt::format("barrier_{}", n));
        BarrierSummary& s = summaries_[n];
        archive.numbers(
            "summary", {&s.first_contact, &s.peak_force, &s.peak_force_time, &s.raw_peak_force, &s.blur, &s.impulse[0],
                        &s.impulse[1], &s.impulse[2], &s.about[0], &s.about[1], &s.about[2], &s.run_up, &s.overtopped});
        std::vector<double*> before;
        for (FaceLoad& load : watched_[n].before)
            for (int k = 0; k < 3; ++k) before.push_back(&load.impulse[k]), before.push_back(&load.moment[k]);
        archive.numbers("before", before);
        for (std::size_t k = 0; k < s.means.size(); ++k) {
            MeanForce& mean = s.means[k];
            archive.numbers(fmt::format("mean_{}", k),
                            {&mean.largest, &mean.time, &mean.force[0], &mean.force[1], &mean.force[2], &mean.moment[0],
                             &mean.moment[1], &mean.moment[2]});
        }
        serialize_lately(archive, watched_[n]);
    }
    serialize_all(archive, tables_);
}

void Barriers::serialize_lately(Archive& archive, Watched& watched) {
    constexpr std::size_t kNumbers = 7;
    std::vector<Received>& lately = watched.lately;
    std::vector<double> all;
    for (auto r = lately.begin() + static_cast<std::ptrdiff_t>(watched.first); r != lately.end(); ++r)
        all.insert(all.end(),
                   {r->time, r->impulse[0], r->impulse[1], r->impulse[2], r->moment[0], r->moment[1], r->moment[2]});
    archive.array("lately", all);
    if (!archive.loading()) return;
    expect(!all.empty() && all.size() % kNumbers == 0, "a state has what barriers received lately");
    lately.clear(), watched.first = 0;
    for (std::size_t k = 0; k + kNumbers <= all.size(); k += kNumbers)
        lately.push_back({all[k], Vec3(all[k + 1], all[k + 2], all[k + 3]), Vec3(all[k + 4], all[k + 5], all[k + 6])});
}

}  // namespace frana
