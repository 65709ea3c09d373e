#include "frana_verify_figure.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/version.h"
#include "checks/verify/library.h"
#include "checks/verify/peers.h"
#include "checks/verify/structured_cases.h"
#include "checks/verify/study.h"
#include "checks/verify/table.h"
#include "vtk_io/figures/chart_figure.h"
#include "vtk_io/figures/map_figure.h"

namespace frana {
namespace {

using verify::Measurement;
using verify::Problem;

struct Way {
    std::string name, preset;
    int per_side;
    double split_length;
};

/// Presets and points a cell that the figure compares.
const std::vector<Way>& ways() {
    static const std::vector<Way> all = {{"frana, 4 points a cell", "default", 2, 0.8},
                                         {"frana, 1 point a cell", "default", 1, 1.2},
                                         {"frana, float", "float", 2, 0.8},
                                         {"frana, preset paper", "paper", 2, 0.8}};
    return all;
}

/// What of a problem other codes report; the depth's L1 where none does.
std::string quantity_of(const Problem& problem) {
    for (const verify::PeerCurve& peer : verify::peers())
        if (peer.problem == problem.name) return peer.quantity;
    return "l1_depth";
}

/// The least time of `runs` runs: what else the machine does only ever adds to it.
Curve measured_curve(const Problem& problem, const Way& way, const std::string& quantity) {
    constexpr int runs = 3;
    verify::Setup setup;
    setup.preset = way.preset;
    setup.per_side = way.per_side;
    setup.edit = [&](Scene& scene) { scene.scheme.split_length = way.split_length; };
    Curve curve;
    curve.name = way.name;
    curve.marks = true;
    for (const Index cells : problem.grids) {
        double seconds = 0.0, error = verify::kNone;
        for (int run = 0; run < runs; ++run) {
            try {
                const Measurement m = verify::measure(problem, setup, {cells}).front();
                error = m.value(quantity);
                seconds = run == 0 ? m.wall_seconds : std::min(seconds, m.wall_seconds);
            } catch (const NumericsError&) {
                break;
            }
        }
        fmt::print("{:16} {:24} {:>6} {:10.3e} {:8.3f} s\n", problem.name, way.name, cells, error, seconds);
        std::fflush(stdout);
        curve.x.push_back(seconds);
        curve.y.push_back(error);
    }
    return curve;
}

}  // namespace

void draw_work_precision(std::vector<const Problem*> problems, const std::filesystem::path& png) {
    if (problems.empty())
        for (const char* name : {"similarity", "slope_dam", "thacker_period", "stoker"})
            if (const Problem* problem = verify::find_problem(name)) problems.push_back(problem);
    ChartFigure figure;
    figure.title = "Error over run time";
    figure.x_label = "wall time [s]";
    figure.log_x = true;
    figure.width = 1400;
    figure.height = 250 + 500 * static_cast<int>(problems.size());
    figure.footer = "frana " FRANA_VERSION
                    ", least of three runs; other codes measured on the same kind of machine, "
                    "relative errors on the same exact solutions";
    for (const Problem* problem : problems) {
        const std::string quantity = quantity_of(*problem);
        ChartPanel panel;
        panel.y_label = problem->name + (quantity == "l2_depth" ? ", L2 of depth [1]" : ", L1 of depth [1]");
        panel.log_y = true;
        for (const Way& way : ways()) panel.curves.push_back(measured_curve(*problem, way, quantity));
        for (const verify::PeerCurve& peer : verify::peers()) {
            if (peer.problem != problem->name) continue;
            Curve curve{peer.code, {}, {}, Curve::Kind::line, true};
            for (const verify::PeerPoint& point : peer.points) {
                curve.x.push_back(point.seconds);
                curve.y.push_back(point.error);
            }
            panel.curves.push_back(curve);
        }
        figure.panels.push_back(panel);
    }
    std::string why_not;
    if (!render_chart(figure, png, why_not)) fmt::print(stderr, "{}: no figure: {}\n", png.string(), why_not);
}

void print_study(const std::filesystem::path& table) {
    std::string text = "frana " FRANA_VERSION "\n";
    const auto line = [&](const std::string& row) {
        fmt::print("{}\n", row);
        std::fflush(stdout);
        text += row + "\n";
    };
    line(verify::study_head());
    for (const verify::Component& component : verify::components()) line(verify::study_row(component));
    if (!table.empty()) write_text(table, text);
}

bool draws_blocks(const std::vector<const Problem*>& problems) {
    for (const Problem* problem : problems)
        if (verify::shown_blocks(problem->name).empty()) return false;
    return !problems.empty();
}

namespace {

/// Bed under a block; obstacles have none.
Raster bed_of(const verify::ShownBlock& shown) {
    const GridGeometry& g = shown.scene.grid;
    Raster bed = Raster::filled(g, 0.0);
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) {
            const Vec2 at(g.x(i), g.y(j));
            bed.at(i, j) = shown.bed(at.x(), at.y());
            for (const Obstacle& o : shown.scene.obstacles)
                if ((at.array() > o.low.array()).all() && (at.array() < o.high.array()).all())
                    bed.at(i, j) = Raster::nodata;
        }
    return bed;
}

/// Where a block lies at its end, by the damage of its particles.
MapFigure block_figure(const verify::ShownBlock& shown) {
    constexpr double kShownShare = 0.05;  // of the depth at the start
    StructuredFlow flow(shown.scene);
    verify::run_structured(flow, shown.end);
    const verify::NodeMaps maps = verify::node_maps(flow);
    MapFigure figure;
    figure.bed = bed_of(shown);
    figure.field = maps.damage;
    figure.outline_field = maps.depth;
    figure.shown_above = kShownShare * shown.scene.points.depth.front();
    figure.outline_label = "depth [m]";
    figure.title = shown.title;
    figure.field_label = "damage [1]";
    figure.range = {0.0, 1.0};
    figure.footer = fmt::format("frana {}: structured particles, cells of {:g} m, {} particles, mean damage {:.3f}",
                                FRANA_VERSION, shown.scene.grid.cell, flow.status().points, flow.status().damage);
    return figure;
}

}  // namespace

void draw_blocks(const std::vector<const Problem*>& problems, const std::filesystem::path& png) {
    for (const Problem* problem : problems)
        for (const verify::ShownBlock& shown : verify::shown_blocks(problem->name)) {
            const MapFigure figure = block_figure(shown);
            const std::filesystem::path file =
                png.parent_path() / (png.stem().string() + "_" + shown.name + png.extension().string());
            std::string why_not;
            if (!render_map(figure, file, why_not)) throw UserError("no picture: " + why_not);
            fmt::print("{}\n", file.string());
        }
}

}  // namespace frana
