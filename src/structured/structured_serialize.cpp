// The state of structured particles between two steps, as it is serialized. It is the particles in their order with the
// tiles they are sorted by, and the sums of the run. Nodes start empty in every step.
#include "mpm/stored_points.h"
#include "structured/structured_flow.h"

namespace frana {
namespace {

void serialize_status(Archive& archive, StructuredStatus& s) {
    const Archive::Part part(archive, "status");
    archive.number("step", s.step);
    archive.number("points", s.points);
    archive.number("outrun", s.outrun);
    std::vector<double*> numbers = {&s.time,      &s.dt,        &s.mass,        &s.kinetic, &s.damage,
                                    &s.max_speed, &s.potential, &s.bed_kinetic, &s.stored,  &s.flow_steps};
    for (Vec2* v : {&s.momentum, &s.momentum_given})
        for (int k = 0; k < 2; ++k) numbers.push_back(&(*v)[k]);
    archive.numbers("sums", numbers);
}

}  // namespace

void StructuredFlow::serialize(Archive& archive) {
    serialize_points(archive, body_.points);
    serialize_status(archive, status_);
    since_start_.serialize(archive, "ledger");
    static_cast<StructuredLedger&>(status_) = since_start_.total();
    archive.numbers("bounds", {&wave_, &signal_, &drift_, &rules_.least_mass});
    Index grains = body_.grains ? 1 : 0;
    archive.number("grains", grains);
    archive.number("next_id", halves_.next_id);
    serialize_tiles(archive, body_.active);
    timed_.serialize(archive);
    if (!archive.loading()) return;
    if (grains != 0 && !body_.grains) begin_grains();
    body_.grains = grains != 0;  // they may have begun since the state that is taken up again
    require_whole(body_.active, body_.grid.tiles(), body_.points.count());
    take_tiles();
    const StructuredStatus kept = status_;
    sample();
    status_ = kept;
}

}  // namespace frana
