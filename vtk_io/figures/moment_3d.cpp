#include "vtk_io/figures/moment_3d.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "vtk_io/figures/chart_figure_ticks.h"
#include "vtk_io/figures/map_range.h"

namespace frana {
namespace {

/// The value that a share of all lies below; the list is put out of order.
double percentile(std::vector<double>& values, double share) {
    if (values.empty()) return 0.0;
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

std::array<double, 4> around(const BarrierSolid& barrier) {
    std::array<double, 4> box{1e300, 1e300, -1e300, -1e300};
    for (const Polyline& ring : barrier.rings)
        for (const Vec2& p : ring) box = united(box, {p.x(), p.y(), p.x(), p.y()});
    if (!barrier.mesh) return box;
    for (const auto& piece : barrier.pieces)
        for (const Vec3& p : piece.corners) box = united(box, {p.x(), p.y(), p.x(), p.y()});
    return box;
}

std::array<double, 4> without_outermost(const std::vector<Moment3d::Piece>& material) {
    constexpr double kLeftOut = 0.01;
    std::array<double, 4> box{};
    for (int axis = 0; axis < 2; ++axis) {
        std::vector<double> places;
        for (const auto& piece : material)
            if (!piece.is_particle) places.push_back(piece.place[axis]);
        const auto a = static_cast<std::size_t>(axis);
        box[a] = percentile(places, kLeftOut);
        box[a + 2] = percentile(places, 1.0 - kLeftOut);
    }
    return box;
}

}  // namespace

const BarrierSolid* Moment3d::most_loaded() const {
    const BarrierSolid* most = nullptr;
    for (const BarrierSolid& barrier : barriers) {
        const double load = barrier.load.head<2>().norm();
        if (load > (most ? most->load.head<2>().norm() : 0.0)) most = &barrier;
    }
    return most;
}

Moment3d moment_3d(const LoadedParticles& particles, std::vector<BarrierSolid> barriers) {
    const auto array = [&](const char* name) -> const double* {
        const auto found = particles.arrays.find(name);
        return found == particles.arrays.end() || found->second.empty() ? nullptr : found->second.data();
    };
    const double *position = array("position"), *volume = array("volume"), *speed = array("speed"),
                 *velocity = array("velocity"), *model = array("model"), *depth = array("depth"),
                 *ground = array("elevation");
    if (particles.count > 0 && (!position || !volume || (!speed && !velocity)))
        throw UserError("the frames hold no volume or no speed of the points; add them to output.fields and run again");
    Moment3d moment;
    moment.time = particles.time;
    moment.barriers = std::move(barriers);
    std::vector<double> sizes;
    double all = 0.0;
    for (Index k = 0; k < particles.count; ++k) {
        Moment3d::Piece piece;
        piece.place = Vec3(position[3 * k], position[3 * k + 1], position[3 * k + 2]);
        const Vec3 v = velocity ? Vec3(velocity[3 * k], velocity[3 * k + 1], velocity[3 * k + 2]) : Vec3(0, 0, 0);
        piece.speed = speed ? speed[k] : v.norm();
        piece.ground = ground ? ground[k] : piece.place.z();
        piece.is_particle = model && model[k] == 0.0;
        const bool flat = piece.is_particle && depth && depth[k] > 0.0;
        piece.size = flat ? std::sqrt(volume[k] / depth[k]) : std::cbrt(volume[k]);
        moment.material.push_back(piece);
        if (piece.is_particle) continue;
        sizes.push_back(piece.size);
        moment.momentum += volume[k] * v;
        moment.middle += volume[k] * piece.place;
        all += volume[k];
    }
    if (all > 0.0) moment.middle /= all;
    moment.typical_size = percentile(sizes, 0.5);
    return moment;
}

void Shared3d::add(const Moment3d& moment) {
    const auto hold = [&](const Box& box) { seen_ = seen_ ? united(*seen_, box) : box; };
    std::vector<double> speeds;
    for (const auto& piece : moment.material)
        if (!piece.is_particle) speeds.push_back(piece.speed);
    if (!speeds.empty()) {
        hold(without_outermost(moment.material));
        fastest_ = std::max(fastest_, percentile(speeds, 0.995));
    }
    for (const BarrierSolid& barrier : moment.barriers) {
        if (barrier.rings.empty() && !barrier.mesh) continue;
        hold(around(barrier));
        for (const auto& piece : barrier.pieces) pressure_ = std::max(pressure_, piece.pressure);
    }
    if (const BarrierSolid* barrier = moment.most_loaded(); barrier && barrier->load.head<2>().norm() > load_) {
        load_ = barrier->load.head<2>().norm();
        force_ = barrier->load.head<2>().normalized();
        at_load_ = barrier->middle_of_load.head<2>();
        struck_ = around(*barrier);
        const Box& box = *struck_;
        reach_ = 3.0 * std::max({box[2] - box[0], box[3] - box[1], 12.0 * moment.typical_size});
    }
    if (!speeds.empty() && moment.momentum.head<2>().norm() > momentum_) {
        momentum_ = moment.momentum.head<2>().norm();
        if (momentum_ > 0.0) motion_ = moment.momentum.head<2>() / momentum_;
        middle_ = moment.middle.head<2>();
    }
}

View3d Shared3d::view() const {
    expect(seen_.has_value(), "a view shared by no moments");
    View3d view;
    view.box = *seen_;
    if (struck_)
        for (std::size_t k = 0; k < 2; ++k) {
            view.box[k] = std::max(view.box[k], (*struck_)[k] - reach_);
            view.box[k + 2] = std::min(view.box[k + 2], (*struck_)[k + 2] + reach_);
        }
    const double rim = 0.06 * std::max(view.box[2] - view.box[0], view.box[3] - view.box[1]);
    view.box = {view.box[0] - rim, view.box[1] - rim, view.box[2] + rim, view.box[3] + rim};
    view.fastest = fastest_ > 0.0 ? round_limit(fastest_) : 1.0;
    view.pressure = pressure_ > 0.0 ? round_limit(pressure_) : 0.0;
    view.flow = load_ > 0.0 ? force_ : motion_;
    view.through = load_ > 0.0 ? at_load_ : middle_;
    return view;
}

View3d close_view(View3d shared, const Moment3d& moment) {
    constexpr double kHeights = 3.0;
    const BarrierSolid* barrier = moment.most_loaded();
    if (!barrier) return shared;
    double low = INFINITY, high = -INFINITY;
    for (const auto& piece : barrier->pieces)
        for (const Vec3& p : piece.corners) low = std::min(low, p.z()), high = std::max(high, p.z());
    const double reach = kHeights * std::max(0.0, high - low);
    const std::array<double, 4> box = around(*barrier);
    for (std::size_t k = 0; k < 2; ++k) {
        shared.box[k] = std::max(shared.box[k], box[k] - reach);
        shared.box[k + 2] = std::min(shared.box[k + 2], box[k + 2] + reach);
    }
    return shared;
}

}  // namespace frana
