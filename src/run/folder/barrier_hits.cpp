#include "run/folder/barrier_hits.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"
#include "compare/overlap.h"
#include "terrain/outline_nodes.h"
#include "terrain/part_of.h"

namespace frana {
namespace {

/// Whether a direction faces each of kSides. Round-off does not decide on a diagonal.
std::array<bool, 4> sides_of(const Vec2& away) {
    constexpr double kRoundOff = 1.0 + 1e-9;
    const double x = std::abs(away.x()), y = std::abs(away.y());
    const bool upright = y > 0.0 && y * kRoundOff >= x, level = x > 0.0 && x * kRoundOff >= y;
    return {upright && away.y() > 0.0, level && away.x() > 0.0, upright && away.y() < 0.0, level && away.x() < 0.0};
}

/// The largest that was met; NaN before.
void raise(double& most, double value) {
    if (std::isfinite(value) && !(most >= value)) most = value;
}

/// The pixels around an outline as a grid of its own, and where it begins among all.
NodeBox pixels_around(const Polygons& outline, const GridGeometry& grid) {
    std::vector<Vec2> corners;
    for (const Polygon& polygon : outline.parts)
        for (const auto& ring : polygon.rings) corners.insert(corners.end(), ring.begin(), ring.end());
    return common(widened(cells_of(corners, grid), 3), NodeBox::all(grid));
}

/// Marks a pixel and its eight neighbours.
void mark_around(std::vector<char>& marks, const GridGeometry& part, Index i, Index j) {
    for (Index b = std::max<Index>(0, j - 1); b <= std::min(part.ny - 1, j + 1); ++b)
        for (Index a = std::max<Index>(0, i - 1); a <= std::min(part.nx - 1, i + 1); ++a)
            marks[static_cast<std::size_t>(b * part.nx + a)] = 1;
}

/// Pixels that it touches, nodes that it raises, and the eight neighbours of both. A node's bed is the mean around it, so that
/// the neighbours of raised nodes are raised as well. A flow that came onto one of these stands on the pixels around it.
template <class IsWet>
std::vector<char> around(const Polygons& outline, const GridGeometry& part, const IsWet& is_wet) {
    std::vector<char> marks(static_cast<std::size_t>(part.size()), 0), foot = marks;
    const std::vector<char> raised = nodes_of_outline(outline, part);
    const auto for_each_of = [&](const std::vector<char>& of, auto&& f) {
        for (Index j = 0; j < part.ny; ++j)
            for (Index i = 0; i < part.nx; ++i)
                if (of[static_cast<std::size_t>(j * part.nx + i)]) f(i, j);
    };
    for_each_of(raised, [&](Index i, Index j) { mark_around(foot, part, i, j); });
    for_each_pixel_area(part, rings_of(outline), [&](Index i, Index j, double area) {
        if (area > 0.0) mark_around(marks, part, i, j);
    });
    for_each_of(foot, [&](Index i, Index j) {
        if (is_wet(i, j))
            mark_around(marks, part, i, j);
        else
            marks[static_cast<std::size_t>(j * part.nx + i)] = 1;
    });
    return marks;
}

/// What a hit reads.
struct Fields {
    const ProductRaster *depth, *pressure, *arrival;
    const Raster* bed;
    static double at(const ProductRaster* field, Index i, Index j) {
        return field == nullptr ? BarrierHit::unknown : field->raster.at(i, j);
    }
};

void add_pixel(BarrierHit& hit, const Fields& fields, Index i, Index j, const std::vector<Vec2>& out) {
    const double depth = Fields::at(fields.depth, i, j), pressure = Fields::at(fields.pressure, i, j),
                 time = Fields::at(fields.arrival, i, j);
    if (!(depth > 0.0)) return;  // not reached
    raise(hit.depth, depth), raise(hit.pressure, pressure);
    if (std::isfinite(time) && !(hit.time <= time)) hit.time = time;
    if (std::isfinite(time) && fields.bed != nullptr) raise(hit.surface, fields.bed->at(i, j) + depth);
    for (const Vec2& way : out) {
        const std::array<bool, 4> faces = sides_of(way);
        for (std::size_t side = 0; side < kSides.size(); ++side)
            if (faces[side]) raise(hit.side_depth[side], depth), raise(hit.side_pressure[side], pressure);
    }
}

std::string cell(double value) { return std::isfinite(value) ? fmt::format(",{:.9g}", value) : ","; }

}  // namespace

BarrierHit hit_on(const Polygons& outline, const std::vector<ProductRaster>& rasters, const Raster* bed) {
    BarrierHit hit;
    if (outline.parts.empty() || rasters.empty()) return hit;
    hit.area = 0.0;
    for (const auto& ring : rings_of(outline)) hit.area += ring_area(ring);
    const GridGeometry& all = rasters.front().raster.geometry;
    const NodeBox box = pixels_around(outline, all);
    if (box.nx < 1 || box.ny < 1) return hit;
    const GridGeometry part = box.of(all);
    const Fields fields{find_product(rasters, "peak_depth"), find_product(rasters, "peak_dynamic_pressure"),
                        find_product(rasters, "arrival_time"), bed != nullptr && bed->geometry == all ? bed : nullptr};
    // A film does not make the flow beyond it one that stands here.
    const ProductRaster* const came = fields.arrival != nullptr ? fields.arrival : fields.depth;
    const std::vector<char> marks = around(
        outline, part, [&](Index i, Index j) { return std::isfinite(Fields::at(came, box.i0 + i, box.j0 + j)); });
    for (Index j = 0; j < part.ny; ++j)
        for (Index i = 0; i < part.nx; ++i)
            if (marks[static_cast<std::size_t>(j * part.nx + i)])
                add_pixel(hit, fields, box.i0 + i, box.j0 + j, out_of(outline, {part.x(i), part.y(j)}, part.cell));
    return hit;
}

std::vector<BarrierHit> hits_on(const std::vector<Barrier>& barriers, const std::vector<ProductRaster>& rasters,
                                const Raster* bed) {
    std::vector<BarrierHit> hits;
    hits.reserve(barriers.size());
    for (const Barrier& barrier : barriers) hits.push_back(hit_on(barrier.outline, rasters, bed));
    return hits;
}

void note_contacts(const std::vector<BarrierHit>& hits, std::vector<BarrierSummary>& summaries) {
    expect(hits.size() == summaries.size(), "every barrier has a hit");
    for (std::size_t n = 0; n < hits.size(); ++n) {
        BarrierSummary& summary = summaries[n];
        const BarrierHit& hit = hits[n];
        if (summary.blur > 0.0 || !std::isfinite(hit.area)) continue;
        if (std::isfinite(hit.time)) {
            summary.first_contact = hit.time;
            if (std::isnan(summary.run_up)) summary.run_up = hit.surface;
        } else if (!(summary.overtopped > 0.0)) {
            summary.run_up = BarrierHit::unknown;
        }
    }
}

bool was_hit(const BarrierSummary& barrier) {
    return barrier.first_contact >= 0.0 || barrier.peak_force > 0.0 || std::isfinite(barrier.run_up);
}

void write_barrier_table(const std::filesystem::path& csv, const std::vector<BarrierSummary>& summaries,
                         const std::vector<BarrierHit>& hits) {
    expect(hits.size() == summaries.size(), "every barrier has a hit");
    std::string text =
        "barrier,first_contact [s],peak_force [N],peak_force_mean_over [s],peak_dynamic_pressure [Pa],peak_depth [m],"
        "run_up_elevation [m],overtopped [m3],area [m2]";
    for (const char* side : kSides) text += fmt::format(",dynamic_pressure_{0} [Pa],depth_{0} [m]", side);
    text += '\n';
    for (std::size_t n = 0; n < hits.size(); ++n) {
        const BarrierSummary& s = summaries[n];
        const BarrierHit& hit = hits[n];
        const double none = BarrierHit::unknown;
        text += s.name + cell(s.first_contact >= 0.0 ? s.first_contact : none) +
                cell(s.blur > 0.0 ? s.peak_force : none) + cell(s.blur > 0.0 ? s.blur : none) + cell(hit.pressure) +
                cell(hit.depth) + cell(s.run_up) + cell(s.overtopped) + cell(hit.area);
        for (std::size_t side = 0; side < kSides.size(); ++side)
            text += cell(hit.side_pressure[side]) + cell(hit.side_depth[side]);
        text += '\n';
    }
    write_text(csv, text);
}

}  // namespace frana
