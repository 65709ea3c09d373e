// The conversion from particles to 3D points. The field is that of Fois, de Falco, Formaggia (2025), section 4.3: h =
// 10 - sin(2x) cos(y), u = 2.001 m/s on [0, 5]^2.
#include <algorithm>
#include <chrono>
#include <cmath>

#include "checks/verify/library.h"
#include "convert/conservation.h"
#include "convert/paper_errors.h"

namespace frana::verify {
namespace {

constexpr double kSide = 5.0, kSlabSpeed = 2.001, kSlabDensity = 1000.0;  // the paper names no density
constexpr double kSpacings[] = {0.01, 0.00001};  // the largest and the smallest h_z of the paper [m]

double depth_at(double x, double y) { return 10.0 - std::sin(2.0 * x) * std::cos(y); }

/// Integral of the depth over [x0, x1] x [y0, y1] [m3].
double volume_over(double x0, double x1, double y0, double y1) {
    return 10.0 * (x1 - x0) * (y1 - y0) -
           0.5 * (std::cos(2.0 * x0) - std::cos(2.0 * x1)) * (std::sin(y1) - std::sin(y0));
}

/// How the mass came onto the particles. Evenly, as the paper's generation does it, or each the mass over its own
/// square.
enum class Sharing { even, own };

/// `cells` x `cells` particles in the middles of squares.
struct Field {
    Index cells = 0;
    Sharing sharing = Sharing::own;
    double width() const { return kSide / static_cast<double>(cells); }
    Index particles() const { return cells * cells; }
    ErrorParticle particle(Index p) const {
        const Index place = p % cells, row = p / cells;
        const double x = width() * static_cast<double>(place), y = width() * static_cast<double>(row);
        const double even = volume_over(0.0, kSide, 0.0, kSide) / static_cast<double>(particles());
        const double volume = sharing == Sharing::even ? even : volume_over(x, x + width(), y, y + width());
        const double mass = kSlabDensity * volume;
        return {depth_at(x + 0.5 * width(), y + 0.5 * width()), mass, volume, mass * kSlabSpeed};
    }
    ConversionErrors errors(double spacing) const {
        const double mass = kSlabDensity * volume_over(0.0, kSide, 0.0, kSide);
        return conversion_errors(particles(), [this](Index p) { return particle(p); }, spacing,
                                 {mass, mass * kSlabSpeed});
    }
};

double order_between(double coarse, double fine, double ratio) { return std::log(coarse / fine) / std::log(ratio); }

/// Points of the field, 1 m apart so that they fit in memory, with a parabolic profile. Checks what conversion must
/// conserve.
Conservation keep(const Field& field) {
    FlowParticles c;
    for (Index p = 0; p < field.particles(); ++p) {
        const ErrorParticle particle = field.particle(p);
        const Index place = p % field.cells, row = p / field.cells;
        c.x.push_back(field.width() * (static_cast<double>(place) + 0.5));
        c.y.push_back(field.width() * (static_cast<double>(row) + 0.5));
        c.depth.push_back(particle.depth);
        c.mass.push_back(particle.mass);
        c.volume.push_back(particle.volume);
    }
    c.id = c.bed_pressure = c.slope_x = c.slope_y = c.bed = c.vy = std::vector<double>(c.count(), 0.0);
    c.vx.assign(c.count(), kSlabSpeed);
    const ConversionChoice choice{1.0, Layers::centres, Vertical::zero, VelocityProfile::parabolic};
    return conservation_of(c, particles_to_points(c, choice), choice);
}

/// The largest error of the quantities with that unit, or of those with another; in total and per particle.
double largest_error(const Conservation& kept, const std::string& unit, bool with) {
    double largest = 0.0;
    for (const Kept& quantity : kept.kept)
        if ((quantity.unit == unit) == with)
            largest = std::max({largest, quantity.relative_error, quantity.worst_particle});
    return largest;
}

Measurement run_conversion(const Setup& setup) {
    const auto start = std::chrono::steady_clock::now();
    const Field even{setup.cells, Sharing::even}, own{setup.cells, Sharing::own}, half{setup.cells / 2, Sharing::even};
    const Conservation kept = keep(own);
    const ConversionErrors coarse = even.errors(kSpacings[0]), fine = even.errors(kSpacings[1]);
    const ConversionErrors own_coarse = own.errors(kSpacings[0]), own_fine = own.errors(kSpacings[1]);
    const double ratio = kSpacings[0] / kSpacings[1];
    const double order_hz = order_between(coarse.mass, fine.mass, ratio);
    const double order_hx = order_between(half.errors(kSpacings[0]).mass, coarse.mass, 2.0);
    const double momentum_order = order_between(coarse.momentum, fine.momentum, ratio);
    Measurement m;
    m.particles = even.particles();
    m.mass_error = largest_error(kept, "kg m/s", false);
    m.add("momentum_error", largest_error(kept, "kg m/s", true));
    m.add("mass_measure", coarse.mass, "kg");
    m.add("momentum_measure", coarse.momentum, "kg m/s");
    m.add("order_hz", order_hz);
    m.add("order_hx", order_hx);
    m.add("order_gap", std::max({std::abs(order_hz - 1.0), std::abs(momentum_order - 1.0), std::abs(order_hx - 2.0)}));
    m.add("own_mass_measure", own_coarse.mass, "kg");
    m.add("own_order_hz", order_between(own_coarse.mass, own_fine.mass, ratio));
    m.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return m;
}

/// The closed form of the total against the midpoint rule.
std::vector<Residual> total_volume() {
    double sum = 0.0;
    constexpr int n = 1000;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) sum += depth_at((i + 0.5) * kSide / n, (j + 0.5) * kSide / n);
    const double volume = volume_over(0.0, kSide, 0.0, kSide);
    return {{"volume of the field", sum * kSide * kSide / (n * n) / volume - 1.0, 1e-6}};
}

}  // namespace

std::vector<Problem> conversion_problems() {
    Problem conversion{"conversion",
                       "particles into 3D points: what is kept, and the measures of Fois et al. 2025, section 4.3",
                       {250, 500, 1000},
                       total_volume,
                       run_conversion};
    conversion.order_of = "mass_measure";
    conversion.gates = {
        {0, "mass_error", 1e-12, "goal, in total and per particle"},
        {0, "momentum_error", 1e-12, "goal, in total and per particle"},
        {0, "order_gap", 0.05, "first order in h_z, second in h_x: eqs. 7, 8 and figure 12 of the paper"}};
    return {conversion};
}

}  // namespace frana::verify
