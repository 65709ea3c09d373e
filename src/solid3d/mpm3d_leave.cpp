// Points that leave for another model.
#include "solid3d/mpm3d.h"

namespace frana {

DepartedPoint Mpm3d::departed(Index p) const {
    const MaterialPoints& q = body_.points;
    const Vec3 x = position(p), v = velocity(p);
    double state[7];
    for (int n = 0; n < q.states; ++n) state[n] = q.state[n][p];
    const double stored = std::visit([&](const auto& law) { return law.stored(q.j[p], state); }, law_);
    return {status_.time,
            x,
            v,
            gradient(p),
            q.mass[p],
            q.mass[p] * (0.5 * v.squaredNorm() - body_.gravity.dot(x)) + q.rest_volume[p] * stored,
            -stress(p).trace() / 3.0};
}

void Mpm3d::leave() {
    if (notes_) departed_.reserve(departed_.size() + static_cast<std::size_t>(body_.points.count()));
    SolidLedger gone;
    CompensatedSum energy;
    for (Index p = 0; p < body_.points.count(); ++p) {
        const DepartedPoint left = departed(p);
        if (notes_) departed_.push_back(left);
        gone.momentum_left += left.mass * left.velocity;
        energy.add(left.energy);
    }
    gone.mass_left = status_.mass, gone.energy_left = energy.value();
    account(gone);
    body_.points.resize(0);
    body_.points.each([](Array& array) { array.shrink_to_fit(); });
    status_.points = 0;
    status_.mass = status_.kinetic = status_.potential = status_.stored = 0.0;
    status_.speeds = status_.volume = status_.max_speed = 0.0;
    status_.momentum = status_.centre = Vec3::Zero();
    body_.gone.clear();
    sort();
}

}  // namespace frana
