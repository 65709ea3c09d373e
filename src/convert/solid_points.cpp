#include "convert/solid_points.h"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <new>

#include "base/error.h"

namespace frana {
namespace {

void require_valid(const FlowColumns& columns, const ConversionChoice& choice) {
    require_spacing(choice.spacing);
    const std::size_t n = columns.count();
    for (const auto* numbers :
         {&columns.y, &columns.bed, &columns.depth, &columns.slope_x, &columns.slope_y, &columns.vx, &columns.vy,
          &columns.mass, &columns.volume, &columns.bed_pressure, &columns.id})
        expect(numbers->size() == n, "the columns' arrays have equal lengths");
    expect(columns.stress.empty() || columns.stress.size() == 3 * n, "every column has a stress, or none has");
}

void make_room(SolidPoints& points, std::size_t count) {
    points.position.resize(3 * count);
    points.velocity.resize(3 * count);
    points.stress.resize(6 * count);
    for (auto* numbers : {&points.mass, &points.volume, &points.pressure, &points.column, &points.height})
        numbers->resize(count);
}

/// The layers of column p.
void fill_column(const FlowColumns& columns, std::size_t p, const ConversionChoice& choice, SolidPoints& points) {
    const auto count = static_cast<Index>(points.first[p + 1] - points.first[p]);
    const std::vector<double> heights = layer_heights(choice.layers, count);
    const std::vector<double> speeds = layer_speeds(choice.profile, heights);
    const double share = 1.0 / static_cast<double>(count), depth = columns.depth[p];
    const double climb = choice.vertical == Vertical::along_bed
                             ? columns.vx[p] * columns.slope_x[p] + columns.vy[p] * columns.slope_y[p]
                             : 0.0;
    std::array<double, 3> sigma{};
    if (!columns.stress.empty())
        for (std::size_t c = 0; c < 3; ++c) sigma[c] = columns.stress[3 * p + c];
    for (std::size_t i = 0; i < heights.size(); ++i) {
        const std::size_t k = points.first[p] + i;
        const double pressure = columns.bed_pressure[p] * (1.0 - heights[i]);
        const double place[3] = {columns.x[p], columns.y[p], columns.bed[p] + heights[i] * depth};
        const double velocity[3] = {columns.vx[p] * speeds[i], columns.vy[p] * speeds[i], climb * speeds[i]};
        const double stress[6] = {
            sigma[0] - pressure, sigma[1] - pressure, -sigma[0] - sigma[1] - pressure, sigma[2], 0.0, 0.0};
        std::copy(place, place + 3, &points.position[3 * k]);
        std::copy(velocity, velocity + 3, &points.velocity[3 * k]);
        std::copy(stress, stress + 6, &points.stress[6 * k]);
        points.mass[k] = columns.mass[p] * share;
        points.volume[k] = columns.volume[p] * share;
        points.pressure[k] = pressure;
        points.column[k] = columns.id[p];
        points.height[k] = depth * share;
    }
}

}  // namespace

void require_spacing(double spacing) {
    if (!(spacing > 0.0 && std::isfinite(spacing)))
        throw UserError(fmt::format(
            "--spacing: found {}; expected a distance above 0 in metres; give the size of the 3D points", spacing));
}

FlowColumns columns_within(const FlowColumns& columns, const std::array<double, 4>& window) {
    FlowColumns inside;
    for (std::size_t p = 0; p < columns.count(); ++p)
        if (columns.x[p] >= window[0] && columns.x[p] < window[2] && columns.y[p] >= window[1] &&
            columns.y[p] < window[3])
            inside.take(columns, p);
    return inside;
}

double forecast_points(const FlowColumns& columns, double spacing) {
    double count = 0.0;
    for (const double depth : columns.depth) count += static_cast<double>(layer_count(depth, spacing));
    return count;
}

SolidPoints columns_to_points(const FlowColumns& columns, const ConversionChoice& choice) {
    require_valid(columns, choice);
    SolidPoints points;
    points.first.reserve(columns.count() + 1);
    points.first.push_back(0);
    for (const double depth : columns.depth)
        points.first.push_back(points.first.back() + static_cast<std::size_t>(layer_count(depth, choice.spacing)));
    make_room(points, points.first.back());
    std::atomic<bool> short_of_memory{false};  // no exception may leave the loop
#pragma omp parallel for schedule(static)
    for (std::size_t p = 0; p < columns.count(); ++p) {
        try {
            fill_column(columns, p, choice, points);
        } catch (const std::bad_alloc&) {
            short_of_memory = true;
        }
    }
    if (short_of_memory) throw std::bad_alloc();
    return points;
}

}  // namespace frana
