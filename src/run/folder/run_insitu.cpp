#include "run/folder/run_insitu.h"

#include <fmt/core.h>

#include "base/error.h"
#include "io/gdal_series.h"
#include "observe/insitu_tables.h"
#include "observe/scalar.h"
#include "run/folder/insitu_figures.h"
#include "vtk_io/catalyst.h"
#include "vtk_io/insitu.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

/// Two works at once. The second one has its turn even after a failure of the first.
class Both final : public InsituWork {
public:
    Both(std::unique_ptr<InsituWork> one, std::unique_ptr<InsituWork> other)
        : one_(std::move(one)), other_(std::move(other)) {}

    void sample(const Frame& frame, Index number) override {
        std::exception_ptr failure;
        try {
            one_->sample(frame, number);
        } catch (const std::exception&) {
            failure = std::current_exception();
        }
        other_->sample(frame, number);
        if (failure) std::rethrow_exception(failure);
    }
    void serialize(Archive& archive) override {
        for (InsituWork* work : {one_.get(), other_.get()}) {
            const Archive::Part part(archive, work == one_.get() ? "one" : "other");
            work->serialize(archive);
        }
    }

private:
    std::unique_ptr<InsituWork> one_, other_;
};

/// Shapes for a GIS; `add` puts those of a frame into the series.
template <class Add>
class Shapes final : public InsituWork {
public:
    Shapes(ShapeSeries series, Add add) : series_(std::move(series)), add_(std::move(add)) {}
    void sample(const Frame& frame, Index) override { add_(series_, frame); }
    void serialize(Archive& archive) override { series_.serialize(archive); }

private:
    ShapeSeries series_;
    Add add_;
};

std::unique_ptr<InsituWork> cut(const Scene& scene, const Insitu& entry, const fs::path& folder) {
    auto table = make_cut_table(folder / (entry.name + ".csv"), entry.line, entry.fields);
    if (!entry.picture) return table;
    return std::make_unique<Both>(std::move(table), make_cut_figure(scene, entry, folder));
}

/// `work`, and with gis = true the shapes for a GIS besides.
template <class Add>
std::unique_ptr<InsituWork> with_shapes(std::unique_ptr<InsituWork> work, const Scene& scene, const Insitu& entry,
                                        const fs::path& folder, Add add) {
    if (!entry.gis) return work;
    ShapeSeries series(folder / (entry.name + ".gpkg"), scene.bed.crs_wkt);
    return std::make_unique<Both>(std::move(work), std::make_unique<Shapes<Add>>(std::move(series), std::move(add)));
}

std::unique_ptr<InsituWork> contour(const Scene& scene, const Insitu& entry, const fs::path& folder) {
    auto add = [&entry](ShapeSeries& shapes, const Frame& frame) {
        shapes.add_lines(frame.status.time, level_lines_of(frame, entry.fields.front(), entry.levels),
                         scalar(frame.nodes, entry.fields.front(), "the grid").unit);
    };
    return with_shapes(make_contours(folder, entry.name, entry.fields.front(), entry.levels), scene, entry, folder,
                       add);
}

std::unique_ptr<InsituWork> threshold(const Scene& scene, const Insitu& entry, const fs::path& folder) {
    Interval kept;
    kept.low = entry.from.value_or(kept.low);
    kept.high = entry.to.value_or(kept.high);
    auto add = [&entry, kept](ShapeSeries& shapes, const Frame& frame) {
        std::vector<std::uint8_t> cells = cells_within(frame, entry.fields.front(), kept);
        shapes.add_cells(frame.status.time, frame.grid, cells);
    };
    const auto make = entry.of_particles ? make_particle_threshold : make_cell_threshold;
    return with_shapes(make(folder, entry.name, entry.fields.front(), kept), scene, entry, folder, add);
}

std::unique_ptr<InsituWork> make_work(const Scene& scene, const Insitu& entry, const fs::path& folder) {
    switch (entry.kind) {
        case Insitu::Kind::profile:
            return cut(scene, entry, folder);
        case Insitu::Kind::contour:
            return contour(scene, entry, folder);
        case Insitu::Kind::threshold:
            return threshold(scene, entry, folder);
        case Insitu::Kind::figure:
            return make_figure(scene, entry, folder);
        case Insitu::Kind::reduce:
            return make_reduction(folder / (entry.name + ".csv"), entry.fields,
                                  entry.above.value_or(scene.output.footprint_depth));
        case Insitu::Kind::catalyst:
            return make_catalyst(entry.script);
    }
    throw InternalError("internal error: a kind of [[insitu]] without a work");
}

}  // namespace

void check_insitu(const Scene& scene) {
    for (const Insitu& entry : scene.insitu)
        if (entry.kind == Insitu::Kind::catalyst) check_catalyst(entry.script, entry.place);
}

Observers make_insitu(const Scene& scene, const fs::path& run_dir, std::vector<InsituTally>& tallies) {
    tallies.clear();
    for (const Insitu& entry : scene.insitu) tallies.push_back({entry.name, kind_word(entry.kind), 0, 0, ""});
    Observers observers;
    for (std::size_t i = 0; i < scene.insitu.size(); ++i) {
        const Insitu& entry = scene.insitu[i];
        observers.push_back(std::make_unique<InsituObserver>(InsituTimes{entry.every, entry.every_steps},
                                                             make_work(scene, entry, run_dir / "insitu"), tallies[i]));
    }
    return observers;
}

std::vector<std::string> insitu_warnings(const std::vector<InsituTally>& tallies) {
    std::vector<std::string> warnings;
    for (const InsituTally& tally : tallies)
        if (tally.failed > 0)
            warnings.push_back(fmt::format("insitu {}: {} of {} failed, the first one at {}", tally.name, tally.failed,
                                           tally.made + tally.failed, tally.first_failure));
    return warnings;
}

}  // namespace frana
