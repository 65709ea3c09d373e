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
    if (start == Start::placed) watch_.sample_columns(columns(), density_);
}

void WalledColumns::advance(double until) {
    const double before = inner().status().time;
    inner().advance(until);
    if (watch_.is_due(columns(), before, until))
        timed_("barriers", [&] { watch_.sample_columns(columns(), density_); });
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
    const Archive::Part part(archive, "walled_clock");
    timed_.serialize(archive);
}

}  // namespace frana
