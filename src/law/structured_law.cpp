#include "law/structured_law.h"

#include <algorithm>
#include <limits>

#include "base/error.h"

namespace frana {
namespace {

/// alpha of the cone sqrt(J2) + alpha I1 = k of an angle [rad] with this sine.
double cone_slope(StructuredYield yield, double sine) {
    return yield == StructuredYield::plane_strain ? sine / 3.0 : 2.0 * sine / (std::sqrt(3.0) * (3.0 - sine));
}

}  // namespace

void large_turn(double a, double& cosine, double& sine) { cosine = std::cos(a), sine = std::sin(a); }

void large_turn(const Double4& a, Double4& cosine, Double4& sine) {
    for (int n = 0; n < 4; ++n) cosine[n] = std::cos(a[n]), sine[n] = std::sin(a[n]);
}

StructuredLaw::StructuredLaw(const StructuredMaterial& m)
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
    k_ = m.yield == StructuredYield::plane_strain ? cosine_ : 6.0 * cosine_ / (std::sqrt(3.0) * (3.0 - sine_));
    dilates_ = cone_slope(m.yield, std::sin(m.dilatancy));
}

ConeReturn StructuredLaw::to_cone(double q, double first, double k) const {
    const double beyond = q + alpha_ * first - k;
    if (beyond <= 0.0) return {1.0, first, 0.0};
    const double multiplier = beyond / (shear_ + 9.0 * bulk_ * alpha_ * dilates_);
    const double left = q - shear_ * multiplier;
    if (left < 0.0) return {0.0, k / alpha_, multiplier};
    return {left / q, first - 9.0 * bulk_ * dilates_ * multiplier, multiplier};
}

PlasticStep StructuredLaw::yield(double cohesion, StructuredStress& s) const {
    return material_.yield == StructuredYield::hexagon ? yield_to_hexagon(cohesion, s)
                                                       : yield_to_cone(k_ * cohesion, s);
}

namespace {

/// The search for t below: Newton's step within a bracket. The bracket grows by doubling until it holds the root, and
/// is halved where Newton leaves it.
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
    double low_ = -std::numeric_limits<double>::infinity(), high_ = std::numeric_limits<double>::infinity(), reach_;
};

constexpr int kMostPasses = 100;       // of the search; two to four are usual
constexpr double kStressError = 1e-7;  // of zz, over the strength and the weight: far below what damage resolves

}  // namespace

/// Finds the strain t across the bed, beyond that of the elastic step. At t the 3D return leaves zz where it was
/// prescribed. Finds it wherever it is.
PlasticStep StructuredLaw::search_cone(double k, StructuredStress& s) const {
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

/// search_cone where Newton's method gets there from the elastic step, or from where the mean stress is zz. The flow
/// must be that of the cone's side. Returns in which particles. `plastic`: of those. With t the deviator's z moves, x
/// and y by half as much against it, and I1. What zz misses is all but linear in t, and two passes mostly do. A pass
/// has one root, q = sqrt(J2) of the trial, and one division. That is q^3 times what is missed over q^3 times its
/// slope.
template <class Real, class Mask>
inline Mask StructuredLaw::newton_to_cone(Mask yields, Real k, StructuredStressOf<Real>& s,
                                          PlasticStepOf<Real>& plastic) const {
    constexpr int kUnasked = 2, kMost = 6;  // passes: a choice after each would delay the next particles
    const double g = shear_, bulk = bulk_, turn = 4.0 / 3.0 * g, per = 1.0 / (g + 9.0 * bulk * alpha_ * dilates_);
    const double kept = 1.0 - g * per,
                 swell = 3.0 * bulk * dilates_ * per;  // of q, in what is left of q and in the mean
    const double lean = 3.0 * bulk * alpha_;
    const Real first = s.xx + s.yy + s.zz, mean = (1.0 / 3.0) * first, z = s.zz - mean, across = 0.5 * (s.xx - s.yy);
    const Real plane2 = across * across + s.xy * s.xy, enough = kStressError * (k + abs(s.zz)),
               axis = alpha_ * first - k;
    Real t = select(kept * sqrt(plane2 + 0.75 * z * z) - g * per * axis > 0.0, Real{}, z / bulk), sz, q, left, lifted;
    const Real one = Real{} + 1.0;
    Mask on_side, open, rises = yields;
    for (int pass = 0;; ++pass) {
        sz = z + turn * t;
        const Real j2 = plane2 + 0.75 * sz * sz, beyond = axis + lean * t;
        q = sqrt(j2), left = kept * q - g * per * beyond, lifted = (bulk * t - z) - swell * (q + beyond);
        const Real miss = left * sz + lifted * q;  // times q
        on_side = yields & (q + beyond > 0.0) & (left > 0.0), open = on_side & (abs(miss) > enough * q);
        if (pass >= kUnasked && (pass == kMost || !any(open))) break;
        const Real slope = left * (turn * plane2) + q * ((kept * g) * sz * sz + (bulk - lean * swell) * j2) -
                           ((lean + 3.0 * bulk * dilates_) * g * per) * sz * j2;
        rises &= slope > 0.0;  // where it falls there may be two roots
        const Real newton = t - miss * j2 / select(slope > 0.0, slope, one);
        t = pass < kUnasked ? newton : select(open, newton, t);
    }
    const Mask found = (on_side ^ open) & rises;
    q = select(q > 0.0, q, one);  // of particles that do not yield
    const Real multiplier = per * (q + axis + lean * t), scale = left / q, middle = s.zz + lifted - 0.5 * scale * sz;
    const Real flow = 0.5 * multiplier / q, half_trace = dilates_ * multiplier - 0.5 * flow * sz;
    s.xx = select(found, middle + scale * across, s.xx);
    s.yy = select(found, middle - scale * across, s.yy);
    s.xy = select(found, scale * s.xy, s.xy);
    plastic = {2.0 * half_trace, half_trace + flow * sqrt(plane2)};
    return found;
}

PlasticStep StructuredLaw::yield_to_cone(double k, StructuredStress& s) const {
    PlasticStep plastic;
    return newton_to_cone(true, k, s, plastic) ? plastic : search_cone(k, s);
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

/// The plane has principal values s_1 >= s_2. The pyramid with zz as prescribed is bounded by s_1 <= high, s_2 >= low,
/// (s_1 - s_2) + (s_1 + s_2) sin(phi) <= 2 c cos(phi). Elastic and plastic strain across the bed are free. So stress is
/// taken away by the stiffness of plane stress. Faces first, then the corners between them (Koiter).
PlasticStep StructuredLaw::yield_to_hexagon(double cohesion, StructuredStress& s) const {
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
    double kept[2] = {trial[0], trial[1]}, strain[2] = {0.0, 0.0}, least = std::numeric_limits<double>::infinity();
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

void StructuredLaw::give_way(bool, const StructuredStep& step, double left, StructuredStress& s,
                             StructuredState& state) const {
    const PlasticStep plastic = yield(left, s);
    const double critical = material_.critical_strain;
    if (material_.damage_by == DamageBy::strain) {
        const double now = std::abs(step.xx) + std::abs(step.yy) + 2.0 * std::abs(step.xy);
        if (state.strain > material_.onset) state.damage = 1.0 - (1.0 - state.damage) * std::exp(-now / critical);
        return;
    }
    const double opened = material_.damage_by == DamageBy::dilation ? plastic.dilation : plastic.extension;
    state.damage = std::min(1.0, state.damage + std::max(0.0, opened) / critical);
}

void StructuredLaw::give_way(const Mask4& yields, const StructuredStepOf<Double4>& step, const Double4& left,
                             StructuredStressOf<Double4>& s, StructuredStateOf<Double4>& state) const {
    Mask4 alone = yields;
    if (!is_hexagon() && material_.damage_by == DamageBy::dilation) {
        PlasticStepOf<Double4> plastic;
        const Mask4 found = newton_to_cone(yields, k_ * left, s, plastic);
        const Double4 more = (1.0 / material_.critical_strain) * max(plastic.dilation, Double4{});
        state.damage = select(found, min(all(1.0), state.damage + more), state.damage);
        alone &= ~found;
    }
    if (!any(alone)) return;
    for (int n = 0; n < 4; ++n) {
        if (!alone[n]) continue;
        StructuredStress lone{s.xx[n], s.yy[n], s.zz[n], s.xy[n]};
        StructuredState kept{{}, state.damage[n], state.strain[n]};
        give_way(true, StructuredStep{step.xx[n], step.yy[n], step.xy[n], 0.0}, left[n], lone, kept);
        s.xx[n] = lone.xx, s.yy[n] = lone.yy, s.xy[n] = lone.xy;
        state.damage[n] = kept.damage;
    }
}

}  // namespace frana
