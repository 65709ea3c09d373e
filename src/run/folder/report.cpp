// report.md and the closing lines: the run for people.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/constants.h"
#include "base/speed_counts.h"
#include "base/version.h"
#include "run/folder/comparison.h"
#include "run/folder/gauge_table.h"
#include "run/folder/left_terrain.h"
#include "run/folder/run_folder.h"
#include "run/folder/run_record.h"
#include "scene/build_scene.h"

namespace frana {
namespace {

/// A text as a cell of a Markdown table.
std::string cell(const std::string& text) {
    std::string result;
    for (const char letter : text) {
        if (letter == '|') result += '\\';
        result += letter == '\n' ? ' ' : letter;
    }
    return result;
}

std::string row(const std::string& name, const std::string& value) {
    return fmt::format("| {} | {} |\n", name, cell(value));
}

/// "103520 m2": as plain digits up to 1e7.
std::string area_text(double area) {
    constexpr double kWhole = 1e4, kMost = 1e7;  // {:.5g} is as plain below, and shorter beyond [m2]
    return area >= kWhole && area < kMost ? fmt::format("{:.0f} m2", area) : fmt::format("{:.5g} m2", area);
}

std::string heading(const RunRecord& r) {
    const RunSummary& s = r.summary;
    std::string text = fmt::format("# {}\n\n", r.title);
    text += fmt::format("Case `{}`, frana {}, {} to {} UTC, {} thread{}. The run ended at t = {:.6g} s: {}.\n\n",
                        r.name, FRANA_VERSION, s.started, s.ended, r.threads, r.threads == 1 ? "" : "s", s.last.time,
                        reason_text(r));
    if (!r.command_line.empty()) text += fmt::format("The case file was overridden by `{}`.\n\n", r.command_line);
    return text;
}

/// "took 12 300 m3 (growth 1.8), 0.7 m deep at most, budget 3e-16": volumes as they are in the flow. What it grew from is
/// what was released and came in, by what the bed of the start gave. What is left and taken again is not new.
std::string bed_text(const RunRecord& r) {
    const Status::Bed& bed = r.summary.last.bed;
    const double given = r.summary.first.mass + mass_came_in(r.summary.first, r.summary.last), again = taken_again(r);
    std::string text = fmt::format(
        "the flow took {:.6g} m3 of it, by the density of the flow (its mass grew {:.3g} times), {:.3g} m deep at "
        "most; "
        "{} {:.6g} m3",
        r.taken_of_bed / r.density, given > 0.0 ? (given + r.taken_of_bed) / given : 1.0, bed.deepest,
        r.by_trees_alone ? "held back by trees:" : "left behind", bed.deposited / r.density);
    if (bed.deposited > 0.0)
        text += fmt::format(", of which it took {:.6g} m3 again and {:.6g} m3 lie there at the end", again / r.density,
                            lies_behind(r) / r.density);
    return text + fmt::format("; balance {:.1e}", budget(r.summary.first, r.summary.last).bed_error);
}

/// "9100 m3; by the tables, until their row of t = 95.2 s, 9100 m3, difference 1e-12; of their 12000 m3 2900 m3 had not
/// come in". A table comes in as rows of particles, each when it is complete. Several tables have rows of several
/// times.
std::string inflow_text(const RunRecord& r) {
    constexpr double kNone = 1e-9;  // of the tables: round-off of their sums
    const InflowBudget& inflow = *r.extras.inflow;
    const double left = inflow.tables - inflow.expected;
    const std::string so_far =
        fmt::format("{:.6g} m3, difference {:.1e}", inflow.expected, inflow.volume - inflow.expected);
    if (!(left > kNone * inflow.tables)) return fmt::format("{:.6g} m3; by the tables {}", inflow.volume, so_far);
    if (!(inflow.expected > 0.0))
        return fmt::format("{:.6g} m3; no row of the tables' {:.6g} m3 has come in yet", inflow.volume, inflow.tables);
    const std::string until = r.inflow_until ? fmt::format("their row of t = {:.4g} s", *r.inflow_until)
                                             : "the last row of each that came in";
    return fmt::format("{:.6g} m3; by the tables, until {}, {}; of their {:.6g} m3 {:.6g} m3 had not come in",
                       inflow.volume, until, so_far, inflow.tables, left);
}

/// "300 m3 at t = 12.4 s, when the flow reached it".
std::string late_text(const LateEntry& late) {
    if (late.entered)
        return fmt::format("{:.6g} m3 at t = {:.6g} s{}{}", late.volume, *late.entered,
                           late.at ? "" : ", when the flow reached it", late.of_bed ? ", cut out of the bed" : "");
    return late.at ? fmt::format("{:.6g} m3 did not: the run ended before t = {:.6g} s", late.volume, *late.at)
                   : fmt::format("{:.6g} m3 did not: the flow did not reach it", late.volume);
}

/// Where material becomes bed, what lies there and what still flows are two depths.
std::string depths_at_end(const RunRecord& r) {
    const auto metres = [](double depth) { return fmt::format("{:.4g} m", depth); };
    if (r.extras.water && !r.of_water_alone())
        return row("deepest at the end, without free water", metres(r.final_depth));
    if (!(r.summary.last.bed.deposited > 0.0)) return row("deepest at the end", metres(r.final_depth));
    return row("deepest at the end, with what has become bed", metres(r.final_depth)) +
           row("deepest flow at the end", metres(r.final_flow_depth));
}

std::string results(const RunRecord& r) {
    const RunSummary& s = r.summary;
    std::string text = "## Results\n\n| Quantity | Value |\n|---|---|\n";
    const char* released = r.of_water_alone()      ? "water at the start"
                           : r.extras.late.empty() ? "release volume"
                                                   : "release volume at the start";
    text += row(released, fmt::format("{:.6g} m3", r.release_volume));
    if (!r.extras.late.empty())
        text += row("release volume, with what entered later",
                    fmt::format("{:.6g} m3", r.release_volume + released_later(r)));
    if (r.extras.inflow) text += row("came in by inflows", inflow_text(r));
    for (const LateEntry& late : r.extras.late) text += row("entered later: " + late.name, late_text(late));
    text += row("simulated time",
                fmt::format("{:.6g} s of {:.6g} s, {} steps, {} frames", s.last.time, r.end, s.steps, s.frames));
    text +=
        row("deepest flow", fmt::format("{:.4g} m at t = {:.4g} s", s.extremes.max_depth, s.extremes.max_depth_time));
    const std::string counts =
        r.extras.points_apart ? "" : fmt::format(", where {:.3g} m deep or more", kSpeedCounts * r.footprint_depth);
    text += row("fastest flow, along the bed" + counts,
                fmt::format("{:.4g} m/s at t = {:.4g} s", s.extremes.max_speed, s.extremes.max_speed_time));
    text += row("largest dynamic pressure, density times speed squared",
                fmt::format("{:.4g} kPa", 1e-3 * r.peak_dynamic_pressure));
    text += row("largest bed pressure", fmt::format("{:.4g} kPa", 1e-3 * r.peak_pressure));
    text += row("farthest front from " + r.front_origin, fmt::format("{:.5g} m", s.extremes.max_front));
    text += row(fmt::format("area ever deeper than {:.3g} m", r.footprint_depth), area_text(r.footprint_area));
    if (std::isfinite(r.flow_width))
        text += row("width of the flow, median over its length",
                    fmt::format("{:.4g} m, {:.3g} cells", r.flow_width, r.flow_width / r.grid.cell));
    text += depths_at_end(r);
    text += row("mean speed of what still flows, at the end", fmt::format("{:.3g} m/s", s.last.mean_speed));
    if (r.extras.breakage) {
        const Breakage& b = *r.extras.breakage;
        std::string shares;
        for (const double share : b.pieces) shares += fmt::format("{}{:.3g}", shares.empty() ? "" : ", ", share);
        text += row("unbroken pieces, shares of the mass", shares.empty() ? "none" : shares);
        text += row("mean damage", fmt::format("{:.3g}; of {} pairs of neighbours {} parted, {} of them without damage",
                                               b.damage, b.pairs, b.torn, b.numerical));
    }
    if (r.extras.breakage)
        text += row("steps for each that the depth-averaged flow would need",
                    fmt::format("{:.3g}", r.extras.breakage->sub_cycling));
    if (r.extras.points_apart) {
        const PointsApart& a = *r.extras.points_apart;
        text += row("pieces of 3D points, more than a cell apart",
                    fmt::format("{}; {:.3g} % of the mass outside the largest, {:.3g} % out of its reach", a.pieces,
                                100.0 * a.apart, 100.0 * a.alone));
    }
    if (s.last.bed.initial > 0.0)
        text += row("erodible bed", bed_text(r));
    else if (s.last.bed.deposited > 0.0)
        text += row(r.by_trees_alone ? "held back by trees" : "became bed",
                    fmt::format("{:.6g} m3, of which {:.6g} m3 lie there at the end; balance {:.1e}",
                                s.last.bed.deposited / r.density, s.last.bed.mass / r.density,
                                budget(s.first, s.last).bed_error));
    text += row("left the domain", left_text(r));
    return text + "\n";
}

std::string water_text(const RunRecord& r) {
    const WaterBudget& w = *r.extras.water;
    const std::string fed = w.fed > 0.0 ? fmt::format("{:.8g} by inflows, ", w.fed) : "";
    const std::string in_particles =
        r.of_water_alone() ? ""
                           : fmt::format(" and {:.8g} in particles (these released {:.4g})", w.confined, w.released);
    return fmt::format(
        "Water [m3]: {:.8g} at the start, {}{:.4g} of rain and {:.4g} from a lake beyond open sides; now {:.8g} "
        "free{}, "
        "{:.4g} infiltrated, {:.4g} left; residual {:.1e}.\n\n",
        w.given, fed, w.rained, w.entered, w.free, in_particles, w.infiltrated, w.left, w.residual);
}

std::string budgets(const RunRecord& r) {
    const RunSummary& s = r.summary;
    const Budget b = budget(s.first, s.last);
    const double came = mass_came_in(s.first, s.last);
    const char* const net = came > 0.0 ? "net " : "";
    std::string text =
        "## Budgets\n\n| Balance | At the start | At the end | Left the domain | Residual |\n"
        "|---|---|---|---|---|\n";
    text += fmt::format("| mass [kg] | {:.8g} | {:.8g} | {:.4g} | {:.1e} of {} |\n", s.first.mass, s.last.mass,
                        s.last.mass_left, b.mass_error,
                        s.last.bed.initial > 0.0 ? "all mass, with the loose bed's"
                        : came > 0.0             ? "all mass"
                                                 : "the initial mass");
    if (came > 0.0) text += fmt::format("| of it came in [kg] | 0 | {:.8g} | | |\n", came);
    if (r.extras.water && r.extras.water->infiltrated_mass > 0.0)
        text +=
            fmt::format("| of what left, into the ground [kg] | | | {:.4g} | |\n", r.extras.water->infiltrated_mass);
    const double to_bed = s.last.bed.deposited - s.last.bed.eroded;
    if (to_bed != 0.0) text += fmt::format("| became bed, less what the bed gave [kg] | | {:.8g} | | |\n", to_bed);
    for (const std::size_t axis : {0, 1})
        text += fmt::format("| momentum {} [kg m/s] | {:.4g} | {:.4g} (impulse {:.4g}) | {}{:.4g} | {:.1e} |\n",
                            axis == 0 ? "x" : "y", s.first.momentum[axis], s.last.momentum[axis], s.last.impulse[axis],
                            net, s.last.momentum_left[axis], b.momentum_residual[axis]);
    text += fmt::format("| energy [J] | {:.5g} | {:.5g} | {}{:.4g} | {:.2e} |\n",
                        s.first.kinetic + s.first.potential + s.first.stored,
                        s.last.kinetic + s.last.potential + s.last.stored, net, s.last.energy_left, b.energy_residual);
    if (const double given = s.last.bed.energy - s.first.bed.energy; given != 0.0)
        text += fmt::format("| of it the bed gave [J] | | {:.5g} | | |\n", given);
    if (came > 0.0) text += "\nNet is what left less what came in: energy is negative where more came in than left.\n";
    text += fmt::format("\nOf the energy at the end, {:.4g} J are kinetic; {:.4g} J were dissipated.", s.last.kinetic,
                        s.last.dissipated);
    if (!r.of_water_alone())
        text += fmt::format(" Particles to grid, worst step: mass {:.1e}, momentum {:.1e} (relative).",
                            s.extremes.p2g_mass_error, s.extremes.p2g_momentum_error);
    text += "\n\n";
    if (r.extras.water) text += water_text(r);
    const Status::In3d& points = s.last.in_3d;
    if (points.friction != 0.0 || points.walls != 0.0 || points.material != 0.0 || points.numerical != 0.0)
        text += fmt::format(
            "3D points hold {:.4g} J by their deformation. Of what was dissipated they lost {:.4g} J by friction "
            "along the bed and barriers, {:.4g} J to their normal forces, {:.4g} J inside the material, and {:.4g} J "
            "to the scheme, which is what is left.\n\n",
            s.last.stored, points.friction, points.walls, points.material, points.numerical);
    return text;
}

std::string figures(const RunRecord& r) {
    if (r.figures.empty()) return "";
    std::string text = "## Figures\n\n";
    for (const DrawnFigure& figure : r.figures)
        text += figure.path.find(".mp4") != std::string::npos ||
                        figure.path.find(".html") != std::string::npos  // no pictures
                    ? fmt::format("[{}]({})\n\n", figure.caption, figure.path)
                    : fmt::format("![{}]({})\n\n*{}*\n\n", figure.caption, figure.path, figure.caption);
    return text;
}

std::string parameter_table(const RunRecord& r) {
    std::string text = "## What was run\n\n| Key | Value | Unit |\n|---|---|---|\n";
    for (const GivenKey& key : r.given) text += fmt::format("| `{}` | {} | {} |\n", key.key, cell(key.value), key.unit);
    text += fmt::format("\nThe grid has {} x {} nodes, {:.6g} m apart; ", r.grid.nx, r.grid.ny, r.grid.cell);
    text += r.of_water_alone()
                ? "there are no particles: the water is on its cells. "
                : fmt::format("{} particles at the start, {} at the end. ", r.particles, r.summary.last.particles);
    return text + "Keys that are not listed have their defaults: see `resolved.toml`.\n\n";
}

bool is_there(const std::vector<Product>& products, const std::string& path) {
    return std::any_of(products.begin(), products.end(), [&](const Product& p) { return p.path == path; });
}

std::string files(const RunRecord& r, const std::vector<Product>& products) {
    std::string text = "## Files\n\n";
    if (is_there(products, "grid.pvd"))
        text +=
            "ParaView: open `grid.pvd` and `particles.pvd`, press Apply; the play button runs through the "
            "frames. "
            "`terrain.vti` with Warp By Scalar (elevation) is the ground.\n\n";
    if (is_there(products, "run.xdmf")) text += "Other readers of XDMF: open `run.xdmf`.\n\n";
    if (is_there(products, "footprint.geojson"))
        text += fmt::format("QGIS: {}; {}.\n\n",
                            is_there(products, "run.qgz")
                                ? "open `run.qgz`, or drag single files of `rasters/` and `results.gpkg` into a map"
                                : "drag `footprint.geojson` into the map",
                            r.has_crs ? "they carry the coordinate system of the elevation model"
                                      : "the elevation model named no coordinate system, so neither do they");
    text += "| File | What |\n|---|---|\n";
    for (const Product& product : products)
        text += product.files > 1 || product.path.back() == '/'
                    ? fmt::format("| `{}` | {} ({} files) |\n", product.path, product.meaning, product.files)
                    : fmt::format("| [{0}]({0}) | {1} |\n", product.path, product.meaning);
    return text + "\n";
}

/// Whether something ran over a barrier. Of one such as a wall along a line, of which no more is known: whether
/// something stood before it.
bool was_reached(const BarrierSummary& b, const BarrierHit& hit) {
    return b.overtopped > 0.0 || (std::isnan(hit.area) && std::isfinite(b.run_up));
}

/// The barriers that a report has rows for, in the case's order. They are all, or of many the most deeply covered ones.
/// One whose depth is not known comes before them if it was reached.
std::vector<std::size_t> shown_barriers(const RunRecord& r) {
    std::vector<std::size_t> shown(r.barriers.size());
    std::iota(shown.begin(), shown.end(), std::size_t{0});
    if (shown.size() <= kMostBarrierTables || r.barrier_hits.size() != shown.size()) return shown;
    const auto depth = [&](std::size_t n) {
        if (std::isfinite(r.barrier_hits[n].depth)) return r.barrier_hits[n].depth;
        return was_reached(r.barriers[n], r.barrier_hits[n]) ? std::numeric_limits<double>::infinity() : 0.0;
    };
    std::stable_sort(shown.begin(), shown.end(), [&](std::size_t a, std::size_t b) { return depth(a) > depth(b); });
    shown.resize(kMostBarrierTables);
    while (!shown.empty() && depth(shown.back()) == 0.0) shown.pop_back();
    std::sort(shown.begin(), shown.end());
    return shown;
}

/// Structured particles meet barriers as walls, and only the sum of their forces is known.
std::string barriers_of_structure(const RunRecord& r) {
    std::string text = "## Barriers\n\n";
    for (const BarrierSummary& b : r.barriers) text += fmt::format("- {}\n", b.name);
    const Breakage& of = *r.extras.breakage;
    return text +
           fmt::format(
               "\nStructured particles meet a barrier as an upright box of any height, with normal force and friction. "
               "Since the start all barriers, with the walls along closed sides, took an impulse of {:.4g} N s in x "
               "and {:.4g} N s in y. What each of them took, contact times and run-up are not measured.\n\n",
               of.pushed[0], of.pushed[1]);
}

/// `hit`: what the rasters tell of the flow at its faces. Of a wall along a line or a mesh they tell nothing.
std::string barrier_row(const BarrierSummary& b, const BarrierHit& hit) {
    const bool reached = std::isfinite(b.run_up), forces = b.blur > 0.0;
    const auto or_dash = [](double value, const char* unit) {
        return std::isfinite(value) ? fmt::format("{:.4g} {}", value, unit) : std::string("-");
    };
    const std::string contact = b.first_contact >= 0.0                       ? fmt::format("{:.4g} s", b.first_contact)
                                : reached && (!forces || b.peak_force > 0.0) ? "-"
                                                                             : "none";
    const std::string impulse =
        forces && (b.first_contact >= 0.0 || b.peak_force > 0.0)
            ? fmt::format("{:.4g}, {:.4g}, {:.4g} N s", b.impulse[0], b.impulse[1], b.impulse[2])
            : "-";
    return fmt::format("| {} | {} | {} | {} | {} | {} | {:.5g} m3 |\n", b.name, contact, or_dash(hit.depth, "m"),
                       or_dash(1e-3 * hit.pressure, "kPa"), impulse, reached ? fmt::format("{:.5g} m", b.run_up) : "-",
                       b.overtopped);
}

/// Without what is round-off next to the largest entry.
Vec3 without_round_off(const Vec3& v) {
    const double least = 1e-9 * v.cwiseAbs().maxCoeff();
    return v.unaryExpr([&](double entry) { return std::abs(entry) < least ? 0.0 : entry; });
}

/// The largest means of the forces on those barriers; empty where no forces are known.
std::string mean_forces(const RunRecord& r, const std::vector<std::size_t>& shown) {
    std::string rows, abouts;
    for (const std::size_t n : shown) {
        const BarrierSummary& b = r.barriers[n];
        if (b.blur <= 0.0) continue;
        const std::size_t before = rows.size();
        if (b.peak_force > 0.0)
            rows += fmt::format("| {} | {:.4g} s, as in `barriers.csv` | {:.4g} N | {:.4g} s | - | - |\n", b.name,
                                b.blur, b.peak_force, b.peak_force_time);
        for (const MeanForce& m : b.means) {
            if (b.first_contact < 0.0 && !(m.largest > 0.0)) continue;  // nothing ever pressed on it
            const Vec3 force = without_round_off(m.force), moment = without_round_off(m.moment);
            rows += fmt::format(
                "| {} | {:.4g} s | {:.4g} N | {:.4g} s | {:.4g}, {:.4g}, {:.4g} N | {:.4g}, {:.4g}, {:.4g} N m |\n",
                b.name, m.window, m.largest, m.time, force[0], force[1], force[2], moment[0], moment[1], moment[2]);
        }
        if (rows.size() > before)
            abouts += fmt::format("{}{} ({:.10g}, {:.10g}, {:.6g})", abouts.empty() ? "" : ", ", b.name, b.about[0],
                                  b.about[1], b.about[2]);
    }
    if (rows.empty()) return "";
    return "\n| Barrier | Mean over | Largest horizontal force | Up to | Force x, y, z | Moment x, y, z |\n"
           "|---|---|---|---|---|---|\n" +
           rows + "\nMoments are about the middle of each outline on the bed: " + abouts + " m.\n";
}

std::string barriers(const RunRecord& r) {
    if (r.barriers.empty()) return "";
    if (r.extras.breakage) return barriers_of_structure(r);
    std::string text =
        "## Barriers\n\n| Barrier | First contact | Deepest at it | Dynamic pressure | Impulse x, y, z | Run-up "
        "to "
        "elevation | Over it |\n|---|---|---|---|---|---|---|\n";
    double blur = 0.0, hardest = 0.0;
    for (const BarrierSummary& b : r.barriers)
        blur = std::max(blur, b.blur), hardest = std::max(hardest, b.raw_peak_force);
    const std::vector<std::size_t> shown = shown_barriers(r);
    for (const std::size_t n : shown)
        text += barrier_row(r.barriers[n], n < r.barrier_hits.size() ? r.barrier_hits[n] : BarrierHit());
    if (shown.size() < r.barriers.size()) {
        std::size_t hit = 0;
        for (std::size_t n = 0; n < r.barriers.size(); ++n)
            hit += r.barriers[n].first_contact >= 0.0 || was_reached(r.barriers[n], r.barrier_hits[n]);
        text += fmt::format("\nOf {} barriers {} were hit.{} `barriers.csv` has all.\n", r.barriers.size(), hit,
                            shown.empty() ? "" : " Shown are walls that were reached, and those that stood deepest.");
    }
    text += mean_forces(r, shown);
    if (hardest > 0.0)
        text += fmt::format(
            "\nThe first blow of a contact is as hard as the artificial sound is fast. Means over less than {:.3g} s, "
            "twenty times what sound takes through the flow, may hold some of it. The worst step of all has {:.4g} N. "
            "Points press on a barrier from a cell of the stage away. What they did before first contact is dated to "
            "it. "
            "Over it: what stood over the barrier at any time.\n",
            blur, hardest);
    else if (blur <= 0.0)
        text += fmt::format(
            "\nRun-up is the highest top of what stood within two cells of a barrier, or on it. On a slope a thin flow "
            "counts "
            "as high as the ground two cells above the barrier; `frana converge` compares cells. First contact is when "
            "the "
            "depth at a face first exceeds {:.4g} m "
            "(`output.footprint_depth`); of walls "
            "along lines and of meshes it is not known. Forces are "
            "measured on 3D points only ([[stage]]); particles take a barrier for ground. Over it: particles whose "
            "middle came onto it.\n",
            r.footprint_depth);
    return text + "\n";
}

std::string sections(const RunRecord& r) {
    if (r.sections.empty()) return "";
    std::string text =
        "## Sections\n\n| Section | Positive towards | Volume that passed | Sediment | Largest discharge | Integral of "
        "the discharge |\n"
        "|---|---|---|---|---|---|\n";
    for (const SectionSummary& s : r.sections) {
        const double azimuth = std::fmod(std::atan2(s.towards.x(), s.towards.y()) * constants::kRadian + 360.0, 360.0);
        const bool reached = s.peak > 0.0 || s.integral != 0.0 || std::abs(s.volume) > 0.0;
        text += fmt::format("| {} | {:.0f} degrees from north | {:.6g} m3 | {:.6g} m3 | {} | {:.4g} m3 |\n", s.name,
                            azimuth, s.volume, s.sediment,
                            reached ? fmt::format("{:.4g} m3/s at {:.4g} s", s.peak, s.peak_time) : "not reached",
                            s.integral);
    }
    return text +
           "\nThe volume is that of the particles that passed, each with the mass that it had there, and is exact for "
           "them. Beyond the line some of it may have become bed, or the flow may have taken up more. The discharge is "
           "that of the nodes. "
           "Sediment is the solid part of the volume: `material.bed.solid_fraction` of it, by the mean of the ground "
           "along the line, where the bed law has one, otherwise all.\n\n";
}

std::string friction(const RunRecord& r) {
    if (r.friction.empty()) return "";
    std::string text = "## Friction\n\n| Where | Area and friction |\n|---|---|\n";
    for (const FrictionPart& part : r.friction) text += row(part.name, friction_sentence(part));
    if (r.friction_of_part) text += "\nAreas are those within the part of the terrain that the run needed.";
    return text + "\nLater zones win. `rasters/` has each parameter as the nodes had it.\n\n";
}

std::string times(const RunSummary& s) {
    std::string text = "## Wall time\n\n| Part | Seconds | Share |\n|---|---|---|\n";
    const double total = std::max(s.wall_seconds, 1e-9);
    const auto add = [&](const std::string& name, double seconds) {
        text += fmt::format("| {} | {:.2f} | {:.1f} % |\n", name, seconds, 100.0 * seconds / total);
    };
    for (const PhaseTime& part : s.solver) add(part.name, part.seconds);
    for (const PhaseTime& part : s.output) add("output: " + part.name, part.seconds);
    add("all output", s.output_seconds());
    add("**whole run**", s.wall_seconds);
    if (s.particle_steps > 0.0)
        text += fmt::format("\n{:.3g} million particle-steps a second.\n", 1e-6 * s.particle_steps / total);
    return text + "\n";
}

std::string remarks(const RunRecord& r) {
    if (r.warnings.empty()) return "";
    std::string text = "## Remarks\n\n";
    for (const std::string& warning : r.warnings) text += fmt::format("- {}\n", warning);
    return text + "\n";
}

}  // namespace

std::string report_markdown(const RunRecord& record, const std::filesystem::path& run_dir) {
    const std::vector<Product> products = products_in(run_dir);
    const std::string survey = record.comparison ? comparison_section(*record.comparison) : "";
    return heading(record) + remarks(record) + results(record) + survey +
           gauge_section(record.gauges, record.footprint_depth, record.summary.last.bed.deposited > 0.0, run_dir) +
           sections(record) + barriers(record) + friction(record) + budgets(record) + figures(record) +
           parameter_table(record) + files(record, products) + times(record.summary);
}

std::string closing_lines(const RunRecord& r, const std::filesystem::path& run_dir) {
    const RunSummary& s = r.summary;
    const std::vector<Product> products = products_in(run_dir);
    const auto place = [&](const char* path) {
        return is_there(products, path) ? (run_dir / path).string() : std::string("-");
    };
    std::string text;
    text += fmt::format("{}: {} (t = {:.6g} s)\n", r.title, reason_text(r), s.last.time);
    const std::string particles =
        r.of_water_alone() ? ""
                           : fmt::format("{} particles, {:.3g} M particle-steps/s, ", s.last.particles,
                                         s.wall_seconds > 0.0 ? 1e-6 * s.particle_steps / s.wall_seconds : 0.0);
    text += fmt::format("  computed   {} steps, {}{} ({:.0f} % output)\n", s.steps, particles,
                        clock_text(s.wall_seconds), 100.0 * s.output_share());
    const double came = mass_came_in(s.first, s.last);
    const std::string later = !(came > 0.0) ? ""
                              : r.extras.water
                                  ? fmt::format("; {:.6g} m3 of water came in",
                                                r.extras.water->rained + r.extras.water->entered + r.extras.water->fed)
                                  : fmt::format("; {:.6g} m3 came in later", came / r.density);
    text += fmt::format("  released   {:.6g} m3{}; {} left the domain; mass error {:.1e}\n", r.release_volume, later,
                        left_text(r), budget(s.first, s.last).mass_error);
    text += fmt::format("  deepest    {:.4g} m, fastest {:.4g} m/s, front at {:.5g} m\n", s.extremes.max_depth,
                        s.extremes.max_speed, s.extremes.max_front);
    text += fmt::format("  covered    {} deeper than {:.3g} m; deepest at the end {:.4g} m{}\n",
                        area_text(r.footprint_area), r.footprint_depth, r.final_depth,
                        s.last.bed.deposited > 0.0 ? ", with what became bed" : "");
    if (r.comparison) text += fmt::format("  survey     {}\n", comparison_line(*r.comparison));
    text += fmt::format("  report     {}\n", place("report.md"));
    text += fmt::format("  pictures   {}\n", r.figures.empty() ? "-" : (run_dir / "figures").string());
    if (is_there(products, "figures/view.html")) text += fmt::format("  browser    {}\n", place("figures/view.html"));
    text += fmt::format("  ParaView   {}\n", place("grid.pvd"));
    text += fmt::format("  QGIS       {}\n", place(is_there(products, "run.qgz") ? "run.qgz" : "footprint.geojson"));
    text += fmt::format("  remarks    {}\n", r.warnings.empty()
                                                 ? std::string("none")
                                                 : fmt::format("{}, listed in the report", r.warnings.size()));
    return text;
}

}  // namespace frana
