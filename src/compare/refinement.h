#pragma once
// One case on several cells: how far its answers agree, and which cell is enough.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "terrain/raster.h"

namespace frana {

/// What a run on one cell says. NaN: not known.
struct CellFigures {
    double cell = 0.0;                             ///< [m]
    double runout = 0.0;                           ///< horizontal, along the path that all runs share [m]
    double reach = 0.0;                            ///< straight from the path's start to the farthest point [m]
    double footprint_area = 0.0;                   ///< [m2]
    double deposit_area = 0.0;                     ///< [m2]
    double deposit_volume = 0.0;                   ///< [m3]
    double peak_depth = 0.0, largest_depth = 0.0;  ///< 99.9 % of the footprint is less deep, and the maximum [m]
    double peak_speed = 0.0, largest_speed = 0.0;  ///< the same of the speed [m/s]
    double eroded_volume = Raster::nodata;         ///< missing of the bed at the end; of an erodible one [m3]
    double deposited_volume = Raster::nodata;      ///< lying behind as bed; where something can [m3]
    double iou = 1.0;                              ///< of its footprint with the finest one
    double elsewhere = 0.0;     ///< share of its deposit's volume that lies elsewhere than the finest one
    double cells_across = 0.0;  ///< the flow's median width
    double seconds = 0.0;       ///< wall time
};

/// The value that a share of the nodes deeper than `limit` stays at or below; NaN where there are none.
double covered_quantile(const Raster& values, const Raster& depth, double limit, double share);

/// Area in both footprints over the area in either. The pixels are overlaid as they lie; their grids need not agree.
double footprints_iou(const Raster& depth, const Raster& finest, double limit);

/// Share of a deposit's volume that would have to move to lie as the finest one does: 1 - sum of min / sum. Both are
/// counted in the finest one's pixels, into which the deposit is summed exactly. NaN without a deposit.
double share_elsewhere(const Raster& deposit, const Raster& finest);

/// Order p of value = exact + constant cell^p through three cells, coarse to fine. Nothing where it has no meaning.
/// Then differences change sign, or do not shrink as any order has them shrink. Or they are no larger than `resolution`
/// [as value], to which the coarser values are known.
std::optional<double> observed_order(const std::array<double, 3>& cells, const std::array<double, 3>& values,
                                     double resolution);

/// When a coarser cell gives the finest one's answer.
struct ConvergenceRule {
    double runout_cells = 1.0;  ///< runouts differ by at most so many of the coarser cell
    double iou = 0.9;           ///< of the footprints, at least
    double elsewhere = 0.1;     ///< of the deposit's volume, at most
    double peaks = 0.05;        ///< 99.9th percentiles of depth and speed differ by at most this share
    double eroded = 0.1;        ///< volumes taken of an erodible bed differ by at most this share
    std::string text() const;   ///< for people
};

/// Difference between the farthest and the shortest runout, in cells; NaN where one is not known.
double runout_spread(const std::vector<CellFigures>& runs);

/// How far runs on one cell lie apart that differ in the `values` of a key only. It is compared with the rule of
/// agreeing cells.
std::string spread_sentence(const std::string& key, const std::vector<double>& values,
                            const std::vector<CellFigures>& runs, const ConvergenceRule& rule = {});

struct Verdict {
    bool converged = false;
    std::optional<double> enough;  ///< the coarsest cell that agrees with the finest, as all cells between do [m]
    std::string sentence;
};

/// `runs`: two or more, coarse to fine. Converged: the last but one agrees with the finest.
Verdict judge(const std::vector<CellFigures>& runs, const ConvergenceRule& rule = {});

}  // namespace frana
