#include "frana_fuzz_figure.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/version.h"
#include "vtk_io/figures/chart_figure.h"

namespace frana {
namespace {

/// "quadratic" of "quadratic tpic" and of "paper quadratic pic".
std::string shape_of(const fuzz::Method& method) {
    return method.shape == Shape::linear ? "linear" : method.shape == Shape::quadratic ? "quadratic" : "cubic";
}

/// The rest of the name.
std::string transfer_of(const fuzz::Method& method) {
    const std::string name = method.name();
    return (method.preset == "default" ? "" : method.preset + " ") + name.substr(name.rfind(' ') + 1);
}

Curve& curve_of(ChartPanel& panel, const std::string& name) {
    for (Curve& curve : panel.curves)
        if (curve.name == name) return curve;
    panel.curves.push_back({name, {}, {}, Curve::Kind::line, true});
    return panel.curves.back();
}

}  // namespace

void draw_cfl_map(const std::vector<fuzz::CflRow>& rows, const std::filesystem::path& png) {
    ChartFigure figure;
    figure.title = "Largest stable scheme.cfl";
    figure.x_label = "points a cell [1]";
    figure.height = 1300;
    figure.footer = "frana " FRANA_VERSION ", seven scenes of 100 steps under watch (frana stress --cfl-map)";
    for (const char* shape : {"linear", "quadratic", "cubic"}) {
        ChartPanel panel;
        panel.y_label = std::string(shape) + ", cfl [1]";
        panel.y_range = {0.0, 1.1 * fuzz::cfl_ladder().back()};
        for (const fuzz::CflRow& row : rows) {
            if (shape_of(row.method) != shape) continue;
            Curve& curve = curve_of(panel, transfer_of(row.method));
            curve.x.push_back(row.method.per_side * row.method.per_side);
            curve.y.push_back(row.largest);
        }
        if (!panel.curves.empty()) figure.panels.push_back(panel);
    }
    std::string why_not;
    if (!render_chart(figure, png, why_not)) fmt::print(stderr, "{}: no figure: {}\n", png.string(), why_not);
}

}  // namespace frana
