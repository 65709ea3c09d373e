#include "coupling/stage_conversion.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "terrain/bed_points.h"

namespace frana {
namespace {

bool marked(const std::vector<std::uint8_t>& marks, const GridGeometry& g, double x, double y) {
    const auto near = [&](double at, double start, Index count) {
        return std::clamp<Index>(static_cast<Index>(std::floor((at - start) / g.cell + 0.5)), 0, count - 1);
    };
    return marks[static_cast<std::size_t>(near(y, g.y0, g.ny) * g.nx + near(x, g.x0, g.nx))] != 0;
}

const double* numbers(const Frame& frame, const char* name) {
    const Field* const field = frame.particle(name);
    expect(field != nullptr, "particles have the quantities that 3D points need");
    return field->data;
}

}  // namespace

Mat2 domain_of(const Edges& edges, double cell) {
    Mat2 domain;
    domain << cell * edges.r1x, cell * edges.r2x, cell * edges.r1y, cell * edges.r2y;
    return domain;
}

std::vector<Mat2> domains_of(const Particles& particles, double cell, const Scheme& scheme) {
    std::vector<Mat2> domains;
    if (scheme.paper_pressure) return domains;
    particles.with_real([&](auto real) {
        const auto& held = particles.carried<decltype(real)>();
        for (Index p = 0; p < particles.count(); ++p) domains.push_back(domain_of(edges_of(held, p), cell));
    });
    return domains;
}

FlowParticles particles_of(const Frame& frame, const std::vector<Mat2>& domains, const Raster& bed,
                           const std::vector<std::uint8_t>& marks) {
    const double *position = numbers(frame, "position"), *velocity = numbers(frame, "velocity"),
                 *depth = numbers(frame, "depth"), *mass = numbers(frame, "mass"), *volume = numbers(frame, "volume"),
                 *pressure = numbers(frame, "pressure"), *id = numbers(frame, "id");
    FlowParticles particles;
    for (Index p = 0; p < frame.particle("mass")->count; ++p) {
        if (!marked(marks, bed.geometry, position[3 * p], position[3 * p + 1])) continue;
        particles.x.push_back(position[3 * p]);
        particles.y.push_back(position[3 * p + 1]);
        particles.bed.push_back(position[3 * p + 2] - depth[p]);
        particles.depth.push_back(depth[p]);
        particles.vx.push_back(velocity[3 * p]);
        particles.vy.push_back(velocity[3 * p + 1]);
        particles.mass.push_back(mass[p]);
        particles.volume.push_back(volume[p]);
        particles.bed_pressure.push_back(pressure[p]);
        particles.id.push_back(id[p]);
        if (!domains.empty()) particles.domain.push_back(domains.at(static_cast<std::size_t>(p)));
    }
    take_slopes(particles, bed);
    return particles;
}

FlowParticles particles_of(const Seeds& seeds, const Scene& scene, const std::vector<std::uint8_t>& marks) {
    FlowParticles particles;
    for (std::size_t p = 0; p < seeds.x.size(); ++p) {
        if (!marks.empty() && !marked(marks, scene.bed.geometry, seeds.x[p], seeds.y[p])) continue;
        const Vec2 slope = bed_gradient(scene.bed, seeds.x[p], seeds.y[p]);
        particles.x.push_back(seeds.x[p]);
        particles.y.push_back(seeds.y[p]);
        particles.bed.push_back(bed_below(scene.bed, seeds.x[p], seeds.y[p]));
        particles.depth.push_back(seeds.depth[p]);
        particles.vx.push_back(seeds.vx[p]);
        particles.vy.push_back(seeds.vy[p]);
        particles.mass.push_back(seeds.volume[p] * scene.density);
        particles.volume.push_back(seeds.volume[p]);
        particles.bed_pressure.push_back(scene.density * scene.gravity * seeds.depth[p] / (1.0 + slope.squaredNorm()));
        particles.id.push_back(static_cast<double>(p));
    }
    take_slopes(particles, scene.bed);
    return particles;
}

namespace {

/// What a particle stands on, and how many parts lie along its edges.
struct Division {
    Mat2 domain;
    double count[2];

    double parts() const { return count[0] * count[1]; }
};

Mat2 domain_of(const FlowParticles& particles, std::size_t k, double widest) {
    Mat2 domain;
    if (!particles.domain.empty())
        domain = particles.domain[k];
    else if (particles.depth[k] > 0.0)
        domain = std::sqrt(particles.volume[k] / particles.depth[k]) * Mat2::Identity();
    else
        domain = widest * Mat2::Identity();
    for (Eigen::Index edge = 0; edge < 2; ++edge) {
        const double length = domain.col(edge).norm();
        if (length > widest) domain.col(edge) *= widest / length;
    }
    return domain;
}

Division division_of(const FlowParticles& particles, std::size_t k, double spacing, double widest) {
    constexpr double kLeast = 0.125;  // of a full point's volume
    Division division{domain_of(particles, k, widest), {}};
    const double layers = static_cast<double>(layer_count(particles.depth[k], spacing));
    const double most = particles.volume[k] / (layers * kLeast * spacing * spacing * spacing);
    double wanted[2];
    for (int edge = 0; edge < 2; ++edge)
        wanted[edge] = std::max(1.0, std::round(division.domain.col(edge).norm() / spacing));
    // Too light for so many: fewer along both edges, but one there is always.
    const double share = std::sqrt(std::min(1.0, most / (wanted[0] * wanted[1])));
    const int longer = wanted[1] > wanted[0];
    double& across = division.count[1 - longer];
    across = std::max(1.0, std::floor(share * wanted[1 - longer]));
    division.count[longer] = std::max(1.0, std::min(wanted[longer], std::floor(most / across)));
    return division;
}

}  // namespace

PartsForecast forecast_parts(const FlowParticles& particles, double spacing, double widest) {
    PartsForecast sum;
    for (std::size_t k = 0; k < particles.count(); ++k) {
        const double parts = division_of(particles, k, spacing, widest).parts();
        sum.particles += parts;
        sum.points += parts * static_cast<double>(layer_count(particles.depth[k], spacing));
    }
    return sum;
}

FlowParticles in_parts(const FlowParticles& particles, double spacing, double widest, const Raster& bed,
                       const std::array<double, 4>& extent) {
    FlowParticles parts;
    for (std::size_t k = 0; k < particles.count(); ++k) {
        const Division division = division_of(particles, k, spacing, widest);
        const double share = 1.0 / division.parts();
        const auto along = [&](int edge, Index m) {
            return (static_cast<double>(m) + 0.5) / division.count[edge] - 0.5;
        };
        for (Index j = 0; j < static_cast<Index>(division.count[1]); ++j)
            for (Index i = 0; i < static_cast<Index>(division.count[0]); ++i) {
                const Vec2 away = division.domain * Vec2(along(0, i), along(1, j));
                parts.take(particles, k);
                parts.x.back() = std::clamp(particles.x[k] + away[0], extent[0], extent[2]);
                parts.y.back() = std::clamp(particles.y[k] + away[1], extent[1], extent[3]);
                const double ground = bed_below(bed, parts.x.back(), parts.y.back());
                if (std::isfinite(ground)) parts.bed.back() = ground;
                parts.mass.back() *= share;
                parts.volume.back() *= share;
            }
    }
    take_slopes(parts, bed);
    return parts;
}

void look_ahead(FlowParticles& particles, const Raster& bed, double reach) {
    for (std::size_t k = 0; k < particles.count(); ++k) {
        const Vec2 v(particles.vx[k], particles.vy[k]);
        if (!(v.squaredNorm() > 0.0)) continue;
        const Vec2 way = v.normalized();
        const double here = way.dot(Vec2(particles.slope_x[k], particles.slope_y[k]));
        double gentlest = here;  // downhill
        for (const double far : {0.5 * reach, reach}) {
            const Vec2 x = Vec2(particles.x[k], particles.y[k]) + far * way;
            if (!std::isfinite(bed_elevation(bed, x.x(), x.y()))) break;
            gentlest = std::max(gentlest, way.dot(bed_gradient(bed, x.x(), x.y())));
        }
        particles.slope_x[k] += (gentlest - here) * way.x(), particles.slope_y[k] += (gentlest - here) * way.y();
    }
}

MovingParticles particles_of(const std::vector<DepartedPoint>& points, const Scene& scene, const ParticlesAt& at) {
    struct Sum {
        double mass = 0.0;
        Vec2 moment{0, 0}, momentum{0, 0};
        Mat2 gradient = Mat2::Zero();  // times mass
    };
    const GridGeometry& g = scene.bed.geometry;
    const double size = 0.5 * g.cell;
    std::map<std::pair<Index, Index>, Sum> quarters;  // row after row from the south
    for (const DepartedPoint& point : points) {
        const Vec2 v = point.velocity.head<2>();
        const Vec2 x = at.place(point, point.position.head<2>() + (at.time - point.time) * v);
        Sum& sum = quarters[{static_cast<Index>(std::floor((x.y() - g.y0) / size)),
                             static_cast<Index>(std::floor((x.x() - g.x0) / size))}];
        sum.mass += point.mass;
        sum.moment += point.mass * x;
        sum.momentum += point.mass * v;
        sum.gradient += point.mass * point.gradient.topLeftCorner<2, 2>();
    }
    MovingParticles particles;
    Seeds& seeds = particles.seeds;
    for (const auto& [quarter, sum] : quarters) {
        const Vec2 x = sum.moment / sum.mass, v = sum.momentum / sum.mass;
        const double volume = sum.mass / scene.density;
        seeds.x.push_back(x.x()), seeds.y.push_back(x.y());
        seeds.vx.push_back(v.x()), seeds.vy.push_back(v.y());
        seeds.volume.push_back(volume), seeds.size.push_back(size);
        seeds.depth.push_back(std::max(at.depth(x), volume / (size * size)));
        particles.gradient.push_back(sum.gradient / sum.mass);
    }
    return particles;
}

SolidSeeds seeds_of(const FlowParticles& particles, const SolidStage& stage) {
    ConversionChoice choice;
    choice.spacing = stage.spacing;
    choice.profile = stage.profile;
    choice.vertical = stage.along_bed ? Vertical::along_bed : Vertical::zero;
    const SolidPoints points = particles_to_points(particles, choice);
    SolidSeeds seeds;
    for (std::size_t k = 0; k < points.count(); ++k) {
        const double *x = &points.position[3 * k], *v = &points.velocity[3 * k];
        seeds.add({x[0], x[1], x[2]}, {v[0], v[1], v[2]}, points.mass[k], points.pressure[k]);
    }
    return seeds;
}

std::vector<std::size_t> parts_of_seeds(const FlowParticles& particles, const SolidStage& stage) {
    std::vector<std::size_t> parts;
    for (std::size_t k = 0; k < particles.count(); ++k)
        parts.insert(parts.end(), static_cast<std::size_t>(layer_count(particles.depth[k], stage.spacing)), k);
    return parts;
}

}  // namespace frana
