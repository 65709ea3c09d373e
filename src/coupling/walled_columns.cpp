#include "coupling/walled_columns.h"

namespace frana {
namespace {

Scene with_walls(Scene scene) {
    scene.bed = with_barriers(scene);
    return scene;
}

}  // namespace

WalledColumns::WalledColumns(const Scene& scene, Start start) : density_(scene.density), watch_(scene) {
    if (scene.wider)
        growing_ = std::make_unique<GrowingColumns>(scene, start);
    else
        whole_ = std::make_unique<DepthAveraged>(with_walls(scene), start);
    columns().note_parents();
    if (start == Start::placed) sample();
}

/// Looks when a column may have moved by half a cell, and at output times.
void WalledColumns::advance(double until) {
    const double before = inner().status().time;
    inner().advance(until);
    for (const DepthAveraged::Birth& birth : columns().take_births()) watch_.inherit(birth.child, birth.parent);
    const Status& now = inner().status();
    moved_ += now.max_speed_on_map * (now.time - before);  // where something enters, dt begins anew
    if (moved_ < 0.5 * columns().flow().cell && now.time < until) return;
    timed_("barriers", [&] { sample(); });
    moved_ = 0.0;
}

void WalledColumns::sample() {
    const Flow& flow = columns().flow();
    const GridGeometry& g = flow.grid.geometry();
    const Columns& c = flow.columns;
    watch_.begin_round();
    for (Index p = 0; p < c.count(); ++p) {
        const Vec2 place(g.x0 + g.cell * c.x[p], g.y0 + g.cell * c.y[p]);
        if (!watch_.is_near(place)) continue;
        const Sample there = inner().at(place);
        watch_.sample({c.id[p], place, there.elevation + there.depth, c.mass[p] / density_});
    }
}

std::vector<PhaseTime> WalledColumns::timings() const {
    std::vector<PhaseTime> all = inner().timings();
    for (const PhaseTime& phase : timed_.times()) all.push_back(phase);
    return all;
}

void WalledColumns::serialize(Archive& archive) {
    inner().serialize(archive);
    columns().note_parents();  // a larger part is another object
    watch_.serialize(archive);
    archive.numbers("walled", {&moved_});
    const Archive::Part part(archive, "walled_clock");
    timed_.serialize(archive);
}

}  // namespace frana
