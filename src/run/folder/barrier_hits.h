#pragma once
// What a run did at the faces of barriers, as its rasters tell it.
#include <array>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "observe/barriers.h"
#include "run/folder/products.h"

namespace frana {

/// The sides of a barrier by the directions that they face, in the order of the arrays below.
inline constexpr std::array<const char*, 4> kSides{"north", "east", "south", "west"};

/// The flow at an outline: on pixels that it touches, nodes that it raises, and the neighbours of both, since the flow goes
/// round it. It raises those of nodes_of_outline() and, as the bed is averaged (shallow/THEORY.md section 3), the nodes
/// next to them, whose neighbours count where the flow came onto them. NaN: not reached, or not known.
struct BarrierHit {
    static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    double area = unknown;      ///< of the outline, as given [m2]
    double pressure = unknown;  ///< largest density times speed squared [Pa]
    double depth = unknown;     ///< largest [m]
    double time = unknown;      ///< first deeper than the footprint depth [s]
    double surface = unknown;   ///< highest ground with the largest depth on it, of pixels that were ever so deep [m]
    std::array<double, 4> side_pressure{unknown, unknown, unknown, unknown};  ///< [Pa]
    std::array<double, 4> side_depth{unknown, unknown, unknown, unknown};     ///< [m]
};

/// A side has pixels whose middle lies in front of one of its faces: in that direction (within 45 degrees) from the nearest
/// place of the outline. Before a face at 45 degrees they belong to both sides. What passes a corner belongs to none: it would be
/// at the lee side else. Those whose middle is on a face or behind it belong to that face: 3D points reach up to it. The
/// cost is that of the box around the outline.
/// `bed`, on the rasters' nodes, tells the surface; nullptr: that is not known.
BarrierHit hit_on(const Polygons& outline, const std::vector<ProductRaster>& rasters, const Raster* bed = nullptr);

/// Of all barriers, in their order; of those without an outline (lines, meshes) nothing is known.
std::vector<BarrierHit> hits_on(const std::vector<Barrier>& barriers, const std::vector<ProductRaster>& rasters,
                                const Raster* bed = nullptr);

/// Of those that no force is known of, the time of contact is that of their hit. Where the flow was never so deep, there
/// is no run-up. Where it was, and no particle came near, the run-up is the highest surface of the hit.
void note_contacts(const std::vector<BarrierHit>& hits, std::vector<BarrierSummary>& summaries);

/// Whether it has a contact or a force, or where a wall's contact is not known, a run-up.
bool was_hit(const BarrierSummary& barrier);

/// barriers.csv: a row for each barrier; what is not known is left empty. UserError when it cannot be written.
void write_barrier_table(const std::filesystem::path& csv, const std::vector<BarrierSummary>& summaries,
                         const std::vector<BarrierHit>& hits);

}  // namespace frana
