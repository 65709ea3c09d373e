#include "run/folder/run_3d.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "base/error.h"
#include "observe/table.h"
#include "run/folder/run_film.h"
#include "vtk_io/figures/figure_3d.h"
#include "vtk_io/figures/film.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

std::vector<std::string> names_of(const std::vector<Barrier>& barriers) {
    std::vector<std::string> names;
    names.reserve(barriers.size());
    for (const Barrier& barrier : barriers) names.push_back(barrier.name);
    return names;
}

/// The outputs of a run that has 3D points.
class Run3d {
public:
    explicit Run3d(const FigureSource& source)
        : source_(source),
          times_(particle_times(source.run_dir)),
          loads_(barrier_times(source.run_dir)),
          meshes_(read_barrier_meshes(source.run_dir)),
          forces_(source.run_dir, names_of(source.barriers)) {
        if (!times_.empty()) named_ = read_particles(source.run_dir, -1).arrays.count("model") > 0;
    }

    Index count() const { return static_cast<Index>(times_.size()); }
    double time(Index number) const { return times_[static_cast<std::size_t>(number)]; }

    Index nearest(double time) const {
        Index best = 0;
        for (Index k = 1; k < count(); ++k)
            if (std::abs(this->time(k) - time) < std::abs(this->time(best) - time)) best = k;
        return best;
    }

    /// The last output with points, or the last.
    Index last() const {
        for (Index number = count() - 1; named_ && number >= 0; --number)
            if (moment(number).typical_size > 0.0) return number;
        return count() - 1;
    }

    /// The output midway from the first with points to `last`.
    Index midway(Index last) const {
        Index first = last;
        for (Index number = 0; number < last && first == last; ++number)
            if (moment(number).typical_size > 0.0) first = number;
        const Index middle = (first + last) / 2;
        return moment(middle).typical_size > 0.0 ? middle : last;
    }

    /// The output with points and with the largest horizontal load on one barrier, as told; nothing without any.
    std::optional<Index> hardest() const {
        double most = 0.0;
        std::optional<Index> number;
        for (const double time : loads_) {
            Moment3d loaded;
            loaded.barriers = barriers(time);
            const double load = forces_.load_of(loaded, time);
            if (load <= most || moment(nearest(time)).typical_size <= 0.0) continue;
            most = load;
            number = nearest(time);
        }
        return number;
    }

    Moment3d moment(Index number) const {
        LoadedParticles particles = read_particles(source_.run_dir, number);
        if (named_ && particles.arrays.count("model") == 0)
            particles.arrays["model"].assign(static_cast<std::size_t>(particles.count), 0.0);
        return moment_3d(particles, barriers(time(number)));
    }

    Figure3d figure(Index number, const View3d& view, int digits) const {
        Figure3d figure;
        figure.bed = source_.bed;
        figure.moment = moment(number);
        figure.view = view;
        figure.title = fmt::format("{}: 3D points, t = {:.{}f} s", source_.title, time(number), digits);
        figure.footer = figure.moment.typical_size > 0.0
                            ? fmt::format("points of {:.2g} m; {}", figure.moment.typical_size, source_.footer)
                            : source_.footer;
        if (const BarrierSolid* const barrier = figure.moment.most_loaded())
            figure.struck = struck_text(static_cast<std::size_t>(barrier->number), time(number));
        figure.width = source_.width;
        figure.height = std::max(source_.width * 7 / 10, 300);
        return figure;
    }

    int digits() const { return decimals_of(times_); }

private:
    /// "pressure on a, seen along its load; force 3160 kN, mean over 0.2 s": the force is that of the barrier's table.
    std::string struck_text(std::size_t barrier, double time) const {
        if (barrier >= source_.barriers.size()) return "pressure on the barrier, seen along its load";
        const std::string& name = source_.barriers[barrier].name;
        std::string text = fmt::format("pressure on {}, seen along its load", name);
        const auto over = source_.mean_over.find(name);
        if (over == source_.mean_over.end()) return text;
        const std::optional<double> force = forces_.at(barrier, time);
        if (!force) return text;
        const double kn = 1e-3 * *force;
        return fmt::format("{}; force {} kN, mean over {:.3g} s", text,
                           kn < 10.0 ? fmt::format("{:.2g}", kn) : fmt::format("{:.0f}", kn), over->second);
    }

    /// At that time; before the first loads, and between, the faces that are known without any.
    std::vector<BarrierSolid> barriers(double time) const {
        if (loads_.empty()) return {};
        const auto found = std::find(loads_.begin(), loads_.end(), time);
        const bool known = found != loads_.end();
        std::vector<LoadedPatch> patches = read_barriers(source_.run_dir, known ? found - loads_.begin() : 0);
        if (!known)
            for (LoadedPatch& patch : patches) patch.pressure = 0.0;
        return barrier_solids(patches, source_.barrier_tops, source_.bed, meshes_);
    }

    const FigureSource& source_;
    std::vector<double> times_, loads_;
    BarrierMeshes meshes_;
    ToldForces forces_;
    bool named_ = false;  ///< the last frame says which are points; then frames that do not have particles only
};

bool has_points(const FigureSource& source) {
    return source.in_3d && !source.bed.values.empty() && fs::exists(source.run_dir / "particles.pvd");
}

/// A moment of a run to be drawn, and what it is called.
struct Wanted {
    Index number;
    std::string name, caption;
    bool close = false;  ///< the barrier and what is about it, not all of the flow
};

/// The hardest load from nearby, and all of the flow at the end; where these are one output, all of it midway there.
std::vector<Wanted> wanted_moments(const Run3d& run, const FigureSource& source) {
    std::vector<Wanted> wanted;
    const std::optional<Index> hardest = run.hardest();
    if (hardest)
        wanted.push_back({*hardest, "impact",
                          fmt::format("at {:.4g} s, the output with the largest load on a barrier", run.time(*hardest)),
                          true});
    const Index last = run.last(), middle = last == hardest ? run.midway(last) : last;
    const std::string when =
        middle != last            ? fmt::format("at {:.4g} s, midway through the outputs with points", run.time(middle))
        : last + 1 == run.count() ? "at the end"
                                  : fmt::format("at {:.4g} s, the last output with points", run.time(last));
    wanted.push_back({middle, "points", when, false});
    if (source.time) {
        const Index number = run.nearest(*source.time);
        const std::string moment = fmt::format("{:.6g}", run.time(number));
        wanted.push_back({number, "points_t" + moment + "s", "at " + moment + " s", false});
    }
    return wanted;
}

/// Where points are, but for the highest per cent: single drops.
void add_some(const Moment3d& moment, std::vector<Vec3>& places) {
    constexpr std::size_t kMost = 500;
    std::vector<Vec3> all;
    for (const auto& piece : moment.material)
        if (!piece.is_particle) all.push_back(piece.place);
    std::sort(all.begin(), all.end(), [](const Vec3& a, const Vec3& b) { return a.z() < b.z(); });
    const std::size_t count = all.size() - all.size() / 100, step = count / kMost + 1;
    for (std::size_t k = 0; k < count; k += step) places.push_back(all[k]);
}

}  // namespace

const Table* ToldForces::table_of(std::size_t barrier) const {
    if (barrier >= names_.size()) return nullptr;
    const auto [entry, is_new] = tables_.try_emplace(barrier);
    std::optional<Table>& table = entry->second;
    if (is_new) try {
            table = read_table(run_dir_ / "barriers" / (names_[barrier] + ".csv"));
            if (!table->has("mean_force")) table.reset();
        } catch (const UserError&) {  // more barriers than have tables
            table.reset();
        }
    return table ? &*table : nullptr;
}

std::optional<double> ToldForces::at(std::size_t barrier, double time) const {
    const Table* const table = table_of(barrier);
    if (!table) return {};
    const std::vector<double>& t = table->column("t");
    const double near = 1e-9 * std::max(1.0, time);  // texts of a time differ in their last digits
    const auto row = std::lower_bound(t.begin(), t.end(), time - near);
    if (row == t.end()) return {};
    const auto after = static_cast<std::size_t>(row - t.begin()), before = after > 0 ? after - 1 : after;
    const std::vector<double>& forces = table->column("mean_force");
    double force = forces[after];
    if (*row > time + near) {  // an output is between two steps
        if (before == after) return {};
        force = forces[before] + (forces[after] - forces[before]) * (time - t[before]) / (t[after] - t[before]);
    }
    return std::isfinite(force) ? std::optional<double>(force) : std::nullopt;
}

double ToldForces::load_of(const Moment3d& moment, double time) const {
    const BarrierSolid* const barrier = moment.most_loaded();
    if (!barrier) return 0.0;
    const auto number = static_cast<std::size_t>(barrier->number);
    return table_of(number) ? at(number, time).value_or(0.0) : barrier->load.head<2>().norm();
}

void add_3d(const FigureSource& source, Gallery& gallery) {
    if (!has_points(source)) return;
    try {
        const Run3d run(source);
        if (run.count() == 0) return;
        const std::vector<Wanted> wanted = wanted_moments(run, source);
        Shared3d shared;
        for (const Wanted& one : wanted) shared.add(run.moment(one.number));
        if (shared.empty()) return;  // it ended before there were any
        for (const Wanted& one : wanted) {
            Figure3d figure = run.figure(one.number, shared.view(), run.digits());
            if (one.close) figure.view = close_view(figure.view, figure.moment);
            if (figure.moment.typical_size <= 0.0) {
                if (one.name != "points")
                    gallery.warn(fmt::format("figures/view_{}.png was not drawn: there are no 3D points {}", one.name,
                                             one.caption));
                continue;
            }
            const auto seen = std::make_shared<const Figure3d>(figure);
            gallery.add_rendered(
                {"figures/view_" + one.name + ".png", "3D points " + one.caption},
                [seen](const fs::path& png, std::string& why_not) { return render_3d(*seen, png, why_not); });
            figure.title += ", section along the flow";
            const auto cut = std::make_shared<const Figure3d>(std::move(figure));
            gallery.add(
                {"figures/section_" + one.name + ".png", "section along the flow " + one.caption},
                [cut](const fs::path& png, std::string& why_not) { return render_section(*cut, png, why_not); });
        }
    } catch (const UserError& error) {
        gallery.warn(fmt::format("figures/view_points.png was not drawn: {}", error.what()));
    }
}

void add_film_3d(const FigureSource& source, const std::string& kind, Gallery& gallery) {
    if (!has_points(source)) return;
    gallery.add_rendered({"figures/film_points." + kind, "3D points through time"}, [&source](const fs::path& film,
                                                                                              std::string& why_not) {
        why_not = no_film_reason();
        if (!why_not.empty()) return false;
        const Run3d run(source);
        Shared3d shared;  // every output is read twice, so that they need not fit the memory together
        std::vector<Index> shown;
        std::vector<Vec3> room;
        for (Index number = 0; number < run.count(); ++number) {
            const Moment3d moment = run.moment(number);
            if (moment.typical_size <= 0.0) continue;
            shared.add(moment);
            shown.push_back(number);
            add_some(moment, room);
        }
        if (shown.empty()) return why_not = "no output has 3D points", false;
        const ViewAngles3d look =
            best_view(run.figure(run.hardest().value_or(shown.back()), shared.view(), run.digits()));
        return make_film(film, static_cast<Index>(shown.size()), why_not, [&](Index k, const fs::path& png) {
            const Index number = shown[static_cast<std::size_t>(k)];
            Figure3d figure = run.figure(number, shared.view(), run.digits());
            figure.look = look;  // one for all, and one scale
            figure.room = room;
            return render_3d(figure, png, why_not);
        });
    });
}

}  // namespace frana
