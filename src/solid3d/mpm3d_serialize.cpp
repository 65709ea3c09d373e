// The state of a body of points between two steps, as it is serialized. It is the points in their order with the tiles
// they are sorted by, and the sums of the run. Nodes start empty in every step.
#include "mpm/stored_points.h"
#include "solid3d/mpm3d.h"

namespace frana {
namespace {

void serialize_status(Archive& archive, SolidStatus& s) {
    const Archive::Part part(archive, "status");
    archive.number("step", s.step);
    archive.number("points", s.points);
    std::vector<double*> numbers = {&s.time,   &s.dt,     &s.mass,      &s.kinetic, &s.potential,
                                    &s.speeds, &s.volume, &s.max_speed, &s.stored};
    for (Vec3* v : {&s.momentum, &s.centre})
        for (int k = 0; k < 3; ++k) numbers.push_back(&(*v)[k]);
    archive.numbers("sums", numbers);
}

}  // namespace

void Mpm3d::serialize(Archive& archive) {
    serialize_points(archive, body_.points);
    serialize_status(archive, status_);
    since_start_.serialize(archive, "ledger");
    static_cast<SolidLedger&>(status_) = since_start_.total();
    std::vector<double*> impulses;
    for (Vec3& impulse : body_.impulse)
        for (int k = 0; k < 3; ++k) impulses.push_back(&impulse[k]);
    if (!impulses.empty()) archive.numbers("impulses", impulses);
    body_.ledger.serialize(archive);
    archive.numbers("drift", {&drift_});
    archive.number("next_id", next_id_);
    serialize_tiles(archive, body_.active);
    timed_.serialize(archive);
    if (!archive.loading()) return;
    require_whole(body_.active, body_.grid.tiles(), body_.points.count());
    sorter_.list_tiles(body_.grid, body_.active);
    body_.gone.assign(static_cast<std::size_t>(body_.points.count()), 0);
    mark_near();
}

}  // namespace frana
