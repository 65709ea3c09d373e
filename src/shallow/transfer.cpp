#include "shallow/transfer.h"

#include <algorithm>
#include <cstring>

#include "base/simd.h"
#include "law/rheology/laws.h"
#include "mpm/domain.h"
#include "mpm/stencil.h"
#include "shallow/sheet.h"
#include "shallow/sides.h"
#include "shallow/sub_points.h"
#include "shallow/two_cell_wave.h"

namespace frana {

namespace {

/// -V sigma grad N, the weak form of div(h sigma) (Fois et al. 2024, eq. 21).
template <class S>
void deposit_stress(Flow& flow, const S& sx, const S& sy, double volume, const Plane& sigma) {
    const double scale = volume / flow.cell;
    for (int j = 0; j < S::kNodes; ++j) {
        Deposit* row = flow.nodes.deposits() + flow.grid.at(sx.base, sy.base + j);
        for (int i = 0; i < S::kNodes; ++i) {
            const double dx = sx.slope(i) * sy.w[j], dy = sx.w[i] * sy.slope(j);
            row[i].fx -= scale * (sigma.xx * dx + sigma.xy * dy);
            row[i].fy -= scale * (sigma.xy * dx + sigma.yy * dy);
        }
    }
}

/// Pressure and weight on points, as Fois et al. 2024 have them. They are eq. 13, or eq. 33 when a still level is
/// known.
template <class S>
void deposit_paper_pressure(Flow& flow, const S& sx, const S& sy, double mass, double depth) {
    double z = 0.0, zx = 0.0, zy = 0.0;
    for (int j = 0; j < S::kNodes; ++j)
        for (int i = 0; i < S::kNodes; ++i) {
            const double zi = flow.bed.z[flow.grid.at(sx.base + i, sy.base + j)];
            z += sx.w[i] * sy.w[j] * zi;
            zx += sx.slope(i) * sy.w[j] * zi / flow.cell;
            zy += sx.w[i] * sy.slope(j) * zi / flow.cell;
        }
    const double still = flow.scheme.still_level ? *flow.scheme.still_level - z : 0.0;
    const double flux = 0.5 * flow.gravity * mass * (depth * depth - still * still) / (depth * flow.cell);
    const double weight = flow.gravity * mass * (depth - still) / depth;
    for (int j = 0; j < S::kNodes; ++j) {
        Deposit* row = flow.nodes.deposits() + flow.grid.at(sx.base, sy.base + j);
        for (int i = 0; i < S::kNodes; ++i) {
            const double w = sx.w[i] * sy.w[j];
            row[i].fx += flux * sx.slope(i) * sy.w[j] - weight * zx * w;
            row[i].fy += flux * sx.w[i] * sy.slope(j) - weight * zy * w;
        }
    }
}

constexpr bool is_affine(Transfer transfer) { return transfer == Transfer::tpic || transfer == Transfer::apic; }

/// What the points of a tile give to their nodes, whatever their rheology is.
class PointDeposits {
public:
    virtual ~PointDeposits() = default;
    /// Of points `first` to `end` - 1. `cap`: most_viscosity().
    virtual void deposit(Flow& flow, Index first, Index end, double cap, PointSums& sums) const = 0;
};

/// S: shape. kAffine: gradients of velocity travel too. Law: rheology. kPaper: pressure on points.
template <class S, bool kAffine, class Law, bool kPaper>
class DepositsOf final : public PointDeposits {
    static constexpr bool kStress = !std::is_same_v<Law, rheology::None>;

public:
    explicit DepositsOf(const Law& law) : law_(law) {}

    void deposit(Flow& flow, Index first, Index end, double cap, PointSums& sums) const override {
        for (Index p = first; p < end; ++p) deposit_point(flow, p, cap, sums);
    }

private:
    void deposit_point(Flow& flow, Index p, double cap, PointSums& sums) const {
        const Particles& c = flow.particles;
        const S sx(c.x[p]), sy(c.y[p]);
        const double m = c.mass[p], vx = c.vx[p], vy = c.vy[p];
        Deposit* deposits = flow.nodes.deposits();
        Double4 base = {m * vx, m * vy, 0.0, 0.0}, along_x = {}, along_y = {};
        if constexpr (kAffine) {
            const double mc = m * flow.cell;
            const Gradient g =
                spanned({c.cxx[p], c.cxy[p], c.cyx[p], c.cyy[p]}, c.r1x[p], c.r1y[p], c.r2x[p], c.r2y[p]);
            along_x = mc * Double4{g.xx, g.yx, 0.0, 0.0};
            along_y = mc * Double4{g.xy, g.yy, 0.0, 0.0};
            base -= sx.offset * along_x + sy.offset * along_y;
        }
        for (int j = 0; j < S::kNodes; ++j) {
            const Index first = flow.grid.at(sx.base, sy.base + j);
            Deposit* row = deposits + first;
            const Double4 value = base + static_cast<double>(j) * along_y;
            for (int i = 0; i < S::kNodes; ++i) {
                store(row + i, load(row + i) + (sx.w[i] * sy.w[j]) * (value + static_cast<double>(i) * along_x));
                flow.nodes.mass[first + i] += sx.w[i] * sy.w[j] * m;
            }
        }
        if constexpr (kPaper) deposit_particle(flow.grid, flow.nodes.column_mass.data(), sx, sy, m);
        if constexpr (!kPaper) deposit_sub_points<S, double>(flow, p);
        if constexpr (kStress) {
            if (c.depth[p] > flow.dry_depth()) {
                const double volume = m / flow.density;
                const Plane rate{c.cxx[p], c.cyy[p], 0.5 * (c.cxy[p] + c.cyx[p])};
                const double shear = shear_at(flow, c.x[p], c.y[p], vx, vy, c.depth[p]);
                const StrainState<double> state{rate, shear, flow.scheme.strain_rate_floor, cap};
                Plane sigma;
                with_rheology_of(law_, flow.rheologies,
                                 [&](const auto& rheology) { sigma = rheology.stress(c.x[p], c.y[p], state); });
                deposit_stress(flow, sx, sy, volume, sigma);
                sums.stress_power += volume * (sigma.xx * rate.xx + sigma.yy * rate.yy + 2.0 * sigma.xy * rate.xy);
            }
        }
        if constexpr (kPaper) deposit_paper_pressure(flow, sx, sy, m, c.depth[p]);
        sums.mass += m;
        sums.px += m * vx;
        sums.py += m * vy;
        sums.p_abs += m * std::hypot(vx, vy);
    }

    Law law_;
};

/// kTransfer: how velocity travels. kPaper: pressure on points, depth carried by them. No part of it depends on the
/// rheology, of which there are many.
template <class S, Transfer kTransfer, bool kPaper>
class Kernel final : public TransferKernel {
    static constexpr bool kAffine = is_affine(kTransfer);
    /// Nodes that a point and its sub-points touch, from the first of a quadratic stencil there.
    static constexpr int kBefore = std::is_same_v<S, Cubic> ? 2 : 1, kAfter = std::is_same_v<S, Cubic> ? 4 : 3;

public:
    explicit Kernel(std::unique_ptr<PointDeposits> deposits) : deposits_(std::move(deposits)) {}

    PointSums deposit(Flow& flow, double velocity_dt) override {
        make_room(flow);
        start_deposit(flow, kBefore, kAfter);
        const double cap = most_viscosity(flow, velocity_dt);
        for_each_tile_in_turn(flow.active, [&](Index n) {
            if (!flow.rest.deposits[n]) return;
            const Index tile = flow.active.tile[n], first = flow.active.begin[n], end = flow.active.begin[n + 1];
            PointSums sums;
            StencilMarks marks = flow.marks_of(tile);
            deposits_->deposit(flow, first, end, cap, sums);
            for (Index p = first; p < end; ++p)
                marks.mark(static_cast<std::int32_t>(std::floor(flow.particles.x[p] + (kTile - 0.5))),
                           static_cast<std::int32_t>(std::floor(flow.particles.y[p] + (kTile - 0.5))));
            flow.reach[tile] = marks.reach(kBefore, kAfter);
            deposited_[tile] = sums;
        });
        finish_deposit(flow);
        return total(flow.active, deposited_);
    }

    PointSums gather(Flow& flow, double dt) override {
        make_room(flow);
        assign_sparingly(gone_, static_cast<std::size_t>(flow.particles.count()), std::uint8_t{0});
        choose_gathers(flow);
        for_each_tile(flow.active, [&](Index n) {
            if (!flow.rest.gathers[n]) return;
            PointSums sums;
            for (Index p = flow.active.begin[n]; p < flow.active.begin[n + 1]; ++p) gather_point(flow, p, dt, sums);
            gathered_[flow.active.tile[n]] = sums;
            note_rest(flow, n, sums.max_motion == 0.0);
        });
        note_changed(flow);
        return total(flow.active, gathered_);
    }

    PointSums carry(Flow& flow, double dt, double velocity_dt) override { return carry_apart(flow, dt, velocity_dt); }

    void probe(Flow& flow, Probe& out) override {
        const std::size_t count = static_cast<std::size_t>(flow.particles.count());
        for (auto* array : {&out.vx, &out.vy, &out.cxx, &out.cxy, &out.cyx, &out.cyy, &out.depth}) array->resize(count);
        for_each_tile(flow.active, [&](Index n) {
            for (Index p = flow.active.begin[n]; p < flow.active.begin[n + 1]; ++p) {
                const Gathered g = gathered(flow, p);
                const auto [vx, vy] = velocity_of(flow, p, g);
                out.vx[p] = vx;
                out.vy[p] = vy;
                out.cxx[p] = g.cxx;
                out.cxy[p] = g.cxy;
                out.cyx[p] = g.cyx;
                out.cyy[p] = g.cyy;
                out.depth[p] = kPaper ? flow.particles.depth[p] : g.depth;
            }
        });
    }

private:
    struct Gathered {
        double vx, vy, cxx, cxy, cyx, cyy, depth, wave_x, wave_y, velocity_share, old_x, old_y;
    };

    /// APIC: C = D^-1 sum N v (x) d, D = cell^2/4 (quadratic) or cell^2/3 (cubic; Jiang et al. 2015). TPIC: C = sum v
    /// (x) grad N.
    static constexpr double gradient_scale() {
        constexpr double inertia = std::is_same_v<S, Cubic> ? 3.0 : 4.0;
        return kTransfer == Transfer::apic ? inertia : 1.0;
    }

    /// What an affine point retains of its own motion beyond the nodes'. It is of what it brought each node more than
    /// that had, as far as friction there left it. In sum over the points of a node that is nothing.
    Gathered own(const Flow& flow, Index p) const {
        const Particles& c = flow.particles;
        const S sx(c.x[p]), sy(c.y[p]);
        const Gradient g = spanned({c.cxx[p], c.cxy[p], c.cyx[p], c.cyy[p]}, c.r1x[p], c.r1y[p], c.r2x[p], c.r2y[p]);
        Gathered sum{};
        for (int j = 0; j < S::kNodes; ++j)
            for (int i = 0; i < S::kNodes; ++i) {
                const Index k = flow.grid.at(sx.base + i, sy.base + j);
                const double di = static_cast<double>(i) - sx.offset, dj = static_cast<double>(j) - sy.offset;
                const double share = flow.carried_share * flow.nodes.velocity_share[k];
                const double x = share * (c.vx[p] + flow.cell * (g.xx * di + g.xy * dj) - flow.nodes.before[k].x);
                const double y = share * (c.vy[p] + flow.cell * (g.yx * di + g.yy * dj) - flow.nodes.before[k].y);
                const double w = sx.w[i] * sy.w[j];
                sum.vx += w * x, sum.vy += w * y;
                constexpr bool apic = kTransfer == Transfer::apic;
                const double by_x = apic ? w * di : sx.slope(i) * sy.w[j], by_y = apic ? w * dj : sx.w[i] * sy.slope(j);
                sum.cxx += by_x * x, sum.cxy += by_y * x;
                sum.cyx += by_x * y, sum.cyy += by_y * y;
            }
        const double scale = gradient_scale() / flow.cell;
        for (double* c_kl : {&sum.cxx, &sum.cxy, &sum.cyx, &sum.cyy}) *c_kl *= scale;
        return sum;
    }

    Gathered gathered(const Flow& flow, Index p) const {
        const Particles& c = flow.particles;
        const S sx(c.x[p]), sy(c.y[p]);
        const Motion* motions = flow.nodes.motions();
        Double4 value = {}, by_x = {}, by_y = {};
        double velocity_share = 0.0, old_x = 0.0, old_y = 0.0;
        for (int j = 0; j < S::kNodes; ++j) {
            const Index k = flow.grid.at(sx.base, sy.base + j);
            Double4 row = {}, row_x = {};
            for (int i = 0; i < S::kNodes; ++i) {
                const Double4 node = load(motions + k + i);
                row += sx.w[i] * node;
                if constexpr (kTransfer == Transfer::apic)
                    row_x += (sx.w[i] * (static_cast<double>(i) - sx.offset)) * node;
                else
                    row_x += sx.slope(i) * node;
                if constexpr (kTransfer == Transfer::flip) {
                    const double share = sx.w[i] * sy.w[j] * flow.nodes.velocity_share[k + i];
                    velocity_share += share;
                    old_x += share * flow.nodes.before[k + i].x;
                    old_y += share * flow.nodes.before[k + i].y;
                }
            }
            value += sy.w[j] * row;
            by_x += sy.w[j] * row_x;
            if constexpr (kTransfer == Transfer::apic)
                by_y += (sy.w[j] * (static_cast<double>(j) - sy.offset)) * row;
            else
                by_y += sy.slope(j) * row;
        }
        const double scale = gradient_scale() / flow.cell;
        return {value[0],
                value[1],
                scale * by_x[0],
                scale * by_y[0],
                scale * by_x[1],
                scale * by_y[1],
                value[2],
                gradient_scale() * by_x[3],
                gradient_scale() * by_y[3],
                velocity_share,
                old_x,
                old_y};
    }

    /// FLIP: forces add to a point's velocity what they added to the nodes'. Friction leaves of it the share that it
    /// left of the nodes'. (Suppose friction's change were added too. A light point that meets a heavy stream would be
    /// driven up to twice as fast the other way.) The points' momentum is that of the nodes: sum m_p N_i kept_i (v_p +
    /// change_i).
    std::pair<double, double> velocity_of(const Flow& flow, Index p, const Gathered& g) const {
        if constexpr (kTransfer == Transfer::flip) {
            const double flip_share = 1.0 - (1.0 - flow.scheme.flip_ratio) * (1.0 - flow.carried_share);
            return {
                flip_share * (g.velocity_share * flow.particles.vx[p] + g.vx - g.old_x) + (1.0 - flip_share) * g.vx,
                flip_share * (g.velocity_share * flow.particles.vy[p] + g.vy - g.old_y) + (1.0 - flip_share) * g.vy};
        } else {
            return {g.vx, g.vy};
        }
    }

    void gather_point(Flow& flow, Index p, double dt, PointSums& sums) {
        Particles& c = flow.particles;
        const Gathered g = gathered(flow, p);
        auto [vx, vy] = velocity_of(flow, p, g);
        Gathered more{};
        if constexpr (kAffine)
            if (flow.carried_share > 0.0) {
                more = own(flow, p);
                vx += more.vx, vy += more.vy;
            }
        double shift_x = dt * g.vx / flow.cell, shift_y = dt * g.vy / flow.cell;
        off_waves(flow.scheme.wave_shift, g.wave_x, g.wave_y, std::hypot(shift_x, shift_y), shift_x, shift_y);
        const double shift = std::max(std::abs(shift_x), std::abs(shift_y));
        if (!(shift <= 4.0)) {  // also catches what is not finite
            if (sums.bad < 0) sums.bad = p;
            return;
        }
        c.vx[p] = vx;
        c.vy[p] = vy;
        c.cxx[p] = g.cxx + more.cxx;
        c.cxy[p] = g.cxy + more.cxy;
        c.cyx[p] = g.cyx + more.cyx;
        c.cyy[p] = g.cyy + more.cyy;
        c.x[p] += shift_x;
        c.y[p] += shift_y;
        if constexpr (kPaper) {
            c.depth[p] /= 1.0 + dt * (g.cxx + g.cyy);  // Fois et al. 2024, eq. 30
        } else {
            c.depth[p] = g.depth;
            stretch(c.r1x[p], c.r1y[p], g, dt);
            stretch(c.r2x[p], c.r2y[p], g, dt);
        }
        const double set_back = meet_side<double>(flow, p, shift_x, shift_y, gone_, sums);
        const double speed = std::hypot(vx, vy), m = c.mass[p];
        sums.max_shift = std::max(sums.max_shift, shift + set_back);
        for (const double part :
             {vx, vy, g.vx, g.vy, c.cxx[p], c.cxy[p], c.cyx[p], c.cyy[p], g.cxx, g.cxy, g.cyx, g.cyy})
            sums.max_motion = std::max(sums.max_motion, std::abs(part));
        sums.max_speed = std::max(sums.max_speed, speed);
        sums.max_signal = std::max(sums.max_signal, speed + std::sqrt(flow.gravity * std::max(c.depth[p], 0.0)));
        if (gone_[p]) return;
        sums.mass += m;
        sums.px += m * c.vx[p];
        sums.py += m * c.vy[p];
        sums.p_abs += m * speed;
    }

    static void stretch(double& rx, double& ry, const Gathered& g, double dt) {
        const double x = rx, y = ry;
        rx += dt * (g.cxx * x + g.cxy * y);
        ry += dt * (g.cyx * x + g.cyy * y);
    }

    std::unique_ptr<PointDeposits> deposits_;
};

template <class S, bool kAffine, bool kPaper>
std::unique_ptr<PointDeposits> with_rheology(const Scene& scene) {
    const auto deposits = [](const auto& law) -> std::unique_ptr<PointDeposits> {
        return std::make_unique<DepositsOf<S, kAffine, std::decay_t<decltype(law)>, kPaper>>(law);
    };
    return scene.rheologies() ? deposits(RheologyOfEachNode{}) : std::visit(deposits, scene.rheology);
}

template <class S, Transfer kTransfer>
std::unique_ptr<TransferKernel> with_pressure(const Scene& scene) {
    constexpr bool kAffine = is_affine(kTransfer);
    if constexpr (std::is_same_v<S, Cubic>)
        expect(!scene.scheme.paper_pressure, "cubic shapes with pressure on points");
    else if (scene.scheme.paper_pressure)
        return std::make_unique<Kernel<S, kTransfer, true>>(with_rheology<S, kAffine, true>(scene));
    return std::make_unique<Kernel<S, kTransfer, false>>(with_rheology<S, kAffine, false>(scene));
}

template <class S>
std::unique_ptr<TransferKernel> with_transfer(const Scene& scene) {
    switch (scene.scheme.transfer) {
        case Transfer::tpic:
            return with_pressure<S, Transfer::tpic>(scene);
        case Transfer::apic:
            return with_pressure<S, Transfer::apic>(scene);
        case Transfer::flip:
            return with_pressure<S, Transfer::flip>(scene);
        case Transfer::pic:
            return with_pressure<S, Transfer::pic>(scene);
    }
    throw InternalError("unknown transfer");
}

}  // namespace

std::unique_ptr<TransferKernel> make_plain_transfer(const Scene& scene) {
    switch (scene.scheme.shape) {
        case Shape::linear:
            return with_transfer<Linear>(scene);
        case Shape::quadratic:
            return with_transfer<Quadratic>(scene);
        case Shape::cubic:
            return with_transfer<Cubic>(scene);
    }
    throw InternalError("unknown shape");
}

std::unique_ptr<TransferKernel> make_transfer(const Scene& scene) {
    auto packed = make_packed_transfer(scene);
    expect(packed || scene.scheme.precision == Precision::full,
           "single precision with another scheme than the default");
    return packed ? std::move(packed) : make_plain_transfer(scene);
}

}  // namespace frana
