#include "particles/generate.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/compensated_sum.h"
#include "base/error.h"
#include "particles/lattice.h"
#include "particles/material.h"
#include "particles/scatter.h"
#include "terrain/places.h"

namespace frana {

namespace {

using Log = std::vector<std::string>;

std::vector<Material> materials_of(const std::vector<Release>& releases, const GridGeometry& grid, Reach reach) {
    std::vector<Material> materials;
    materials.reserve(releases.size());
    for (std::size_t r = 0; r < releases.size(); ++r) {
        const std::string& name = releases[r].name;
        materials.emplace_back(releases[r], grid, name.empty() ? fmt::format("release {}", r + 1) : name, reach);
    }
    return materials;
}

std::string source_of(const Release& release) {
    if (release.outline && !release.outline->source.empty()) return release.outline->source;
    return release.depth_field ? release.depth_field->source : std::string();
}

/// Twice-covered area is bearable, a ring that crosses itself is not.
void require_simple(const Material& material, const OutlineFaults& faults, double area, const GridGeometry& grid) {
    if (faults.negative <= 1e-9 * area) return;
    throw UserError(
        fmt::format("{}: the outline {} crosses itself, or a hole lies outside its polygon, near x = "
                    "{:.2f}, y = {:.2f}; repair it (ogr2ogr -makevalid)",
                    material.name(), source_of(material.release()), grid.x0 + faults.negative_at.x(),
                    grid.y0 + faults.negative_at.y()));
}

[[noreturn]] void complain_empty(const Material& material, double whole_volume, const GridGeometry& grid) {
    const Box& box = material.unclipped_box();
    // A bow tie may have no net area: its faults show on a finer grid.
    const double spacing = std::max(box.x1 - box.x0, box.y1 - box.y0) / 64.0;
    if (!box.empty())
        require_simple(material, material.integrate({spacing, box.x0, box.y0}, box, [](const PatchRow&) {}), 0.0, grid);
    const std::string where = whole_volume > 0.0
                                  ? fmt::format("it spans x {:.2f} to {:.2f}, y {:.2f} to {:.2f}", grid.x0 + box.x0,
                                                grid.x0 + box.x1, grid.y0 + box.y0, grid.y0 + box.y1)
                                  : std::string("its depth is nowhere above zero");
    const std::string source = source_of(material.release());
    throw UserError(fmt::format(
        "{}: no material of {} on the grid: {}, the grid spans x {:.2f} to {:.2f}, y {:.2f} "
        "to {:.2f}; check outline, depth, CRS and terrain.window",
        material.name(), source.empty() ? "the release" : source, where, grid.x0, grid.x_max(), grid.y0, grid.y_max()));
}

/// Volume and area on the grid, and what lies beyond it.
ReleaseReport measured(const Material& material, const GridGeometry& grid, Log& log) {
    ReleaseReport report;
    const MaterialTotals inside = material.totals(material.box());
    const MaterialTotals whole = material.totals(material.unclipped_box());
    if (!(inside.volume > 0.0)) complain_empty(material, whole.volume, grid);
    report.volume = inside.volume;
    report.area = inside.area;
    const double all = whole.volume + material.release().left_out;
    report.clipped_volume = std::max(0.0, all - inside.volume);
    if (report.clipped_volume > 1e-9 * report.volume)
        log.push_back(fmt::format("{}: {:.6g} m3 ({:.3g} % of it) lie beyond the outer {} of the grid and are left out",
                                  material.name(), report.clipped_volume, 100.0 * report.clipped_volume / all,
                                  material.reach() == Reach::nodes ? "nodes" : "pixels"));
    return report;
}

/// An outline that reaches beyond the material of its depth field is worth a remark.
void remark_bare_outline(const Material& material, const ReleaseReport& report, const GridGeometry& grid, Log& log) {
    const Release& release = material.release();
    if (!release.outline || !release.depth_field) return;
    Release bare;
    bare.outline = release.outline;
    bare.depth = 1.0;
    const Material outline(bare, grid, material.name(), material.reach());
    const double area = outline.totals(outline.box()).area;
    if (report.area < 0.999 * area)
        log.push_back(fmt::format("{}: {:.3g} % of its outline has no depth in {}", material.name(),
                                  100.0 * (1.0 - report.area / area), release.depth_field->source));
}

/// Value of a raster's pixel at a map point; nothing without one.
std::optional<double> pixel_under(const Raster& raster, double x, double y) {
    const Index pixel = pixel_of(raster.geometry, x, y);
    if (pixel < 0) return {};
    const double value = raster.values[static_cast<std::size_t>(pixel)];
    if (!std::isfinite(value)) return {};
    return value;
}

/// Particles from `begin` on get the pixels they are in. Those without one keep what they have: a remark.
void take_pixels(const std::optional<Raster>& raster, const Material& material, const char* way, const Seeds& seeds,
                 std::size_t begin, std::vector<double>& speeds, Log& log) {
    if (!raster) return;
    Index without = 0;
    for (std::size_t p = begin; p < seeds.x.size(); ++p) {
        const std::optional<double> speed = pixel_under(*raster, seeds.x[p], seeds.y[p]);
        if (speed)
            speeds[p] = *speed;
        else
            ++without;
    }
    if (without > 0)
        log.push_back(
            fmt::format("{}: found no data of the velocity to the {} for {} of {} particles, taken as a velocity "
                        "of 0; expected one for each; fill the gaps of {}",
                        material.name(), way, without, seeds.x.size() - begin,
                        raster->source.empty() ? "its raster" : raster->source));
}

void set_velocity(const Material& material, std::size_t begin, Seeds& seeds, Log& log) {
    const Release& release = material.release();
    seeds.vx.resize(seeds.x.size(), release.velocity.x());
    seeds.vy.resize(seeds.x.size(), release.velocity.y());
    take_pixels(release.velocity_x, material, "east", seeds, begin, seeds.vx, log);
    take_pixels(release.velocity_y, material, "north", seeds, begin, seeds.vy, log);
}

/// `total` shared out in proportion to the areas, largest remainders first, at least one each.
std::vector<Index> shares(Index total, const std::vector<ReleaseReport>& reports) {
    double area = 0.0;
    for (const ReleaseReport& report : reports) area += report.area;
    std::vector<Index> counts;
    std::vector<std::pair<double, std::size_t>> remainders;
    Index left = total;
    for (std::size_t r = 0; r < reports.size(); ++r) {
        const double share = static_cast<double>(total) * reports[r].area / area;
        counts.push_back(std::max<Index>(1, static_cast<Index>(share)));
        remainders.emplace_back(static_cast<double>(counts.back()) - share, r);
        left -= counts.back();
    }
    std::sort(remainders.begin(), remainders.end());
    for (std::size_t k = 0; left > 0; k = (k + 1) % remainders.size(), --left) ++counts[remainders[k].second];
    for (; left < 0; ++left) --*std::max_element(counts.begin(), counts.end());
    return counts;
}

/// Where parts of the outline overlap, area and volume are those that the patches counted, once.
void judge(const Material& material, const OutlineFaults& faults, const GridGeometry& grid, const Seeds& seeds,
           std::size_t begin, ReleaseReport& report, Log& log) {
    require_simple(material, faults, report.area, grid);
    if (faults.overlap <= 1e-9 * report.area) return;
    log.push_back(fmt::format("{}: parts of the outline {} overlap on {:.6g} m2, which is counted once",
                              material.name(), source_of(material.release()), faults.overlap));
    report.area = 0.0;
    for (std::size_t p = begin; p < seeds.x.size(); ++p) report.area += seeds.volume[p] / seeds.depth[p];
    report.volume = report.particle_volume;
}

void check(const std::vector<Release>& releases, const Raster& bed, const ParticleOptions& options) {
    if (releases.empty()) throw UserError("release: none is given; a case needs at least one [[release]]");
    expect(bed.geometry.nx >= 2 && bed.geometry.ny >= 2, "the bed needs at least 2 x 2 nodes");
    expect(static_cast<Index>(bed.values.size()) == bed.geometry.size(), "the bed has one value per node");
    if (options.count && *options.count < static_cast<Index>(releases.size()))
        throw UserError(fmt::format("particles.count: {} for {} releases; give at least one particle each",
                                    *options.count, releases.size()));
    if (!options.count && !(options.per_cell > 0.0))
        throw UserError(fmt::format("particles.per_cell: {}; must be above zero", options.per_cell));
}

}  // namespace

double volume_of(const std::vector<Release>& releases, const GridGeometry& grid) {
    double sum = 0.0;
    Log said_later;
    for (const Material& material : materials_of(releases, grid, Reach::nodes))
        sum += measured(material, grid, said_later).volume;
    return sum;
}

Seeds make_seeds(const std::vector<Release>& releases, const Raster& bed, const ParticleOptions& options,
                 std::vector<ReleaseReport>& reports, std::vector<std::string>& log) {
    check(releases, bed, options);
    const GridGeometry& grid = bed.geometry;
    const std::vector<Material> materials = materials_of(releases, grid, options.reach);
    reports.clear();
    double area = 0.0;
    for (const Material& material : materials) {
        reports.push_back(measured(material, grid, log));
        remark_bare_outline(material, reports.back(), grid, log);
        area += reports.back().area;
    }
    const auto by_cell = static_cast<Index>(std::ceil(options.per_cell * area / (grid.cell * grid.cell)));
    const Index wanted = options.count.value_or(std::max(by_cell, static_cast<Index>(releases.size())));

    const bool on_lattice = options.placement == Placement::lattice;
    Lattice lattice{grid.cell / std::sqrt(options.per_cell), 0.0, 0.0};
    if (on_lattice && options.count) lattice = lattice_of_count(materials, grid.cell, area, wanted, log);
    const std::vector<Index> counts = shares(wanted, reports);
    const Density density = options.placement == Placement::slope ? Density::steepness : Density::even;

    Seeds seeds;
    for (std::size_t r = 0; r < materials.size(); ++r) {
        ReleaseReport& report = reports[r];
        const std::size_t begin = seeds.x.size();
        const OutlineFaults faults = on_lattice
                                         ? place_on_lattice(materials[r], lattice, bed, seeds)
                                         : place_scattered(materials[r], counts[r], report.area, density, bed, seeds);
        set_velocity(materials[r], begin, seeds, log);
        CompensatedSum volume;
        for (std::size_t p = begin; p < seeds.x.size(); ++p) volume.add(seeds.volume[p]);
        report.particle_volume = volume.value();
        report.count = static_cast<Index>(seeds.x.size() - begin);
        report.spacing = on_lattice ? lattice.spacing : std::sqrt(report.area / static_cast<double>(report.count));
        judge(materials[r], faults, grid, seeds, begin, report, log);
        report.relative_error = std::abs(report.particle_volume - report.volume) / report.volume;
    }
    return seeds;
}

std::string conservation_table(const std::vector<ReleaseReport>& reports) {
    std::string text = fmt::format("{:<8} {:>10} {:>14} {:>16} {:>16} {:>9} {:>12}\n", "release", "particles",
                                   "area [m2]", "volume [m3]", "particles [m3]", "error", "spacing [m]");
    ReleaseReport sum;
    for (std::size_t r = 0; r < reports.size(); ++r) {
        const ReleaseReport& one = reports[r];
        text += fmt::format("{:<8} {:>10} {:>14.6g} {:>16.9g} {:>16.9g} {:>9.1e} {:>12.5g}\n", r, one.count, one.area,
                            one.volume, one.particle_volume, one.relative_error, one.spacing);
        sum.count += one.count;
        sum.area += one.area;
        sum.volume += one.volume;
        sum.particle_volume += one.particle_volume;
    }
    if (reports.size() < 2) return text;
    const double error = std::abs(sum.particle_volume - sum.volume) / sum.volume;
    return text + fmt::format("{:<8} {:>10} {:>14.6g} {:>16.9g} {:>16.9g} {:>9.1e}\n", "all", sum.count, sum.area,
                              sum.volume, sum.particle_volume, error);
}

}  // namespace frana
