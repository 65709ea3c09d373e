#include "run/folder/look.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "base/constants.h"
#include "base/error.h"
#include "observe/table.h"
#include "run/folder/run_3d.h"
#include "vtk_io/figures/figure_3d.h"
#include "vtk_io/reader.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;
using Place = std::array<double, 3>;

/// The next 1, 1.5, 2, 3, 5 or 7.5 times a power of ten. It is an end of a range that one can read off a colour bar.
double round_up(double value) {
    if (!(value > 0.0)) return 1.0;
    const double power = std::pow(10.0, std::floor(std::log10(value)));
    for (const double step : {1.0, 1.5, 2.0, 3.0, 5.0, 7.5})
        if (step * power >= value) return step * power;
    return 10.0 * power;
}

/// What 99.5 % of the values do not exceed; 0 of nothing.
double most(std::vector<double> values) {
    if (values.empty()) return 0.0;
    const auto place = static_cast<std::ptrdiff_t>(0.995 * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + place, values.end());
    return values[static_cast<std::size_t>(place)];
}

/// Everything ever covered, and where the mass was first and last.
struct Extent {
    double xmin = HUGE_VAL, xmax = -HUGE_VAL, ymin = HUGE_VAL, ymax = -HUGE_VAL, zmin = HUGE_VAL, zmax = -HUGE_VAL;
    Place first{}, last{};

    bool empty() const { return xmin > xmax; }
    void add(double x, double y, double z) {
        xmin = std::min(xmin, x), xmax = std::max(xmax, x);
        ymin = std::min(ymin, y), ymax = std::max(ymax, y);
        zmin = std::min(zmin, z), zmax = std::max(zmax, z);
    }
    Place middle() const { return {0.5 * (xmin + xmax), 0.5 * (ymin + ymax), 0.5 * (zmin + zmax)}; }
};

struct Seen {
    std::set<std::string> arrays;  ///< of the grid's frames
    GridGeometry grid;
    double deepest = 0.0, thin = 0.0, last_time = 0.0, busy_time = 0.0, busiest = -1.0;
    Index busy_nodes = 0;  ///< with flow at busy_time
    std::map<std::string, double>
        largest;  ///< of depth, speed, cohesion, stress, effective_stress (size of any component), of
                  ///< water_depth, and of bound_depth, which is the rest
    std::map<std::string, double> top;                ///< of the same the largest of all values
    std::vector<std::pair<double, double>> cohesion;  ///< largest at each sampled time [s], [Pa]
    Extent extent;
};

void observe_extent(const LoadedFrame& frame, Seen& seen, bool first) {
    const auto& depth = frame.nodes.at("depth");
    const auto& elevation = frame.nodes.at("elevation");
    Place centre{};
    double weights = 0.0;
    for (Index j = 0, k = 0; j < frame.grid.ny; ++j)
        for (Index i = 0; i < frame.grid.nx; ++i, ++k) {
            const auto node = static_cast<std::size_t>(k);
            if (!(depth[node] > seen.thin) || !std::isfinite(elevation[node])) continue;
            const Place at{frame.grid.x(i), frame.grid.y(j), elevation[node]};
            seen.extent.add(at[0], at[1], at[2]);
            for (std::size_t axis = 0; axis < 3; ++axis) centre[axis] += depth[node] * at[axis];
            weights += depth[node];
        }
    if (weights > 0.0)
        for (double& coordinate : centre) coordinate /= weights;
    if (weights > 0.0 || first) seen.extent.last = centre;
    if (first) seen.extent.first = centre;
}

/// Takes the values of a frame that are shown. Returns what most of them do not exceed.
double observe_array(const std::string& name, std::vector<double> values, Seen& seen) {
    double& top = seen.top[name];
    for (const double value : values) top = std::max(top, value);
    const double usual = most(std::move(values));
    seen.largest[name] = std::max(seen.largest[name], usual);
    return usual;
}

void observe_values(const LoadedFrame& frame, Seen& seen) {
    const auto& depth = frame.nodes.at("depth");
    for (const char* name : {"depth", "speed", "stress", "effective_stress", "cohesion"}) {
        if (!frame.has(name)) continue;
        const auto& values = frame.nodes.at(name);
        const auto components = static_cast<std::size_t>(frame.components.at(name));
        std::vector<double> wet;
        for (std::size_t node = 0; node < depth.size(); ++node)
            for (std::size_t c = 0; c < components; ++c)
                if (depth[node] > seen.thin) wet.push_back(std::abs(values[node * components + c]));
        const double largest = observe_array(name, std::move(wet), seen);
        if (name == std::string("cohesion")) seen.cohesion.emplace_back(frame.time, largest);
    }
    if (!frame.has("water_depth")) return;
    const auto& water = frame.nodes.at("water_depth");
    std::vector<double> free, bound;
    for (std::size_t node = 0; node < depth.size(); ++node) {
        if (water[node] > seen.thin) free.push_back(water[node]);
        if (depth[node] - water[node] > seen.thin) bound.push_back(depth[node] - water[node]);
    }
    observe_array("water_depth", std::move(free), seen);
    observe_array("bound_depth", std::move(bound), seen);
}

/// The time at which most is in motion.
void observe_motion(const LoadedFrame& frame, Seen& seen) {
    if (!frame.has("speed")) return;
    const auto &depth = frame.nodes.at("depth"), &speed = frame.nodes.at("speed");
    const double motion = std::inner_product(depth.begin(), depth.end(), speed.begin(), 0.0);
    if (motion <= seen.busiest) return;
    seen.busiest = motion;
    seen.busy_time = frame.time;
    seen.busy_nodes = std::count_if(depth.begin(), depth.end(), [&](double h) { return h > seen.thin; });
}

/// Reads no more than seven frames: ranges need no more, and a long run has hundreds.
Seen observe_frames(const fs::path& run_dir) {
    Seen seen;
    const std::vector<double> times = frame_times(run_dir);
    const Index frames = static_cast<Index>(times.size());
    std::set<Index> chosen;
    for (Index k = 0; k < 7; ++k) chosen.insert(k * (frames - 1) / 6);
    for (const Index number : chosen) {
        const LoadedFrame frame =
            read_frame(run_dir, number, {"depth", "speed", "stress", "effective_stress", "cohesion", "water_depth"});
        if (!frame.has("depth") || !frame.has("elevation")) return seen;
        seen.arrays.insert(frame.names.begin(), frame.names.end());
        const auto& depth = frame.nodes.at("depth");
        seen.grid = frame.grid;
        seen.deepest = std::max(seen.deepest, *std::max_element(depth.begin(), depth.end()));
        seen.thin = std::min(0.05, 0.02 * seen.deepest);
        observe_extent(frame, seen, number == 0);
        observe_values(frame, seen);
        observe_motion(frame, seen);
    }
    seen.last_time = times.back();
    return seen;
}

Json camera(const Place& position, const Place& focal, const Place& up, double half_height, double half_width) {
    return {{"position", position},
            {"focal", focal},
            {"up", up},
            {"angle", 30.0},
            {"scale", std::max(half_height, half_width)},
            {"scale_wide", std::max(half_height, half_width / 1.5)},
            {"scale_tall", std::max(half_height, half_width / 0.6)},
            {"scale_row", std::max(half_height, half_width / 0.5)}};
}

constexpr double around = 1.12;  ///< 12 % of ground around what was covered

/// Half the extent's size in 3D, with ground around it [m].
double reach_of(const Extent& extent) {
    const double size = std::hypot(extent.xmax - extent.xmin, extent.ymax - extent.ymin, extent.zmax - extent.zmin);
    return std::max(0.5 * around * size, 1e-6);
}

/// From above, north up.
Json map_camera(const Extent& extent) {
    const Place middle = extent.middle();
    const Place top{middle[0], middle[1], extent.zmax + 4.0 * reach_of(extent)};
    return camera(top, middle, {0.0, 1.0, 0.0}, 0.5 * around * (extent.ymax - extent.ymin),
                  0.5 * around * (extent.xmax - extent.xmin));
}

/// From before the deposit, up the way that the mass came.
Json view_camera(const Extent& extent) {
    constexpr double half_angle = 15.0 * constants::kPi / 180.0, above = 35.0 * constants::kPi / 180.0;
    const double reach = reach_of(extent);
    const Place middle = extent.middle();
    double to_x = extent.last[0] - extent.first[0], to_y = extent.last[1] - extent.first[1];
    const double way = std::hypot(to_x, to_y);
    const bool moved = way > 0.05 * reach;
    to_x = moved ? to_x / way : 0.0, to_y = moved ? to_y / way : -1.0;
    const double distance = 1.25 * reach / std::tan(half_angle), flat = distance * std::cos(above);
    const Place before{middle[0] + to_x * flat, middle[1] + to_y * flat, middle[2] + distance * std::sin(above)};
    return camera(before, middle, {0.0, 0.0, 1.0}, reach, reach);
}

Json cameras(const fs::path& run_dir, const Extent& extent, bool survey) {
    Extent both = extent;
    const auto bounds = survey ? bounds_of(run_dir / "survey_outlines.vtp") : std::nullopt;
    if (bounds) {
        const double z = extent.middle()[2];
        both.add((*bounds)[0], (*bounds)[1], z);
        both.add((*bounds)[2], (*bounds)[3], z);
    }
    return {{"view", view_camera(extent)}, {"map", map_camera(extent)}, {"survey", map_camera(both)}};
}

std::string lacks_arrays(const Seen& seen, const std::vector<std::string>& names, const std::string& way_out) {
    for (const std::string& name : names)
        if (seen.arrays.count(name) == 0)
            return fmt::format("the frames of grid.pvd have no array {}; {}", name, way_out);
    return "";
}

/// Whether the files of a folder have an array; earlier versions wrote fewer.
bool have_array(const fs::path& folder, const std::string& array) {
    std::error_code none;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, none)) {
        if (entry.path().extension() != ".vtp") continue;
        std::ifstream file(entry.path(), std::ios::binary);
        const std::string text{std::istreambuf_iterator<char>(file), {}};
        return text.find('"' + array + '"') != std::string::npos;
    }
    return true;
}

/// Why a state cannot be shown; empty when it can.
std::string missing_for(const std::string& state, const fs::path& run_dir, const Seen& seen) {
    const bool history = fs::exists(run_dir / "history.csv");
    if (state == "budgets") return history ? "" : "there is no history.csv; run the case again";
    if (state == "probability") return "it shows the maps of many runs; make them with frana ensemble";
    if (seen.extent.empty())
        return "there are no frames with flow in grid.pvd; add \"vtk\" to output.formats and run again";
    for (const char* file : {"terrain.vti", "particles.pvd"})
        if (!fs::exists(run_dir / file))
            return fmt::format("there is no {}; add \"vtk\" to output.formats and run again", file);
    const std::string all = "set output.fields = \"all\" and run again";
    std::string lacks = lacks_arrays(seen, {"depth", "surface", "speed"}, all);
    if (state == "impact" && !fs::exists(run_dir / "barriers.pvd"))
        return "no 3D points stood before a barrier; give a [[barrier]] and a [[stage]] with model = "
               "\"mpm3d\"";
    if (state == "impact" && !have_array(run_dir / "barriers", "to_true_height"))
        return "an earlier version wrote the barriers without to_true_height; run the case again";
    if (state == "stress" && lacks.empty())
        lacks = lacks_arrays(seen, {"stress", "effective_stress"},
                             "give a [material.rheology], leave output.fields at \"all\", and run again");
    if (state == "structure" && lacks.empty())
        lacks = lacks_arrays(seen, {"damage", "cohesion", "stress"},
                             "give a [material.structure], leave output.fields at \"all\", and run again");
    if (state == "phases" && lacks.empty())
        lacks = lacks_arrays(seen, {"water_depth"},
                             "give a [water] with model = \"free\", leave output.fields at \"all\", and run again");
    if (state == "profiles" && lacks.empty() && !fs::exists(run_dir / "profiles.pvd"))
        return "there is no profiles.pvd; give a [[profile]] and run again";
    if (state == "profiles" && lacks.empty() && !have_array(run_dir / "profiles", "initial_elevation"))
        return "an earlier version wrote the profiles without initial_elevation; run the case again";
    if (state == "survey" && lacks.empty() && !fs::exists(run_dir / "survey_areas.vtp"))
        return "the run was not held against a survey; use frana compare, or give [survey] footprint and run again";
    return lacks;
}

/// A bar's title. Where values lie beyond its end it says so: how large they get, where all of the run was looked at.
std::string bar_title(const std::string& title, double end, double largest, bool of_all = true) {
    if (!(largest > end)) return title;
    return of_all ? fmt::format("{}, up to {:.3g}", title, largest) : title + ", more in places";
}

/// The largest of a column of history.csv in the steps from one time to another; 0 where it is gone.
double largest_in_steps(const fs::path& run_dir, const char* column, double from, double until) {
    if (!fs::exists(run_dir / "history.csv")) return 0.0;
    const Table history = read_table(run_dir / "history.csv");
    if (!history.has(column)) return 0.0;
    const std::vector<double>&t = history.column("t"), &values = history.column(column);
    double largest = 0.0;
    for (std::size_t row = 0; row < t.size(); ++row)
        if (t[row] >= from && t[row] <= until) largest = std::max(largest, values[row]);
    return largest;
}

/// Titles of the bars of what frames hold. Depth and speed are known in all steps, the rest at seven
/// outputs.
void name_bars(const fs::path& run_dir, Seen& seen, Json& look) {
    for (const char* name : {"depth", "speed"}) {
        const double largest = std::max(
            seen.top[name],
            largest_in_steps(run_dir, name == std::string("depth") ? "max_depth" : "max_speed", 0.0, seen.last_time));
        look["bar"][name] = bar_title(name == std::string("depth") ? "depth [m]" : "speed [m/s]",
                                      look["range"][name][1].get<double>(), largest);
    }
    const std::pair<const char*, const char*> sampled[] = {{"stress", "Pa"},
                                                           {"effective_stress", "Pa"},
                                                           {"cohesion", "cohesion [Pa]"},
                                                           {"water_depth", "free water [m]"},
                                                           {"bound_depth", "particles [m]"}};
    for (const auto& [name, title] : sampled)
        if (look["range"].contains(name)) {
            const Json& range = look["range"][name];
            const double end = std::max(std::abs(range[0].get<double>()), std::abs(range[1].get<double>()));
            look["bar"][name] = bar_title(title, end, seen.top[name], false);
        }
}

/// What 99.5 % of the loaded patches do not exceed at a time, and the largest [Pa].
std::pair<double, double> pressures_of(const std::vector<LoadedPatch>& patches) {
    std::vector<double> pressures;
    for (const LoadedPatch& patch : patches)
        if (patch.pressure > 0.0) pressures.push_back(patch.pressure);
    const double largest = pressures.empty() ? 0.0 : *std::max_element(pressures.begin(), pressures.end());
    return {most(std::move(pressures)), largest};
}

/// Of barriers.csv, in the case's order.
std::vector<std::string> barrier_names(const fs::path& run_dir) {
    std::ifstream file(run_dir / "barriers.csv");
    std::vector<std::string> names;
    std::string line;
    for (std::getline(file, line); std::getline(file, line);) names.push_back(line.substr(0, line.find(',')));
    return names;
}

/// The output with points and with the largest load on a barrier that pictures tell, with its loads. The last such one
/// where there is never any.
Moment3d hardest_moment(const fs::path& run_dir, const Raster& bed) {
    const std::vector<double> times = barrier_times(run_dir), frames = particle_times(run_dir);
    const BarrierMeshes meshes = read_barrier_meshes(run_dir);
    const ToldForces forces(run_dir, barrier_names(run_dir));
    Moment3d hardest;
    double most_load = -1.0;
    for (std::size_t k = 0; k < times.size(); ++k) {
        Moment3d moment;
        moment.barriers = barrier_solids(read_barriers(run_dir, static_cast<Index>(k)), {}, bed, meshes);
        const double load = forces.load_of(moment, times[k]);
        const auto frame = std::find(frames.begin(), frames.end(), times[k]);
        if (frame == frames.end() || load < most_load) continue;
        moment = moment_3d(read_particles(run_dir, frame - frames.begin()), moment.barriers);
        if (moment.typical_size <= 0.0) continue;
        most_load = load;
        hardest = std::move(moment);
    }
    return hardest;
}

/// What the state "impact" shows.
void look_at_impact(const fs::path& run_dir, Json& look) {
    const LoadedFrame terrain = read_terrain(run_dir);
    Figure3d figure;
    figure.bed = Raster{terrain.grid, terrain.nodes.at("elevation"), "", ""};
    figure.moment = hardest_moment(run_dir, figure.bed);
    Shared3d shared;
    shared.add(figure.moment);
    if (shared.empty() || figure.moment.typical_size <= 0.0) {
        look["states"]["impact"] = "there were no 3D points yet; run the case further";
        return;
    }
    figure.view = shared.view();
    const ViewAngles3d eye = best_view(figure);
    Extent extent;
    const auto& box = figure.view.box;
    for (const auto& piece : figure.moment.material)
        if (!piece.is_particle) extent.add(piece.place.x(), piece.place.y(), piece.place.z());
    const double middle = 0.5 * (extent.zmin + extent.zmax);
    extent = Extent{
        box[0], box[2], box[1], box[3], std::isfinite(middle) ? middle : 0.0, std::isfinite(middle) ? middle : 0.0,
        {},     {}};
    const double reach = reach_of(extent),
                 distance = 0.75 * reach / std::tan(15.0 * constants::kPi / 180.0);  // seen askew
    const Place focal = extent.middle();
    const Place position{focal[0] - distance * std::sin(eye.azimuth) * std::cos(eye.down),
                         focal[1] - distance * std::cos(eye.azimuth) * std::cos(eye.down),
                         focal[2] + distance * std::sin(eye.down)};
    look["impact_time"] = figure.moment.time;
    look["point_radius"] = 0.62 * figure.moment.typical_size;
    look["range"]["point_speed"] = {0.0, round_up(figure.view.fastest)};
    const std::vector<double> times = barrier_times(run_dir);
    double pressure = 0.0, largest = 0.0;  // as the patches have it, which ParaView shows
    for (Index k = 0; k < static_cast<Index>(times.size()); ++k) {
        const auto [usual, top] = pressures_of(read_barriers(run_dir, k));
        pressure = std::max(pressure, usual), largest = std::max(largest, top);
    }
    look["range"]["pressure"] = {0.0, round_up(pressure)};
    look["bar"]["pressure"] = bar_title("pressure [Pa]", round_up(pressure), largest);
    look["bar"]["point_speed"] = bar_title("speed [m/s]", round_up(figure.view.fastest),
                                           largest_in_steps(run_dir, "max_speed", times.front(), times.back()));
    look["camera"]["impact"] = camera(position, focal, {0.0, 0.0, 1.0}, reach, reach);
}

/// How many times deeper than it is flow is drawn on a profile. It is a round number, so that the deepest has a fifth
/// of the relief. No exaggeration where it has that already.
int times_deeper(double relief, double deepest) {
    const double wanted = deepest > 0.0 ? 0.2 * relief / deepest : 1.0;
    int times = 1;
    for (int power = 1; power <= 1000; power *= 10)
        for (const int step : {1, 2, 5})
            if (step * power <= wanted) times = step * power;
    return times;
}

/// Corner of the profile's chart where the terrain leaves most room. In ParaView's numbers: 0 top left, 1 top right, 2
/// bottom right, 3 bottom left.
int free_corner(const std::vector<double>& elevation, double lowest, double highest) {
    constexpr double kWide = 0.35;    // of the chart, a legend's width
    constexpr double kSurface = 0.2;  // of the relief: flow drawn on the terrain
    const auto all = static_cast<double>(elevation.size());
    const auto wide = std::max<std::ptrdiff_t>(1, std::llround(kWide * all));
    const auto [left_low, left_high] = std::minmax_element(elevation.begin(), elevation.begin() + wide);
    const auto [right_low, right_high] = std::minmax_element(elevation.end() - wide, elevation.end());
    const double top = highest - kSurface * (highest - lowest);
    const std::array<double, 4> room{top - *left_high, top - *right_high, *right_low - lowest, *left_low - lowest};
    return static_cast<int>(std::max_element(room.begin(), room.end()) - room.begin());
}

/// The chart of the profile: formulas of what is drawn, its title, and where its legend stands. All surfaces are drawn
/// from the bed at the start, which stays, so that a deposit is as thick whether it still flows or has become bed.
void look_at_profile(const fs::path& run_dir, Json& look) {
    ProfileShape shape = profile_shape(run_dir);
    if (shape.elevation.empty()) shape.elevation = {0.0};
    const auto [lowest, highest] = std::minmax_element(shape.elevation.begin(), shape.elevation.end());
    const int times = times_deeper(*highest - *lowest, shape.deepest);
    look["legend"] = free_corner(shape.elevation, *lowest, *highest);
    const auto drawn = [&](const char* surface) {
        return fmt::format("initial_elevation+{}*({}-initial_elevation)", times, surface);
    };
    look["profile"] = {{"surface", drawn("surface")},
                       {"initial_surface", drawn("initial_surface")},
                       {"title", times == 1 ? "Surfaces along the line"
                                            : fmt::format("Surfaces along the line, depths times {}", times)}};
}

/// What the state "structure" says of the cohesion.
std::string cohesion_text(const Seen& seen) {
    constexpr double kNone = 1e-3;  // of the largest
    const auto found = seen.largest.find("cohesion");
    if (found == seen.largest.end()) return "Cohesion that is left";
    std::optional<double> none_from;
    for (const auto& [time, cohesion] : seen.cohesion)
        if (cohesion > kNone * found->second)
            none_from.reset();
        else if (!none_from)
            none_from = time;
    if (!none_from) return "Cohesion that is left";
    return fmt::format("Cohesion that is left: none at {:.4g} s{}", *none_from,
                       *none_from < seen.last_time ? " and later" : "");
}

}  // namespace

const std::vector<std::string>& state_names() {
    static const std::vector<std::string> names = {"overview",  "stress", "profiles", "survey",     "impact",
                                                   "structure", "phases", "budgets",  "probability"};
    return names;
}

Json look_at_maps(const fs::path& dir, const std::string& title) {
    const LoadedFrame maps = read_maps(dir);
    const auto &elevation = maps.nodes.at("elevation"), &reached = maps.nodes.at("probability_reached");
    Extent extent;
    Place highest{}, lowest{};
    for (Index j = 0, k = 0; j < maps.grid.ny; ++j)
        for (Index i = 0; i < maps.grid.nx; ++i, ++k) {
            const auto node = static_cast<std::size_t>(k);
            if (!(reached[node] > 0.0) || !std::isfinite(elevation[node])) continue;
            const Place at{maps.grid.x(i), maps.grid.y(j), elevation[node]};
            if (extent.empty() || at[2] > highest[2]) highest = at;
            if (extent.empty() || at[2] < lowest[2]) lowest = at;
            extent.add(at[0], at[1], at[2]);
        }
    Json look = {{"title", title}};
    for (const std::string& name : state_names())
        look["states"][name] = name != "probability" ? "it shows one run; this is an ensemble"
                               : extent.empty()      ? "no run came anywhere; look into runs.csv"
                                                     : "";
    if (extent.empty()) return look;
    extent.first = highest, extent.last = lowest;
    look["lift"] = 0.1 * maps.grid.cell;
    look["lift_outlines"] = 0.3 * maps.grid.cell;
    look["range"]["probability"] = {0.0, 1.0};
    look["camera"] = {{"view", view_camera(extent)}, {"map", map_camera(extent)}};
    return look;
}

Json look_at_run(const fs::path& run_dir, const std::string& title) {
    Seen seen;
    if (fs::exists(run_dir / "grid.pvd") && !frame_times(run_dir).empty()) seen = observe_frames(run_dir);
    Json look;
    look["title"] = title;
    for (const std::string& name : state_names()) look["states"][name] = missing_for(name, run_dir, seen);
    const auto shows = [&](const char* state) { return look["states"][state].get<std::string>().empty(); };
    if (shows("budgets")) {
        const Table history = read_table(run_dir / "history.csv");
        const double start = history.rows() > 0 ? history.column("potential").front() : 0.0;
        look["potential_from_start"] = fmt::format("potential - ({})", start);
    }
    if (seen.extent.empty()) return look;
    look["last_time"] = seen.last_time;
    look["busy_time"] = seen.busy_time;
    look["lift"] = std::max(0.1 * seen.grid.cell, 0.2 * seen.thin);
    look["lift_areas"] = seen.grid.cell;
    look["lift_outlines"] = 1.5 * seen.grid.cell;
    look["thin"] = seen.thin;
    look["particle_radius"] = std::max(0.35 * seen.grid.cell, 0.0015 * reach_of(seen.extent));  // or nobody sees them
    for (const char* name : {"depth", "speed"}) look["range"][name] = {0.0, round_up(seen.largest[name])};
    const double stress = round_up(seen.largest["stress"]);
    look["range"]["stress"] = {-stress, stress};
    if (shows("structure")) {
        look["range"]["cohesion"] = {0.0, round_up(seen.largest["cohesion"])};
        look["cohesion_text"] = cohesion_text(seen);
    }
    if (shows("phases"))
        for (const char* name : {"water_depth", "bound_depth"})
            look["range"][name] = {0.0, round_up(seen.largest[name])};
    look["range"]["effective_stress"] = {-round_up(seen.largest["effective_stress"]), 0.0};
    name_bars(run_dir, seen, look);
    // Some 400 crosses on the flow, since a narrow one has no room for wide distances. But they must be large enough to
    // see when all that was ever covered is in view.
    const double across = std::max(seen.extent.xmax - seen.extent.xmin, seen.extent.ymax - seen.extent.ymin);
    const double nodes_apart =
        std::max(std::sqrt(static_cast<double>(seen.busy_nodes) / 400.0), across / seen.grid.cell / 80.0);
    const auto stride = std::max<Index>(1, std::llround(nodes_apart));
    look["cross"] = {{"stride", stride},
                     {"scale", 2.5 * static_cast<double>(stride) * seen.grid.cell / stress},
                     {"extent", {0, seen.grid.nx - 1, 0, seen.grid.ny - 1, 0, 0}}};
    if (shows("profiles")) look_at_profile(run_dir, look);
    look["camera"] = cameras(run_dir, seen.extent, shows("survey"));
    try {
        if (shows("impact")) look_at_impact(run_dir, look);
    } catch (const UserError& error) {  // a list of output.fields without what it needs; the other states stand
        look["states"]["impact"] = error.what();
    }
    return look;
}

}  // namespace frana
