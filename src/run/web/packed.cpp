#include "run/web/packed.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "io/deflate.h"
#include "terrain/part_of.h"

namespace frana {
namespace {

constexpr double kCodes = 65534.0;  // from the lowest to the highest value
// Noise of speeds fills a page and tells nothing.
constexpr double kDepthSteps = 255.0, kSpeedSteps = 63.0;

GridGeometry blocks_of(const GridGeometry& fine, Index k) {
    const double shift = 0.5 * static_cast<double>(k - 1) * fine.cell;
    return {(fine.nx + k - 1) / k, (fine.ny + k - 1) / k, fine.x0 + shift, fine.y0 + shift,
            fine.cell * static_cast<double>(k)};
}

/// `join(sum so far, value, how many before it)` makes one of the values of a block.
template <class Join>
Raster joined(const Raster& raster, Index k, const Join& join) {
    if (k <= 1) return raster;
    const GridGeometry& fine = raster.geometry;
    Raster result = Raster::filled(blocks_of(fine, k), Raster::nodata);
    std::vector<double> counts(result.values.size(), 0.0);
    for (Index j = 0; j < fine.ny; ++j)
        for (Index i = 0; i < fine.nx; ++i) {
            const double value = raster.at(i, j);
            if (std::isnan(value)) continue;
            const auto block = static_cast<std::size_t>(j / k * result.geometry.nx + i / k);
            double& kept = result.values[block];
            kept = counts[block] > 0.0 ? join(kept, value, counts[block]) : value;
            counts[block] += 1.0;
        }
    return result;
}

/// The code that neighbours let expect: that of a plane through them.
std::uint16_t expected(const std::vector<std::uint16_t>& codes, Index i, Index j, Index nx) {
    const auto code = [&](Index u, Index v) {
        return u < 0 || v < 0 ? 0 : static_cast<int>(codes[static_cast<std::size_t>(v * nx + u)]);
    };
    return static_cast<std::uint16_t>(code(i - 1, j) + code(i, j - 1) - code(i - 1, j - 1));
}

/// Small differences of either sign become small numbers.
std::uint16_t folded(std::uint16_t difference) {
    const bool below = difference >= 0x8000U;
    return static_cast<std::uint16_t>(below ? 2U * (0xffffU - difference) + 1U : 2U * difference);
}
std::uint16_t unfolded(std::uint16_t kept) {
    return static_cast<std::uint16_t>((kept & 1U) != 0U ? 0xffffU - (kept >> 1U) : kept >> 1U);
}

/// Rounded up; the smallest wet value has the byte 1.
std::uint8_t byte_of(double value, double top, double steps) {
    if (!(value > 0.0) || top <= 0.0) return 0;
    return static_cast<std::uint8_t>(std::clamp(std::ceil(steps * std::sqrt(value / top)), 1.0, steps));
}
double value_of(std::uint8_t byte, double top, double steps) {
    const double share = (byte - 0.5) / steps;
    return byte == 0 ? 0.0 : top * share * share;
}

/// The nodes that are deeper than `wet`; no nodes without any.
NodeBox wet_box(const FlowFields& flow, double wet) {
    Index i0 = flow.grid.nx, j0 = flow.grid.ny, i1 = -1, j1 = -1;
    for (Index j = 0; j < flow.grid.ny; ++j)
        for (Index i = 0; i < flow.grid.nx; ++i) {
            if (!(flow.depth[j * flow.grid.nx + i] > wet)) continue;
            i0 = std::min(i0, i), i1 = std::max(i1, i), j0 = std::min(j0, j), j1 = std::max(j1, j);
        }
    return i1 < 0 ? NodeBox{} : NodeBox{i0, j0, i1 - i0 + 1, j1 - j0 + 1};
}

/// Of the nodes in a box those that are wet, in blocks.
Raster wet_part(const FlowFields& flow, const double* field, const NodeBox& box, double wet, Index k) {
    Raster part = Raster::filled(box.of(flow.grid), 0.0);
    for (Index j = 0; j < box.ny; ++j)
        for (Index i = 0; i < box.nx; ++i) {
            const Index node = (box.j0 + j) * flow.grid.nx + box.i0 + i;
            if (flow.depth[node] > wet && std::isfinite(field[node])) part.at(i, j) = field[node];
        }
    return largest_in_blocks(part, k);
}

/// Appends a byte a pixel, and tells what the last step ends at.
double add_bytes(const Raster& part, double steps, std::vector<std::uint8_t>& bytes) {
    const double top = *std::max_element(part.values.begin(), part.values.end());
    for (const double value : part.values) bytes.push_back(byte_of(value, top, steps));
    return top;
}

}  // namespace

Raster in_blocks(const Raster& raster, Index k) {
    return joined(raster, k, [](double mean, double value, double n) { return mean + (value - mean) / (n + 1.0); });
}
Raster largest_in_blocks(const Raster& raster, Index k) {
    return joined(raster, k, [](double most, double value, double) { return std::max(most, value); });
}
Index block_for(const GridGeometry& grid, Index most) {
    Index k = 1;
    while (blocks_of(grid, k).size() > most) ++k;
    return k;
}

Raster part_with_values(const Raster& raster) {
    const GridGeometry& g = raster.geometry;
    Index i0 = g.nx, j0 = g.ny, i1 = -1, j1 = -1;
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) {
            if (std::isnan(raster.at(i, j))) continue;
            i0 = std::min(i0, i), i1 = std::max(i1, i), j0 = std::min(j0, j), j1 = std::max(j1, j);
        }
    if (i1 < 0) i0 = j0 = i1 = j1 = 0;
    Raster part = Raster::filled(NodeBox{i0, j0, i1 - i0 + 1, j1 - j0 + 1}.of(g), Raster::nodata);
    for (Index j = j0; j <= j1; ++j)
        for (Index i = i0; i <= i1; ++i) part.at(i - i0, j - j0) = raster.at(i, j);
    return part;
}

PackedRaster packed(const Raster& raster, double finest) {
    PackedRaster result{raster.geometry, 0.0, finest, {}};
    double low = INFINITY, high = -INFINITY;
    for (const double value : raster.values)
        if (std::isfinite(value)) low = std::min(low, value), high = std::max(high, value);
    if (low <= high) result.low = low, result.step = std::max(finest, (high - low) / kCodes);
    const std::size_t count = raster.values.size();
    std::vector<std::uint16_t> codes(count, 0);
    for (std::size_t n = 0; n < count; ++n)
        if (std::isfinite(raster.values[n]))
            codes[n] = static_cast<std::uint16_t>(1 + std::lround((raster.values[n] - result.low) / result.step));
    std::vector<std::uint8_t> bytes(2 * count);
    const Index nx = raster.geometry.nx;
    for (Index j = 0; j < raster.geometry.ny; ++j)
        for (Index i = 0; i < nx; ++i) {
            const auto n = static_cast<std::size_t>(j * nx + i);
            const std::uint16_t kept = folded(static_cast<std::uint16_t>(codes[n] - expected(codes, i, j, nx)));
            bytes[n] = static_cast<std::uint8_t>(kept >> 8U);
            bytes[count + n] = static_cast<std::uint8_t>(kept & 0xffU);
        }
    result.bytes = deflated(bytes);
    return result;
}

Raster unpacked(const PackedRaster& from) {
    Raster raster = Raster::filled(from.grid, Raster::nodata);
    const std::size_t count = raster.values.size();
    const std::vector<std::uint8_t> bytes = inflated(from.bytes, 2 * count);
    std::vector<std::uint16_t> codes(count, 0);
    const Index nx = from.grid.nx;
    for (Index j = 0; j < from.grid.ny; ++j)
        for (Index i = 0; i < nx; ++i) {
            const auto n = static_cast<std::size_t>(j * nx + i);
            const auto kept = static_cast<std::uint16_t>(256U * bytes[n] + bytes[count + n]);
            codes[n] = static_cast<std::uint16_t>(unfolded(kept) + expected(codes, i, j, nx));
            if (codes[n] > 0) raster.values[n] = from.low + from.step * (codes[n] - 1.0);
        }
    return raster;
}

PackedFrame packed(const FlowFields& flow, double wet, Index most) {
    PackedFrame frame;
    frame.has_speed = flow.speed != nullptr;
    const NodeBox box = wet_box(flow, wet);
    const Index k = block_for(box.of(flow.grid), most);
    frame.grid = blocks_of(box.of(flow.grid), k);
    if (frame.grid.size() == 0) return frame;
    std::vector<std::uint8_t> bytes;
    frame.deepest = add_bytes(wet_part(flow, flow.depth, box, wet, k), kDepthSteps, bytes);
    if (flow.speed) frame.fastest = add_bytes(wet_part(flow, flow.speed, box, wet, k), kSpeedSteps, bytes);
    frame.bytes = deflated(bytes);
    return frame;
}

UnpackedFrame unpacked(const PackedFrame& frame) {
    UnpackedFrame result;
    const auto count = static_cast<std::size_t>(frame.grid.size());
    if (count == 0) return result;
    const std::vector<std::uint8_t> bytes = inflated(frame.bytes, frame.has_speed ? 2 * count : count);
    for (std::size_t n = 0; n < bytes.size(); ++n)
        if (n < count)
            result.depth.push_back(value_of(bytes[n], frame.deepest, kDepthSteps));
        else
            result.speed.push_back(value_of(bytes[n], frame.fastest, kSpeedSteps));
    return result;
}

}  // namespace frana
