#include "shallow/node_laws.h"

#include <algorithm>

#include "law/bed/node_friction.h"
#include "mpm/on_storage.h"

namespace frana {
namespace {

/// Where zones meet, and on rasters, four nodes have different laws.
template <class Law>
Double4 each_by_its_own(const std::vector<Law>& laws, const std::array<std::uint32_t, 4>& place,
                        const BedStateOf<Double4>& bed, const Double4& s0, const Double4& driven, double dt) {
    if constexpr (frana::laws::kSideBySide<Law>) {
        const auto here = frana::laws::side_by_side(laws[place[0]], laws[place[1]], laws[place[2]], laws[place[3]]);
        return here.speed_after(bed, s0, driven, dt);
    } else {
        Double4 speed = {};
        for (int n = 0; n < 4; ++n) {
            const BedState one{bed.normal_gravity[n], bed.thickness[n], bed.kappa[n],
                               bed.cosine[n],         bed.gravity,      bed.density};
            speed[n] = laws[place[static_cast<std::size_t>(n)]].speed_after(one, s0[n], driven[n], dt);
        }
        return speed;
    }
}

}  // namespace

NodeLaws::NodeLaws(const bed::LawMap& all, const TileGrid& grid) : laws(all.laws), place(on_storage(all.place, grid)) {
    std::visit(
        [this](const auto& table) {
            for (const auto& law : table) at_rest.push_back(law.friction_at_rest());
        },
        laws);
}

void LawsHere<Double4>::brake(const BedStateOf<Double4>& bed, const Double4& s0, const Double4& driven, double dt,
                              Double4& speed) const {
    const bool same = place[0] == place[1] && place[0] == place[2] && place[0] == place[3];
    std::visit(
        [&](const auto& laws) {
            speed = same ? speeds_after(laws[place[0]], bed, s0, driven, dt)
                         : each_by_its_own(laws, place, bed, s0, driven, dt);
        },
        all->laws);
}

double speeds_after(const LawsHere<double>& here, const BedState& bed, double s0, double driven, double dt) {
    return std::visit([&](const auto& laws) { return double{laws[here.place].speed_after(bed, s0, driven, dt)}; },
                      here.all->laws);
}

void AnyLaw::brake(const BedStateOf<Double4>& bed, const Double4& s0, const Double4& driven, double dt,
                   Double4& speed) const {
    std::visit([&](const auto& one) { speed = speeds_after(one, bed, s0, driven, dt); }, law);
}

double speeds_after(const AnyLaw& law, const BedState& bed, double s0, double driven, double dt) {
    return std::visit([&](const auto& one) { return double{one.speed_after(bed, s0, driven, dt)}; }, law.law);
}

}  // namespace frana
