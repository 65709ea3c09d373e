// The default scheme's transfers (quadratic B-splines, TPIC), four points at a time. What belongs to a point is
// computed lane by lane. Then each point in turn reaches its nodes, whose numbers are adjacent in memory. Sums are
// those of transfer.cpp up to round-off.
#include <algorithm>

#include "base/simd.h"
#include "base/touch.h"
#include "law/rheology/laws.h"
#include "mpm/domain.h"
#include "mpm/stencils.h"
#include "mpm/tile_points.h"
#include "shallow/scatter_four.h"
#include "shallow/sheet.h"
#include "shallow/sides.h"
#include "shallow/sub_points_of_four.h"
#include "shallow/two_cell_wave.h"

namespace frana {
namespace {

/// PointSums of the lanes, in a fixed order.
struct Sums {
    Double4 mass = {}, px = {}, py = {}, p_abs = {}, speed = {}, signal = {}, shift = {}, motion = {},
            stress_power = {};
    PointSums rare;
    PointSums points() const {
        PointSums s = rare;
        s.mass += sum(mass);
        s.px += sum(px);
        s.py += sum(py);
        s.p_abs += sum(p_abs);
        s.stress_power += sum(stress_power);
        s.max_speed = std::max(s.max_speed, largest(speed));
        s.max_signal = std::max(s.max_signal, largest(signal));
        s.max_shift = std::max(s.max_shift, largest(shift));
        return s;
    }
};

constexpr Index kBatch = 128;  ///< points whose stresses wait on the stack, and that are read ahead

/// What points give to their nodes, whatever their rheology is.
class PointDeposits {
public:
    virtual ~PointDeposits() = default;
    /// Of points `first` to `end` - 1, kBatch at most. `cap`: most_viscosity(). `at_side`: some may be next to the
    /// grid's sides.
    virtual void deposit(Flow& flow, Index first, Index end, double cap, bool at_side, StencilMarks& marks,
                         Sums& sums) const = 0;
};

/// Real: how memory holds what points carry; it is reckoned with in double precision.
template <class Law, class Real>
class DepositsOf final : public PointDeposits {
    static constexpr bool kStress = !std::is_same_v<Law, rheology::None>;

public:
    explicit DepositsOf(const Law& law) : law_(law) {}

    /// Stresses first: a chain of divisions and roots that points wait for side by side.
    [[gnu::noinline]] void deposit(Flow& flow, Index first, Index end, double cap, bool at_side, StencilMarks& marks,
                                   Sums& sums) const override {
        PlaneOf<Double4> internal_force[kBatch / 4];
        if constexpr (kStress) {
            Double4 shear[kBatch / 4];
            for_each_four(first, end, [&](Index p, int lanes) { shear[(p - first) / 4] = shear_of(flow, p, lanes); });
            with_rheology_of(law_, flow.rheologies, [&](const auto& rheology) {
                for_each_four(first, end, [&](Index p, int lanes) {
                    const Index four = (p - first) / 4;
                    internal_force[four] = internal_force_of(rheology, flow, p, lanes, shear[four], cap, sums);
                });
            });
        }
        for_each_four(first, end, [&](Index p, int lanes) {
            deposit_four(flow, p, lanes, internal_force[(p - first) / 4], marks, sums);
        });
        for_each_four(first, end, [&](Index p, int lanes) { deposit_particles(flow, p, lanes, at_side); });
    }

private:
    static void deposit_four(Flow& flow, Index p, int lanes, const PlaneOf<Double4>& internal_force,
                             StencilMarks& marks, Sums& sums) {
        const Particles& c = flow.particles;
        const Carried<Real>& held = c.carried<Real>();
        const Double4 x = load(&c.x[p], lanes), y = load(&c.y[p], lanes), m = load(&c.mass[p], lanes);
        const Double4 vx = load(&held.vx[p], lanes), vy = load(&held.vy[p], lanes);
        const Double4 r1x = load(&held.r1x[p], lanes), r1y = load(&held.r1y[p], lanes);
        const Double4 r2x = load(&held.r2x[p], lanes), r2y = load(&held.r2y[p], lanes);
        Double4 cxx = load(&held.cxx[p], lanes), cxy = load(&held.cxy[p], lanes);
        Double4 cyx = load(&held.cyx[p], lanes), cyy = load(&held.cyy[p], lanes);
        const Stencils sx(x), sy(y);
        limit_gradients({r1x, r1y, r2x, r2y}, cxx, cxy, cyx, cyy);
        const Double4 mc = flow.cell * m, px = m * vx, py = m * vy;
        scatter_four(flow.nodes, flow.grid.stride(), lanes, sx, sy, {m, px, py, mc * cxx, mc * cxy, mc * cyx, mc * cyy},
                     internal_force);
        marks.mark(sx.first, sy.first, lanes);
        sums.mass += m;
        sums.px += px;
        sums.py += py;
        sums.p_abs += m * sqrt(vx * vx + vy * vy);
    }

    /// Those that lie farther from their points than half a cell, or next to the grid's sides, one by one.
    static void deposit_particles(Flow& flow, Index p, int lanes, bool at_side) {
        const Particles& c = flow.particles;
        const Carried<Real>& held = c.carried<Real>();
        const Domains r{load(&held.r1x[p], lanes), load(&held.r1y[p], lanes), load(&held.r2x[p], lanes),
                        load(&held.r2y[p], lanes)};
        if (!at_side && spread_four(flow, flow.nodes.column_mass.data(), lanes, load(&c.x[p], lanes),
                                    load(&c.y[p], lanes), load(&c.mass[p], lanes), r))
            return;
        for (int lane = 0; lane < lanes; ++lane) deposit_quadratic_sub_points<Real>(flow, p + lane);
    }

    /// Of four points [1/s].
    static Double4 shear_of(const Flow& flow, Index p, int lanes) {
        const Particles& c = flow.particles;
        const Carried<Real>& held = c.carried<Real>();
        return shear_of_four(flow, load(&c.x[p], lanes), load(&c.y[p], lanes), lanes, load(&held.vx[p], lanes),
                             load(&held.vy[p], lanes), max(load(&held.depth[p], lanes), all(flow.dry_depth())));
    }

    /// V sigma / cell of four points [N], the explicit stress capped (scheme.stress_cap).
    template <class Points>
    static PlaneOf<Double4> internal_force_of(const Points& rheology, const Flow& flow, Index p, int lanes,
                                              Double4 shear, double cap, Sums& sums) {
        const Particles& c = flow.particles;
        const Carried<Real>& held = c.carried<Real>();
        const Double4 depth = load(&held.depth[p], lanes);
        const Double4 cxy = load(&held.cxy[p], lanes), cyx = load(&held.cyx[p], lanes), zero = {};
        const double per_density = 1.0 / flow.density, per_cell = 1.0 / flow.cell;
        const PlaneOf<Double4> rate{load(&held.cxx[p], lanes), load(&held.cyy[p], lanes), 0.5 * (cxy + cyx)};
        const PlaneOf<Double4> sigma =
            rheology.stress(load(&c.x[p], lanes), load(&c.y[p], lanes),
                            StrainState<Double4>{rate, shear, flow.scheme.strain_rate_floor, cap});
        const Double4 volume = depth > flow.dry_depth() ? per_density * load(&c.mass[p], lanes) : zero;
        sums.stress_power += volume * (sigma.xx * rate.xx + sigma.yy * rate.yy + 2.0 * sigma.xy * rate.xy);
        return scaled(sigma, per_cell * volume);
    }

    Law law_;
};

/// No part of it depends on the rheology.
template <class Real>
class PackedKernel final : public TransferKernel {
public:
    explicit PackedKernel(std::unique_ptr<PointDeposits> deposits) : deposits_(std::move(deposits)) {}

    PointSums deposit(Flow& flow, double velocity_dt) override {
        const double cap = prepare_deposit(flow, velocity_dt);
        for_each_tile_in_turn(flow.active, [&](Index n) {
            if (!flow.rest.deposits[n]) return;
            const Index tile = flow.active.tile[n];
            touch_deposits(flow, n);
            Sums sums;
            StencilMarks marks = flow.marks_of(tile);
            for_each_batch(flow, n, [&](Index first, Index end, bool at_side) {
                deposits_->deposit(flow, first, end, cap, at_side, marks, sums);
            });
            flow.reach[tile] = marks.reach(kReachBefore, kReachAfter);
            deposited_[tile] = sums.points();
        });
        finish_deposit(flow);
        return total(flow.active, deposited_);
    }

    PointSums gather(Flow& flow, double dt) override {
        prepare_gather(flow);
        choose_gathers(flow);
        for_each_tile(flow.active, [&](Index n) {
            if (!flow.rest.gathers[n]) return;
            Sums sums;
            touch_motions(flow, n);
            for_each_batch(flow, n, [&](Index first, Index end, bool) { gather_batch(flow, first, end, dt, sums); });
            store_gathered(flow, n, sums);
        });
        note_changed(flow);
        return total(flow.active, gathered_);
    }

    /// Points are still in the first cache when they deposit.
    PointSums carry(Flow& flow, double dt, double velocity_dt) override {
        if (some_asleep(flow)) return carry_apart(flow, dt, velocity_dt);  // what sleeps is chosen between the two
        prepare_gather(flow);
        const double cap = prepare_deposit(flow, velocity_dt);
        for_each_tile_in_turn(flow.active, [&](Index n) {
            const Index tile = flow.active.tile[n];
            touch_motions(flow, n);
            touch_deposits(flow, n);
            Sums moved, deposited;
            StencilMarks marks = flow.marks_of(tile);
            for_each_batch(flow, n, [&](Index first, Index end, bool at_side) {
                gather_batch(flow, first, end, dt, moved);
                if (moved.rare.bad < 0) deposits_->deposit(flow, first, end, cap, at_side, marks, deposited);
            });
            flow.reach[tile] = marks.reach(kReachBefore, kReachAfter);
            deposited_[tile] = deposited.points();
            store_gathered(flow, n, moved);
        });
        finish_deposit(flow);
        PointSums sums = total(flow.active, gathered_);
        sums.stress_power = total(flow.active, deposited_).stress_power;
        return sums;
    }

    void probe(Flow& flow, Probe& out) override {
        const std::size_t count = static_cast<std::size_t>(flow.particles.count());
        for (auto* array : {&out.vx, &out.vy, &out.cxx, &out.cxy, &out.cyx, &out.cyy, &out.depth}) array->resize(count);
        for_each_tile(flow.active, [&](Index n) {
            for_each_four(flow.active.begin[n], flow.active.begin[n + 1], [&](Index p, int lanes) {
                const Gathered g(flow, p, lanes);
                store(&out.vx[p], g.vx, lanes);
                store(&out.vy[p], g.vy, lanes);
                store(&out.cxx[p], g.cxx, lanes);
                store(&out.cxy[p], g.cxy, lanes);
                store(&out.cyx[p], g.cyx, lanes);
                store(&out.cyy[p], g.cyy, lanes);
                store(&out.depth[p], g.depth, lanes);
            });
        });
    }

private:
    void store_gathered(Flow& flow, Index n, const Sums& sums) {
        gathered_[flow.active.tile[n]] = sums.points();
        note_rest(flow, n, largest(sums.motion) == 0.0);
    }

    void prepare_gather(const Flow& flow) {
        make_room(flow);
        assign_sparingly(gone_, static_cast<std::size_t>(flow.particles.count()), std::uint8_t{0});
    }

    /// Clears what will be deposited; returns the largest 2 mu_eff that is stable explicitly [Pa s].
    double prepare_deposit(Flow& flow, double velocity_dt) {
        make_room(flow);
        start_deposit(flow, kReachBefore, kReachAfter);
        return most_viscosity(flow, velocity_dt);
    }

    template <class Body>
    static void for_each_batch(const Flow& flow, Index n, Body&& body) {
        const bool at_side = !flow.walls && near_side(flow.grid, flow.active.tile[n]);
        const Index last = flow.active.begin[n + 1];
        for (Index first = flow.active.begin[n]; first < last; first += kBatch) {
            const Index end = std::min(first + kBatch, last);
            touch_points(flow.particles, first, end);
            body(first, end, at_side);
        }
    }

    /// All particles side by side (base/touch.h).
    static void touch_points(const Particles& c, Index first, Index end) {
        const Carried<Real>& h = c.carried<Real>();
        const double* const placed[] = {c.x.data(), c.y.data(), c.mass.data()};
        const Real* const carried[] = {h.r1x.data(), h.r1y.data(), h.r2x.data(),  h.r2y.data(),
                                       h.vx.data(),  h.vy.data(),  h.cxx.data(),  h.cxy.data(),
                                       h.cyx.data(), h.cyy.data(), h.depth.data()};
        for (Index p = first; p < end; p += kCacheLine / sizeof(double)) {
            for (const double* particle : placed) touch(particle + p);
            for (const Real* particle : carried) touch(particle + p);
        }
    }

    static void touch_motions(const Flow& flow, Index n) {
        for_each_row_of_full(flow.grid, flow.active, n,
                             [&](Index k, Index count) { touch(flow.nodes.motions() + k, count); });
    }
    static void touch_deposits(const Flow& flow, Index n) {
        for_each_row_of_full(flow.grid, flow.active, n, [&](Index k, Index count) {
            touch(flow.nodes.deposits() + k, count);
            touch(flow.nodes.mass.data() + k, count);
            touch(flow.nodes.column_mass.data() + k, count);
        });
    }

    /// Not inlined, as DepositsOf::deposit. Where a product and a sum become one rounding is the compiler's choice at each
    /// place. The bits must not depend on which pass calls them.
    [[gnu::noinline]] void gather_batch(Flow& flow, Index first, Index end, double dt, Sums& sums) {
        for_each_four(first, end, [&](Index p, int lanes) { gather_four(flow, p, lanes, dt, sums); });
    }

    /// Velocity, its gradient (TPIC: sum v (x) grad N) and depth at four points. Also the change of the two-cell wave
    /// over a cell.
    struct OfFour {
        Double4 vx{}, vy{}, depth{}, cxx{}, cxy{}, cyx{}, cyy{}, wave_x{}, wave_y{};
        /// From what each of the four has: value, and change over a cell.
        [[gnu::always_inline]] void take(const Double4 (&value)[4], const Double4 (&by_x)[4], const Double4 (&by_y)[4],
                                         double cell) {
            const double scale = 1.0 / cell;
            Double4 of[4];
            transpose(value[0], value[1], value[2], value[3], of);
            vx = of[0], vy = of[1], depth = of[2];
            transpose(by_x[0], by_x[1], by_x[2], by_x[3], of);
            cxx = scale * of[0], cyx = scale * of[1], wave_x = of[3];
            transpose(by_y[0], by_y[1], by_y[2], by_y[3], of);
            cxy = scale * of[0], cyy = scale * of[1], wave_y = of[3];
        }
    };

    struct Gathered : OfFour {
        [[gnu::always_inline]] Gathered(const Flow& flow, Index p, int lanes) {
            const Particles& c = flow.particles;
            const Stencils sx(load(&c.x[p], lanes)), sy(load(&c.y[p], lanes));
            const Index stride = flow.grid.stride();
            Double4 value[4], by_x[4], by_y[4];
            for (int lane = 0; lane < 4; ++lane) {
                Double4 v = {}, slope_x = {}, slope_y = {};
                if (lane < lanes) {
                    const Reach reach(sx, sy, stride, lane);
                    const Motion* row = flow.nodes.motions() + reach.node;
                    for (int j = 0; j < 3; ++j, row += stride) {
                        const Double4 a = load(row), b = load(row + 1), d = load(row + 2);
                        const Double4 along = reach.wx[0] * a + reach.wx[1] * b + reach.wx[2] * d;
                        v += reach.wy[j] * along;
                        slope_x += reach.wy[j] * (reach.sx[0] * a + reach.sx[1] * b + reach.sx[2] * d);
                        slope_y += reach.sy[j] * along;
                    }
                }
                value[lane] = v, by_x[lane] = slope_x, by_y[lane] = slope_y;
            }
            this->take(value, by_x, by_y, flow.cell);
        }
    };

    /// What four points retain of their own motion beyond the nodes': see transfer.cpp.
    struct Own : OfFour {
        Double4 largest_part() const {
            return max(max(abs(this->vx), abs(this->vy)),
                       max(max(abs(this->cxx), abs(this->cxy)), max(abs(this->cyx), abs(this->cyy))));
        }
        [[gnu::noinline]] Own(const Flow& flow, Index p, int lanes) {
            const Particles& c = flow.particles;
            const Carried<Real>& held = c.carried<Real>();
            const Stencils sx(load(&c.x[p], lanes)), sy(load(&c.y[p], lanes));
            Double4 gxx = load(&held.cxx[p], lanes), gxy = load(&held.cxy[p], lanes);
            Double4 gyx = load(&held.cyx[p], lanes), gyy = load(&held.cyy[p], lanes);
            limit_gradients({load(&held.r1x[p], lanes), load(&held.r1y[p], lanes), load(&held.r2x[p], lanes),
                             load(&held.r2y[p], lanes)},
                            gxx, gxy, gyx, gyy);
            const Double4 first_x = load(&held.vx[p], lanes) - flow.cell * (sx.offset * gxx + sy.offset * gxy);
            const Double4 first_y = load(&held.vy[p], lanes) - flow.cell * (sx.offset * gyx + sy.offset * gyy);
            const Index stride = flow.grid.stride();
            Double4 value[4], by_x[4], by_y[4];
            for (int lane = 0; lane < 4; ++lane) {
                Double4 v = {}, slope_x = {}, slope_y = {};
                if (lane < lanes) {
                    const Reach reach(sx, sy, stride, lane);
                    const Double4 along_x = flow.cell * Double4{gxx[lane], gyx[lane], 0.0, 0.0};
                    const Double4 along_y = flow.cell * Double4{gxy[lane], gyy[lane], 0.0, 0.0};
                    Double4 row = {first_x[lane], first_y[lane], 0.0, 0.0};
                    Index k = reach.node;
                    for (int j = 0; j < 3; ++j, k += stride, row += along_y) {
                        const auto more = [&](int i) {
                            const Pair& before = flow.nodes.before[k + i];
                            const double share = flow.carried_share * flow.nodes.velocity_share[k + i];
                            return share *
                                   (row + static_cast<double>(i) * along_x - Double4{before.x, before.y, 0.0, 0.0});
                        };
                        const Double4 a = more(0), b = more(1), d = more(2);
                        const Double4 along = reach.wx[0] * a + reach.wx[1] * b + reach.wx[2] * d;
                        v += reach.wy[j] * along;
                        slope_x += reach.wy[j] * (reach.sx[0] * a + reach.sx[1] * b + reach.sx[2] * d);
                        slope_y += reach.sy[j] * along;
                    }
                }
                value[lane] = v, by_x[lane] = slope_x, by_y[lane] = slope_y;
            }
            this->take(value, by_x, by_y, flow.cell);
        }
    };

    [[gnu::always_inline]] static void take_motion(Carried<Real>& held, Index p, int lanes, const Gathered& g) {
        store(&held.vx[p], g.vx, lanes), store(&held.vy[p], g.vy, lanes);
        store(&held.cxx[p], g.cxx, lanes), store(&held.cxy[p], g.cxy, lanes);
        store(&held.cyx[p], g.cyx, lanes), store(&held.cyy[p], g.cyy, lanes);
    }
    static void take_motion(Carried<Real>& held, Index p, int lanes, const Gathered& g, const Own& own, Sums& sums) {
        store(&held.vx[p], g.vx + own.vx, lanes), store(&held.vy[p], g.vy + own.vy, lanes);
        store(&held.cxx[p], g.cxx + own.cxx, lanes), store(&held.cxy[p], g.cxy + own.cxy, lanes);
        store(&held.cyx[p], g.cyx + own.cyx, lanes), store(&held.cyy[p], g.cyy + own.cyy, lanes);
        sums.motion = max(sums.motion, own.largest_part());
    }
    static Double4 speed_of(const Carried<Real>& held, Index p, int lanes) {
        const Double4 vx = load(&held.vx[p], lanes), vy = load(&held.vy[p], lanes);
        return sqrt(vx * vx + vy * vy);
    }

    [[gnu::always_inline]] void gather_four(Flow& flow, Index p, int lanes, double dt, Sums& sums) {
        Particles& c = flow.particles;
        Carried<Real>& held = c.carried<Real>();
        const Gathered g(flow, p, lanes);
        const double cells = dt / flow.cell;
        const Double4 gathered_speed = sqrt(g.vx * g.vx + g.vy * g.vy);
        Double4 shift_x = cells * g.vx, shift_y = cells * g.vy;
        off_waves(flow.scheme.wave_shift, g.wave_x, g.wave_y, cells * gathered_speed, shift_x, shift_y);
        const Double4 shift = max(abs(shift_x), abs(shift_y));
        const Mask4 is_finite = shift <= 4.0;  // also catches what is not finite
        if (any(~is_finite)) {
            for (int lane = 0; lane < lanes; ++lane)
                if (!is_finite[lane] && sums.rare.bad < 0) sums.rare.bad = p + lane;
            return;
        }
        const bool flip = flow.carried_share > 0.0;
        if (flip)
            take_motion(held, p, lanes, g, Own(flow, p, lanes), sums);
        else
            take_motion(held, p, lanes, g);
        const Double4 x = load(&c.x[p], lanes) + shift_x, y = load(&c.y[p], lanes) + shift_y;
        store(&c.x[p], x, lanes), store(&c.y[p], y, lanes);
        store(&held.depth[p], g.depth, lanes);
        stretch(&held.r1x[p], &held.r1y[p], g, dt, lanes);
        stretch(&held.r2x[p], &held.r2y[p], g, dt, lanes);

        const Double4 speed = flip ? speed_of(held, p, lanes) : gathered_speed, zero = {};
        sums.shift = max(sums.shift, shift);
        sums.motion = max(
            sums.motion, max(max(abs(g.vx), abs(g.vy)), max(max(abs(g.cxx), abs(g.cxy)), max(abs(g.cyx), abs(g.cyy)))));
        sums.speed = max(sums.speed, speed);
        sums.signal = max(sums.signal, speed + sqrt(flow.gravity * max(g.depth, zero)));
        Double4 m = load(&c.mass[p], lanes), vx = load(&held.vx[p], lanes), vy = load(&held.vy[p], lanes);
        const double x_max = static_cast<double>(flow.grid.nx() - 1), y_max = static_cast<double>(flow.grid.ny() - 1);
        const double on = flow.walls ? kOnWall : 0.0;
        if (flow.bed.has_exits || any((x < on) | (x > x_max - on) | (y < on) | (y > y_max - on))) {
            for (int lane = 0; lane < lanes; ++lane) {
                const double set_back = meet_side<Real>(flow, p + lane, shift_x[lane], shift_y[lane], gone_, sums.rare);
                if (set_back > 0.0) sums.rare.max_shift = std::max(sums.rare.max_shift, shift[lane] + set_back);
                vx[lane] = held.vx[p + lane], vy[lane] = held.vy[p + lane];
                if (gone_[p + lane]) m[lane] = 0.0;
            }
        }
        sums.mass += m;
        sums.px += m * vx;
        sums.py += m * vy;
        sums.p_abs += m * speed;
    }

    [[gnu::always_inline]] static void stretch(Real* rx, Real* ry, const Gathered& g, double dt, int lanes) {
        const Double4 x = load(rx, lanes), y = load(ry, lanes);
        store(rx, x + dt * (g.cxx * x + g.cxy * y), lanes);
        store(ry, y + dt * (g.cyx * x + g.cyy * y), lanes);
    }

    std::unique_ptr<PointDeposits> deposits_;
};

template <class Real>
std::unique_ptr<TransferKernel> packed_kernel(const Scene& scene) {
    const auto deposits = [](const auto& law) -> std::unique_ptr<PointDeposits> {
        return std::make_unique<DepositsOf<std::decay_t<decltype(law)>, Real>>(law);
    };
    return std::make_unique<PackedKernel<Real>>(scene.rheologies() ? deposits(RheologyOfEachNode{})
                                                                   : std::visit(deposits, scene.rheology));
}

}  // namespace

std::unique_ptr<TransferKernel> make_packed_transfer(const Scene& scene) {
    const Scheme& scheme = scene.scheme;
    if (scheme.shape != Shape::quadratic || scheme.transfer != Transfer::tpic || scheme.paper_pressure) return nullptr;
    return scheme.precision == Precision::single ? packed_kernel<float>(scene) : packed_kernel<double>(scene);
}

}  // namespace frana
