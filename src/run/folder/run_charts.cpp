#include "run/folder/run_charts.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "observe/table.h"
#include "run/folder/gauge_table.h"
#include "run/folder/run_film.h"
#include "vtk_io/figures/chart_figure.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

using Column = std::vector<double>;

ChartFigure chart(const FigureSource& source, const std::string& what, const std::string& x_label) {
    ChartFigure figure;
    figure.title = fmt::format("{}: {}", source.title, what);
    figure.x_label = x_label;
    figure.footer = source.footer;
    figure.width = source.width;
    figure.height = std::max(source.width * 3 / 5, 300);
    return figure;
}

/// Every n-th value, and the last: a picture has no use for more points than pixels.
Column thinned(const Column& values) {
    constexpr std::size_t most = 2000;
    const std::size_t stride = values.size() / most + 1;
    Column result;
    for (std::size_t i = 0; i < values.size(); i += stride) result.push_back(values[i]);
    if (!values.empty() && (values.size() - 1) % stride != 0) result.push_back(values.back());
    return result;
}

Curve curve(const std::string& name, const Column& x, const Column& y) { return {name, thinned(x), thinned(y), {}}; }

/// First row of every output of a profile's table, and one past the end.
std::vector<std::size_t> outputs_of(const Column& t) {
    std::vector<std::size_t> starts;
    for (std::size_t i = 0; i < t.size(); ++i)
        if (i == 0 || t[i] != t[i - 1]) starts.push_back(i);
    starts.push_back(t.size());
    return starts;
}

/// Outputs to be shown: first, last, and the one nearest to `time` or two between.
std::vector<std::size_t> moments(const Column& t, const std::vector<std::size_t>& starts, std::optional<double> time) {
    const std::size_t last = starts.size() - 2;
    std::vector<std::size_t> chosen = {0, last / 3, 2 * last / 3, last};
    if (time) {
        const auto nearer = [&](std::size_t a, std::size_t b) {
            return std::abs(t[a] - *time) < std::abs(t[b] - *time);
        };
        const auto nearest = std::min_element(starts.begin(), starts.end() - 1, nearer);
        chosen = {0, static_cast<std::size_t>(nearest - starts.begin()), last};
    }
    std::sort(chosen.begin(), chosen.end());
    chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
    return chosen;
}

/// Tables of gauges and profiles have the flow, while maps show what has become bed as well.
const char* depth_label(const FigureSource& source) {
    return shows_bed(source) ? "depth of flow alone [m]" : "depth [m]";
}

std::string without_bed(const FigureSource& source) {
    return shows_bed(source) ? ", of the flow without what has become bed" : "";
}

Column part(const Column& values, std::size_t begin, std::size_t end) {
    return Column(values.begin() + static_cast<std::ptrdiff_t>(begin),
                  values.begin() + static_cast<std::ptrdiff_t>(end));
}

ChartFigure profile_chart(const FigureSource& source, const std::string& name, const Table& table) {
    const Column &t = table.column("t"), &distance = table.column("distance");
    const std::vector<std::size_t> starts = outputs_of(t);
    ChartFigure figure = chart(source, "profile " + name, "distance along the line [m]");
    figure.height = std::max(source.width * 4 / 5, 300);
    ChartPanel ground{"elevation [m]", {}, false, {}, 1.4}, depth{depth_label(source), {}, false, {}, 1.0},
        speed{"velocity along [m/s]", {}, false, {}, 1.0};
    const Column x = part(distance, 0, starts[1]);
    ground.curves.push_back({"bed", x, part(table.column("bed"), 0, starts[1]), Curve::Kind::ground});
    for (const std::size_t k : moments(t, starts, source.time)) {
        const std::string label = fmt::format("t = {:.4g} s", t[starts[k]]);
        const auto add = [&](ChartPanel& panel, const char* column) {
            panel.curves.push_back({label, x, part(table.column(column), starts[k], starts[k + 1]), Curve::Kind::line});
        };
        add(ground, "surface");
        add(depth, "depth");
        add(speed, "velocity_along");
    }
    figure.panels = {ground, depth, speed};
    return figure;
}

Column relative_to_start(const Column& values) {
    Column result = values;
    for (double& value : result) value -= values.front();
    return result;
}

/// Sizes for a logarithmic axis; what is zero stands at the lower edge, below round-off.
Column sizes(const Column& values) {
    Column result = values;
    for (double& value : result) value = std::max(std::abs(value), 1e-17);
    return result;
}

bool has_column(const Table& table, const std::string& name) {  // a run of an older version has fewer
    return std::find(table.columns.begin(), table.columns.end(), name) != table.columns.end();
}

bool has_values(const Table& table, const std::string& name) {
    if (!has_column(table, name)) return false;
    const Column& values = table.column(name);
    return std::any_of(values.begin(), values.end(), [](double value) { return value != 0.0; });
}

bool has_finite(const Table& table, const std::string& name) {
    const Column& values = table.column(name);
    return std::any_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

/// What the flow got from the bed: all that the other parts have more than the residual (observe/budget.h).
Column energy_of_bed(const Table& history) {
    Column sum(history.column("t").size(), 0.0);
    const auto add = [&](const char* name, double sign) {
        const Column values = relative_to_start(history.column(name));
        for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += sign * values[k];
    };
    for (const char* part : {"kinetic", "potential", "stored", "dissipated", "energy_left"}) add(part, 1.0);
    add("energy_residual", -1.0);
    return sum;
}

ChartFigure energy_chart(const FigureSource& source, const Table& history) {
    const Column& t = history.column("t");
    ChartFigure figure = chart(source, "energy", "time [s]");
    ChartPanel energy{"energy [J]", {}, false, {}, 1.0};
    const bool comes_in = has_values(history, "mass_in");
    energy.curves = {
        curve("kinetic", t, history.column("kinetic")),
        curve("potential, from the start", t, relative_to_start(history.column("potential"))),
        curve("dissipated", t, history.column("dissipated")),
        curve(comes_in ? "left the domain less what came in" : "left the domain", t, history.column("energy_left")),
        curve("residual", t, history.column("energy_residual"))};
    if (has_values(history, "eroded_mass") || has_values(history, "deposited_mass"))
        energy.curves.push_back(curve("got from the bed", t, energy_of_bed(history)));
    // Where points are, what they hold and how they lost it: parts of "dissipated".
    const std::vector<std::pair<const char*, const char*>> in_3d = {{"stored in points", "stored"},
                                                                    {"points' friction", "points_friction"},
                                                                    {"lost to walls", "points_walls"},
                                                                    {"lost in the material", "points_material"},
                                                                    {"lost by the scheme", "points_numerical"}};
    ChartPanel points{"energy of points [J]", {}, false, {}, 1.0};
    bool any = false;
    for (const auto& [name, column] : in_3d) {
        if (!has_column(history, column)) continue;
        const Column& values = history.column(column);
        any = any || std::any_of(values.begin(), values.end(), [](double value) { return value != 0.0; });
        points.curves.push_back(curve(name, t, values));
    }
    figure.panels = {energy};
    if (any) figure.panels.push_back(points);
    return figure;
}

ChartFigure motion_chart(const FigureSource& source, const Table& history) {
    const Column& t = history.column("t");
    ChartFigure figure = chart(source, "motion and balances", "time [s]");
    figure.height = std::max(source.width * 4 / 5, 300);
    ChartPanel speed{"speed [m/s]", {}, false, {}, 1.0}, front{"front [m]", {}, false, {}, 1.0},
        errors{"relative error [1]", {}, true, {}, 1.0};
    speed.curves = {curve("fastest, along the bed", t, history.column("max_speed")),
                    curve("mean", t, history.column("mean_speed"))};
    front.curves = {curve("from " + source.front_origin, t, history.column("front"))};
    errors.curves = {curve("mass", t, sizes(history.column("mass_error"))),
                     curve("mass, particles to grid", t, sizes(history.column("p2g_mass_error"))),
                     curve("momentum, particles to grid", t, sizes(history.column("p2g_momentum_error")))};
    figure.panels = {speed, front};
    constexpr double round_off = 1e-12;  // errors below it are no picture's worth
    for (const Curve& curve : errors.curves)
        if (std::any_of(curve.y.begin(), curve.y.end(), [](double value) { return value > round_off; })) {
            figure.panels.push_back(errors);
            break;
        }
    return figure;
}

ChartFigure gauge_chart(const FigureSource& source) {
    ChartFigure figure = chart(source, "gauges", "time [s]");
    ChartPanel depth{depth_label(source), {}, false, {}, 1.0}, speed{"speed [m/s]", {}, false, {}, 1.0};
    for (const Gauge& gauge : source.gauges) {
        const Table table = read_table(source.run_dir / "gauges" / (gauge.name + ".csv"));
        depth.curves.push_back(curve(gauge.name, table.column("t"), table.column("depth")));
        speed.curves.push_back(
            curve(gauge.name, table.column("t"),
                  speeds_that_count(table.column("depth"), table.column("speed"), source.footprint_depth)));
    }
    figure.panels = {depth, speed};
    return figure;
}

ChartFigure section_chart(const FigureSource& source) {
    ChartFigure figure = chart(source, "sections", "time [s]");
    ChartPanel discharge{"discharge [m3/s]", {}, false, {}, 1.4}, volume{"volume passed [m3]", {}, false, {}, 1.0};
    for (const Section& section : source.sections) {
        const Table table = read_table(source.run_dir / "sections" / (section.name + ".csv"));
        discharge.curves.push_back(curve(section.name, table.column("t"), table.column("discharge")));
        volume.curves.push_back(curve(section.name, table.column("t"), table.column("volume")));
    }
    figure.panels = {discharge, volume};
    return figure;
}

/// From zero on, unless the values begin far from it. Tables have a row for each step, and none for what is before.
std::optional<std::pair<double, double>> from_zero(const Column& x) {
    constexpr double kFar = 0.35;  // of the axis, as for heights in chart_figure.cpp
    if (x.empty() || !(x.back() > 0.0) || !(x.front() > 0.0) || x.front() > kFar * x.back()) return std::nullopt;
    return std::pair(0.0, x.back());
}

ChartFigure bed_change_chart(const FigureSource& source, const Table& table) {
    ChartFigure figure = chart(source, "change of the ground along the path", "distance along the path [m]");
    figure.height = std::max(source.width * 4 / 5, 300);
    const Column& distance = table.column("distance");
    figure.x_range = from_zero(distance);
    const double step = distance.size() > 1 ? distance[1] - distance[0] : 0.0;
    const std::string of = step > 0.0 ? fmt::format(" per {:.4g} m", step) : "";
    ChartPanel eroded{"eroded" + of + " [m3]", {}, false, {}, 1.0},
        deposited{"deposited" + of + " [m3]", {}, false, {}, 1.0},
        balance{"deposited less eroded so far [m3]", {}, false, {}, 1.4};
    for (const std::string whose : {"simulated", "surveyed"}) {
        eroded.curves.push_back(curve(whose, distance, table.column(whose + "_eroded")));
        deposited.curves.push_back(curve(whose, distance, table.column(whose + "_deposited")));
        balance.curves.push_back(curve(whose, distance, table.column(whose + "_balance")));
    }
    figure.panels = {eroded, deposited, balance};
    return figure;
}

ChartFigure barrier_chart(const FigureSource& source, const std::string& name, const Table& table) {
    ChartFigure figure = chart(source, "barrier " + name, "time [s]");
    figure.height = std::max(source.width * 4 / 5, 300);
    const Column& t = table.column("t");
    figure.x_range = from_zero(t);
    ChartPanel mean{"force [N]", {}, false, {}, 1.4}, parts{"force of a step [N]", {}, false, {}, 1.0},
        up{"elevation [m]", {}, false, {}, 0.7}, over{"over it [m3]", {}, false, {}, 0.7};
    up.curves = {curve("run-up, highest so far", t, table.column("run_up"))};
    over.curves = {curve("volume that was over it", t, table.column("overtopped"))};
    if (has_finite(table, "run_up")) figure.panels.push_back(up);
    if (has_values(table, "overtopped")) figure.panels.push_back(over);
    if (!table.has("fx")) return figure;  // particles alone: no forces
    const auto over_s = source.mean_over.find(name);
    const std::string of = over_s == source.mean_over.end() ? "" : fmt::format(" over {:.3g} s", over_s->second);
    mean.curves = {curve("horizontal, mean" + of, t, table.column("mean_force"))};
    parts.curves = {curve("east", t, table.column("fx")), curve("north", t, table.column("fy")),
                    curve("up", t, table.column("fz"))};
    figure.panels.insert(figure.panels.begin(), {mean, parts});
    return figure;
}

/// Whether a table has rows, and nothing in them but the time.
bool says_nothing(const Table& table) {
    for (const std::string& name : table.columns) {
        if (name == "t") continue;
        const Column& values = table.column(name);
        if (std::any_of(values.begin(), values.end(),
                        [](double value) { return std::isfinite(value) && value != 0.0; }))
            return false;
    }
    return table.rows() > 0;
}

}  // namespace

void add_profile(const FigureSource& source, const std::string& name, Gallery& gallery) {
    gallery.add({fmt::format("figures/profile_{}.png", name), fmt::format("profile {}{}", name, without_bed(source))},
                [&source, name](const fs::path& png, std::string& why_not) {
                    const Table table = read_table(source.run_dir / "profiles" / (name + ".csv"));
                    if (table.rows() == 0) {
                        why_not = "its table has no rows";
                        return false;
                    }
                    return render_chart(profile_chart(source, name, table), png, why_not);
                });
}

void add_gauges(const FigureSource& source, Gallery& gallery) {
    if (source.gauges.empty()) return;
    gallery.add({"figures/gauges_flow.png", "depth and speed at the gauges" + without_bed(source)},
                [&source](const fs::path& png, std::string& why_not) {
                    return render_chart(gauge_chart(source), png, why_not);
                });
}

void add_sections(const FigureSource& source, Gallery& gallery) {
    const fs::path folder = source.run_dir / "sections";
    const auto empty = [&](const Section& section) {
        const fs::path table = folder / (section.name + ".csv");
        std::error_code none;
        return fs::exists(table, none) && says_nothing(read_table(table));  // a picture of axes alone
    };
    if (std::all_of(source.sections.begin(), source.sections.end(), empty)) return;
    gallery.add({"figures/sections_discharge.png", "discharge through the sections, and the volume that passed"},
                [&source](const fs::path& png, std::string& why_not) {
                    return render_chart(section_chart(source), png, why_not);
                });
}

void add_bed_change(const FigureSource& source, Gallery& gallery) {
    const fs::path file = source.run_dir / (source.comparison + "_bed_change.csv");
    std::error_code none;
    if (!fs::exists(file, none)) return;
    gallery.add({fmt::format("figures/{}_bed_change.png", source.comparison),
                 "change of the ground along the path, simulated and surveyed: volumes in "
                 "steps of equal length"},
                [&source, file](const fs::path& png, std::string& why_not) {
                    return render_chart(bed_change_chart(source, read_table(file)), png, why_not);
                });
}

void add_barriers(const FigureSource& source, Gallery& gallery) {
    std::vector<fs::path> tables;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(source.run_dir / "barriers", none))
        if (entry.path().extension() == ".csv") tables.push_back(entry.path());
    std::sort(tables.begin(), tables.end());
    for (const fs::path& file : tables) {
        const std::string name = file.stem().string();
        const auto& not_hit = source.never_hit;
        if (std::find(not_hit.begin(), not_hit.end(), name) != not_hit.end()) continue;
        if (says_nothing(read_table(file))) continue;  // a picture of axes alone
        gallery.add({fmt::format("figures/barrier_{}.png", name), fmt::format("barrier {}", name)},
                    [&source, name, file](const fs::path& png, std::string& why_not) {
                        const Table table = read_table(file);
                        if (table.rows() == 0) {
                            why_not = "its table has no rows";
                            return false;
                        }
                        return render_chart(barrier_chart(source, name, table), png, why_not);
                    });
    }
}

void add_budgets(const FigureSource& source, Gallery& gallery) {
    const auto draw = [&](const DrawnFigure& figure, ChartFigure (*chart_of)(const FigureSource&, const Table&)) {
        gallery.add(figure, [&source, chart_of](const fs::path& png, std::string& why_not) {
            const Table history = read_table(source.run_dir / "history.csv");
            if (history.rows() == 0) {
                why_not = "history.csv has no rows";
                return false;
            }
            return render_chart(chart_of(source, history), png, why_not);
        });
    };
    draw({"figures/budget_energy.png", "energy over time"}, energy_chart);
    draw({"figures/budget_motion.png", "speed, front and balances over time"}, motion_chart);
}

}  // namespace frana
