#include "law/structured_law.h"

#include <algorithm>
#include <limits>

#include "base/error.h"

namespace frana {
namespace {

/// alpha of the cone sqrt(J2) + alpha I1 = k of an angle [rad] with this sine.
double cone_slope(ColumnYield yield, double sine) {
    return yield == ColumnYield::plane_strain ? sine / 3.0 : 2.0 * sine / (std::sqrt(3.0) * (3.0 - sine));
}

}  // namespace

void large_turn(double a, double& cosine, double& sine) { cosine = std::cos(a), sine = std::sin(a); }

void large_turn(const Double4& a, Double4& cosine, Double4& sine) {
    for (int n = 0; n < 4; ++n) cosine[n] = std::cos(a[n]), sine[n] = std::sin(a[n]);
}

ColumnLaw::ColumnLaw(const ColumnMaterial& m)
    : material_(m),
      shear_(0.5 * m.young / (1.0 + m.poisson)),
      bulk_(m.young / (3.0 * (1.0 - 2.0 * m.poisson))),
      plane_(m.young / (1.0 - m.poisson * m.poisson)),
      weight_share_(m.poisson / (1.0 - m.poisson)),
      sine_(std::sin(m.friction)),
      cosine_(std::cos(m.friction)),
      active_((1.0 - sine_) / (1.0 + sine_)) {
    expect(m.young > 0.0 && m.poisson >= 0.0 && m.poisson < 0.5, "a solid needs 0 < E and 0 <= nu < 1/2");
    expect(m.friction > 0.0 && m.dilatancy >= 0.0 && m.dilatancy <= m.friction,
           "a solid needs 0 <= psi <= phi, 0 < phi");
    expect(m.critical_strain > 0.0 && m.onset >= 0.0, "a solid breaks at a strain above zero");
    alpha_ = cone_slope(m.yield, sine_);
    k_ = m.yield == ColumnYield::plane_strain ? cosine_ : 6.0 * cosine_ / (std::sqrt(3.0) * (3.0 - sine_));
    dilates_ = cone_slope(m.yield, std::sin(m.dilatancy));
}

ConeReturn ColumnLaw::to_cone(double q, double first, double k) const {
    const double beyond = q + alpha_ * first - k;
    if (beyond <= 0.0) return {1.0, first, 0.0};
    const double multiplier = beyond / (shear_ + 9.0 * bulk_ * alpha_ * dilates_);
    const double left = q - shear_ * multiplier;
    if (left < 0.0) return {0.0, k / alpha_, multiplier};
    return {left / q, first - 9.0 * bulk_ * dilates_ * multiplier, multiplier};
}

PlasticStep ColumnLaw::yield(double cohesion, ColumnStress& s) const {
    return material_.yield == ColumnYield::hexagon ? yield_to_hexagon(cohesion, s)
                                                   : yield_to_cone(k_ * cohesion, s);
}

namespace {

/// The search for t below: Newton's step within a bracket that grows by doubling until it holds the root,
/// halved where Newton leaves it.
class Bracket {
public:
    explicit Bracket(double reach) : reach_(reach) {}
    double next(double t, double miss, double slope) {
        (miss > 0.0 ? high_ : low_) = t;
        const double newton = slope > 0.0 ? t - miss / slope : std::numeric_limits<double>::quiet_NaN();
        if (newton > low_ && newton < high_) return newton;
        if (std::isfinite(low_) && std::isfinite(high_)) return 0.5 * (low_ + high_);
        reach_ *= 2.0;
        return miss > 0.0 ? t - reach_ : t + reach_;
    }

private:
    double low_ = -std::numeric_limits<double>::infinity(), high_ = std::numeric_limits<double>::infinity(),
           reach_;
};

constexpr int kMostPasses = 100;  // of the search; two to four are usual
constexpr double kStressError =
    1e-7;  // of zz, over the strength and the weight: far below what damage resolves

}  // namespace

/// Looks for the strain t across the bed, beyond that of the elastic step, at which the return in space
/// leaves zz where it was prescribed.
PlasticStep ColumnLaw::yield_to_cone(double k, ColumnStress& s) const {
    const double first = s.xx + s.yy + s.zz, mean = first / 3.0, g = shear_, bulk = bulk_;
    const double x = s.xx - mean, y = s.yy - mean, z = s.zz - mean, xy = s.xy;
    const double in_plane = 0.5 * (x * x + y * y) + xy * xy;
    const double tolerance = kStressError * (k + std::abs(s.zz)) + std::numeric_limits<double>::min();
    Bracket bracket((k + std::abs(s.zz) + std::sqrt(in_plane + 0.5 * z * z)) / bulk);
    double t = 0.0, q = 0.0, sz = 0.0;
    ConeReturn back{};
    for (int pass = 0; pass < kMostPasses; ++pass) {
        const double sx = x - 2.0 / 3.0 * g * t, sy = y - 2.0 / 3.0 * g * t, first_t = first + 3.0 * bulk * t;
        sz = z + 4.0 / 3.0 * g * t;
        q = std::sqrt(0.5 * (sx * sx + sy * sy + sz * sz) + xy * xy);
        back = to_cone(q, first_t, k);
        const double miss = back.scale * sz + back.first / 3.0 - s.zz;
        if (std::abs(miss) <= tolerance) break;
        double slope = 4.0 / 3.0 * g + bulk;
        if (back.scale == 0.0)
            slope = 0.0;
        else if (back.multiplier > 0.0) {
            const double dq = g * sz / q;
            const double flow = (dq + 3.0 * bulk * alpha_) / (g + 9.0 * bulk * alpha_ * dilates_);
            slope = 4.0 / 3.0 * g * back.scale + sz * (dq - g * flow - back.scale * dq) / q +
                    bulk * (1.0 - 3.0 * dilates_ * flow);
        }
        t = bracket.next(t, miss, slope);
    }
    const double flow = q > 0.0 ? 0.5 * back.multiplier / q : 0.0, swell = back.multiplier * dilates_;
    const double sx = x - 2.0 / 3.0 * g * t, sy = y - 2.0 / 3.0 * g * t;
    s.xx = back.scale * sx + back.first / 3.0;
    s.yy = back.scale * sy + back.first / 3.0;
    s.xy = back.scale * xy;
    const double half_trace = -0.5 * flow * sz + swell, radius = flow * std::hypot(0.5 * (sx - sy), xy);
    return {2.0 * half_trace, half_trace + radius};
}

namespace {

/// One face of the hexagon, n . s <= bound, and the direction of flow on it, in principal values of the
/// plane.
struct Face {
    double n[2], bound, m[2];
    double excess(const double* s) const { return n[0] * s[0] + n[1] * s[1] - bound; }
};

/// Stress that a plastic strain m takes away, over E / (1 - nu^2).
double taken(const double* m, int axis, double poisson) { return m[axis] + poisson * m[1 - axis]; }

double rate(const Face& of, const Face& flow, double poisson) {
    return of.n[0] * taken(flow.m, 0, poisson) + of.n[1] * taken(flow.m, 1, poisson);
}

}  // namespace

/// In principal values s_1 >= s_2 of the plane the pyramid with zz as prescribed is bounded by s_1 <= high,
/// s_2 >= low, (s_1 - s_2) + (s_1 + s_2) sin(phi) <= 2 c cos(phi). Elastic and plastic strain across the bed
/// are free, so that stress is taken away by the stiffness of plane stress. Faces first, then the corners
/// between them (Koiter).
PlasticStep ColumnLaw::yield_to_hexagon(double cohesion, ColumnStress& s) const {
    const double centre = 0.5 * (s.xx + s.yy), half = 0.5 * (s.xx - s.yy), radius = std::hypot(half, s.xy);
    const double cosine = radius > 0.0 ? half / radius : 1.0, sine = radius > 0.0 ? s.xy / radius : 0.0;
    const double up = 1.0 + std::sin(material_.dilatancy), down = 1.0 - std::sin(material_.dilatancy);
    const double high = active_ * s.zz + 2.0 * cohesion * std::sqrt(active_);
    const double low = s.zz / active_ - 2.0 * cohesion / std::sqrt(active_);
    const double strength = 2.0 * cohesion * cosine_;
    const Face faces[5] = {{{1, 0}, high, {up, 0}},
                           {{1.0 + sine_, -(1.0 - sine_)}, strength, {up, -down}},
                           {{0, -1}, -low, {0, -down}},
                           {{0, 1}, high, {0, up}},
                           {{-1, 0}, -low, {-down, 0}}};
    const double trial[2] = {centre + radius, centre - radius}, nu = material_.poisson;
    const double near = 1e-12 * (std::abs(high) + std::abs(low) + std::abs(trial[0]) + std::abs(trial[1]));
    double kept[2] = {trial[0], trial[1]}, strain[2] = {0.0, 0.0},
           least = std::numeric_limits<double>::infinity();
    // The admissible return that leaves the least outside; by round-off more than one may qualify, and then
    // they agree.
    const auto consider = [&](const Face& a, double la, const Face& b, double lb) {
        if (!(la >= 0.0 && lb >= 0.0)) return;
        double at[2], worst = 0.0;
        for (int axis = 0; axis < 2; ++axis)
            at[axis] = trial[axis] - la * taken(a.m, axis, nu) - lb * taken(b.m, axis, nu);
        for (const Face& face : faces) worst = std::max(worst, face.excess(at));
        if (worst >= std::max(least, near) || worst >= least) return;
        least = worst;
        for (int axis = 0; axis < 2; ++axis)
            kept[axis] = at[axis], strain[axis] = (la * a.m[axis] + lb * b.m[axis]) / plane_;
    };
    for (const Face& face : faces) consider(face, face.excess(trial) / rate(face, face, nu), face, 0.0);
    for (const auto& corner : {std::pair<int, int>{0, 3}, {0, 1}, {1, 2}, {2, 4}}) {
        if (least <= near) break;
        const Face &a = faces[corner.first], &b = faces[corner.second];
        const double aa = rate(a, a, nu), ab = rate(a, b, nu), ba = rate(b, a, nu), bb = rate(b, b, nu);
        const double ea = a.excess(trial), eb = b.excess(trial), det = aa * bb - ab * ba;
        consider(a, (ea * bb - eb * ab) / det, b, (eb * aa - ea * ba) / det);
    }
    const double mean = 0.5 * (kept[0] + kept[1]), reach = 0.5 * (kept[0] - kept[1]);
    s.xx = mean + reach * cosine, s.yy = mean - reach * cosine, s.xy = reach * sine;
    // Plastic strain of taking away (1 - nu^2) E^-1 C m: the multipliers above are times E / (1 - nu^2).
    return {strain[0] + strain[1], std::max(strain[0], strain[1])};
}

void ColumnLaw::give_way(bool, const ColumnStep& step, double left, ColumnStress& s,
                         ColumnState& state) const {
    const PlasticStep plastic = yield(left, s);
    const double critical = material_.critical_strain;
    if (material_.damage_by == DamageBy::strain) {
        const double now = std::abs(step.xx) + std::abs(step.yy) + 2.0 * std::abs(step.xy);
        if (state.strain > material_.onset)
            state.damage = 1.0 - (1.0 - state.damage) * std::exp(-now / critical);
        return;
    }
    const double opened = material_.damage_by == DamageBy::dilation ? plastic.dilation : plastic.extension;
    state.damage = std::min(1.0, state.damage + std::max(0.0, opened) / critical);
}

namespace {

struct ConeReturns {
    Double4 scale, first, multiplier;
};

}  // namespace

/// yield_to_cone for four columns at once, number by number the same, as long as Newton's steps stay in the bracket; returns
/// which columns got there in a few of them. `dilation`: of those.
Mask4 ColumnLaw::yield_four_to_cone(const Mask4& yields, const Double4& k, ColumnStressOf<Double4>& s,
                                    Double4& dilation) const {
    constexpr int kPasses = 6;
    const Double4 none = {}, one = all(1.0);
    const double g = shear_, bulk = bulk_, far = std::numeric_limits<double>::infinity();
    const double per_multiplier = shear_ + 9.0 * bulk_ * alpha_ * dilates_;
    const Double4 first = s.xx + s.yy + s.zz, mean = first / 3.0;
    const Double4 x = s.xx - mean, y = s.yy - mean, z = s.zz - mean, xy = s.xy;
    const Double4 tolerance = kStressError * (k + abs(s.zz)) + std::numeric_limits<double>::min();
    Double4 t = none, q = none, sz = none, low = all(-far), high = all(far);
    ConeReturns back{one, first, none};
    Mask4 found = ~yields, open = yields;  // found: no need to look any more
    for (int pass = 0; pass < kPasses && any(open); ++pass) {
        const Double4 sx = x - 2.0 / 3.0 * g * t, sy = y - 2.0 / 3.0 * g * t, first_t = first + 3.0 * bulk * t;
        const Double4 sz_t = z + 4.0 / 3.0 * g * t;
        const Double4 q_t = sqrt(0.5 * (sx * sx + sy * sy + sz_t * sz_t) + xy * xy);
        const Double4 beyond = q_t + alpha_ * first_t - k, multiplier = beyond / per_multiplier;
        const Double4 left = q_t - shear_ * multiplier;
        const Mask4 inside = beyond <= 0.0, apex = left < 0.0;
        const ConeReturns now{select(inside, one, select(apex, none, left / q_t)),
                              select(inside, first_t, select(apex, k / alpha_, first_t - 9.0 * bulk_ * dilates_ * multiplier)),
                              select(inside, none, multiplier)};
        sz = select(open, sz_t, sz), q = select(open, q_t, q);
        back = {select(open, now.scale, back.scale), select(open, now.first, back.first),
                select(open, now.multiplier, back.multiplier)};
        const Double4 miss = now.scale * sz_t + now.first / 3.0 - s.zz;
        const Mask4 there = open & (abs(miss) <= tolerance);
        found |= there, open &= ~there;
        const Double4 dq = g * sz_t / q_t;
        const Double4 flow = (dq + 3.0 * bulk * alpha_) / (g + 9.0 * bulk * alpha_ * dilates_);
        const Double4 bent = 4.0 / 3.0 * g * now.scale + sz_t * (dq - g * flow - now.scale * dq) / q_t +
                             bulk * (1.0 - 3.0 * dilates_ * flow);
        const Double4 slope = select(now.scale == 0.0, none,
                                     select(now.multiplier > 0.0, bent, all(4.0 / 3.0 * g + bulk)));
        high = select(miss > 0.0, t, high), low = select(miss > 0.0, low, t);
        const Double4 newton = t - miss / slope;
        open &= (slope > 0.0) & (newton > low) & (newton < high);
        t = select(open, newton, t);
    }
    found &= yields;
    const Double4 flow = select(q > 0.0, 0.5 * back.multiplier / q, none), swell = back.multiplier * dilates_;
    const Double4 sx = x - 2.0 / 3.0 * g * t, sy = y - 2.0 / 3.0 * g * t;
    s.xx = select(found, back.scale * sx + back.first / 3.0, s.xx);
    s.yy = select(found, back.scale * sy + back.first / 3.0, s.yy);
    s.xy = select(found, back.scale * xy, s.xy);
    dilation = 2.0 * (-0.5 * flow * sz + swell);
    return found;
}

void ColumnLaw::give_way(const Mask4& yields, const ColumnStepOf<Double4>& step, const Double4& left,
                         ColumnStressOf<Double4>& s, ColumnStateOf<Double4>& state) const {
    Mask4 alone = yields;
    if (!is_hexagon() && material_.damage_by == DamageBy::dilation) {
        Double4 dilation = {};
        const Mask4 found = yield_four_to_cone(yields, k_ * left, s, dilation);
        const Double4 more = max(dilation, Double4{}) / material_.critical_strain;
        state.damage = select(found, min(all(1.0), state.damage + more), state.damage);
        alone &= ~found;
    }
    if (!any(alone)) return;
    for (int n = 0; n < 4; ++n) {
        if (!alone[n]) continue;
        ColumnStress lone{s.xx[n], s.yy[n], s.zz[n], s.xy[n]};
        ColumnState kept{{}, state.damage[n], state.strain[n]};
        give_way(true, ColumnStep{step.xx[n], step.yy[n], step.xy[n], 0.0}, left[n], lone, kept);
        s.xx[n] = lone.xx, s.yy[n] = lone.yy, s.xy[n] = lone.xy;
        state.damage[n] = kept.damage;
    }
}

}  // namespace frana
