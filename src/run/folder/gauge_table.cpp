#include "run/folder/gauge_table.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/speed_counts.h"
#include "observe/table.h"

namespace frana {
namespace {

double largest(const std::vector<double>& values) {
    double most = 0.0;
    for (const double value : values) most = std::max(most, value);  // what is not a number counts as nothing
    return most;
}

/// That of a film at the flow's edge does not count, as in peak_speed.tif.
double largest_speed(const Table& series, double footprint_depth) {
    return largest(speeds_that_count(series.column("depth"), series.column("speed"), footprint_depth));
}

/// "| 12.5 s | 1.3 m | 8.2 m/s |"
std::string flow_at(const Table& series, double footprint_depth) {
    const std::vector<double>& depth = series.column("depth");
    const auto first = std::find_if(depth.begin(), depth.end(), [&](double value) { return value > footprint_depth; });
    const std::string arrival =
        first == depth.end()
            ? "not reached"
            : fmt::format("{:.4g} s", series.column("t")[static_cast<std::size_t>(first - depth.begin())]);
    return fmt::format("| {} | {:.4g} m | {:.4g} m/s |", arrival, largest(depth),
                       largest_speed(series, footprint_depth));
}

}  // namespace

std::vector<double> speeds_that_count(const std::vector<double>& depth, std::vector<double> speed,
                                      double footprint_depth) {
    for (std::size_t k = 0; k < speed.size(); ++k)
        if (!speed_counts(depth[k], footprint_depth)) speed[k] = 0.0;
    return speed;
}

std::string gauge_section(const std::vector<Gauge>& gauges, double footprint_depth, bool becomes_bed,
                          const std::filesystem::path& run_dir) {
    if (gauges.empty()) return "";
    std::string text =
        "## Gauges\n\n| Gauge | x, y | Arrival | Largest depth | Largest speed |\n|---|---|---|---|---|\n";
    for (const Gauge& gauge : gauges) {
        std::string flow = "| no series | - | - |";
        try {
            flow = flow_at(read_table(run_dir / "gauges" / (gauge.name + ".csv")), footprint_depth);
        } catch (const UserError&) {  // the run is worth more than a row of its report
        }
        text += fmt::format("| {} | {:.10g}, {:.10g} {}\n", gauge.name, gauge.point.x(), gauge.point.y(), flow);
    }
    const char* const of_flow =
        becomes_bed ? "Depths are of the flow alone; `peak_depth.tif` also has what became bed below it. " : "";
    return text + fmt::format(
                      "\nThese are values of the series in `gauges/`, which have a row for each step, interpolated "
                      "between the four nodes around the point; `rasters/` has the peaks of whole pixels, which may be "
                      "larger or smaller. {}Arrival is the first time deeper than {:.4g} m (`output.footprint_depth`). "
                      "The speed is along the bed, of what is {:.4g} m deep or more.\n\n",
                      of_flow, footprint_depth, kSpeedCounts * footprint_depth);
}

}  // namespace frana
