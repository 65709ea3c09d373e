// The state of a body of points between two steps, as it is kept and taken up again: the points in their
// order with the tiles they are sorted by, and the sums of the run. Nodes start empty in every step.
#include "base/error.h"
#include "solid/solid_flow.h"

namespace frana {
namespace {

UserError misfit(const char* what) {
    return UserError(std::string("the kept state does not fit this case: ") + what +
                     "; run without --resume");
}

void keep_points(Archive& archive, MaterialPoints& points) {
    const Archive::Part part(archive, "points");
    int n = 0;
    points.each([&](Column& column) { archive.array("column_" + std::to_string(n++), column); });
    archive.array("id", points.id);
    points.each([&](Column& column) {
        if (column.size() != points.id.size()) throw misfit("its columns of points differ in length");
    });
}

void keep_status(Archive& archive, SolidStatus& s) {
    const Archive::Part part(archive, "status");
    archive.number("step", s.step);
    archive.number("points", s.points);
    std::vector<double*> numbers = {&s.time,    &s.dt,        &s.mass,   &s.mass_left, &s.energy_left,
                                    &s.kinetic, &s.potential, &s.speeds, &s.volume,    &s.max_speed,
                                    &s.stored,  &s.friction,  &s.pushed, &s.material,  &s.energy_given};
    for (Vec3* v : {&s.momentum, &s.momentum_left, &s.momentum_given, &s.weight_impulse, &s.centre})
        for (int k = 0; k < 3; ++k) numbers.push_back(&(*v)[k]);
    archive.numbers("sums", numbers);
}

}  // namespace

void SolidFlow::keep(Archive& archive) {
    keep_points(archive, body_.points);
    keep_status(archive, status_);
    std::vector<double*> impulses;
    for (Vec3& impulse : body_.impulse)
        for (int k = 0; k < 3; ++k) impulses.push_back(&impulse[k]);
    if (!impulses.empty()) archive.numbers("impulses", impulses);
    body_.ledger.keep(archive);
    archive.numbers("drift", {&drift_});
    archive.number("next_id", next_id_);
    archive.array("tile", body_.active.tile);
    archive.array("begin", body_.active.begin);
    timed_.keep(archive);
    if (!archive.loading()) return;
    const ActiveTiles& active = body_.active;
    bool sound = active.begin.size() == active.tile.size() + 1 && active.begin.front() == 0 &&
                 active.begin.back() == body_.points.count();
    for (std::size_t n = 0; sound && n < active.tile.size(); ++n)
        sound = active.tile[n] >= 0 && active.tile[n] < body_.grid.tiles() &&
                active.begin[n] <= active.begin[n + 1] && (n == 0 || active.tile[n - 1] < active.tile[n]);
    if (!sound) throw misfit("its tiles are not those of the points");
    sorter_.list_tiles(body_.grid, body_.active);
    body_.gone.assign(static_cast<std::size_t>(body_.points.count()), 0);
    mark_near();
}

}  // namespace frana
