#include "run/folder/run_folder.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/layer_name.h"
#include "base/pattern.h"
#include "run/folder/products.h"
#include "run/folder/record_file.h"

namespace frana {
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// "(mu|xi|...)"
static std::string friction_names() {
    std::string names;
    for (const auto& [name, key] : friction_keys())
        if (name != kForestRaster) names += (names.empty() ? "(" : "|") + name;
    return names + ")";
}

const std::vector<ProductKind>& product_kinds() {
    static const std::string raster_names =
        "(peak_(depth|speed|pressure|dynamic_pressure)|arrival_time|final_(depth|velocity_[xy]|elevation|damage|water_"
        "depth)|(eroded|deposited|lying)_depth|bed_change|elevation)";
    static const std::vector<ProductKind> kinds = {
        {"", "report\\.md", "this page", false},
        {"", "case\\.toml", "the case as given", false},
        {"", "resolved\\.toml", "every key in SI, defaults marked", false},
        {"", "run\\.json", "version, times, budgets, reason of the end", false},
        {"", "history\\.csv", "time series of budgets and extremes (SI units)", false},
        {"", "particles\\.pvd", "particles over time, for ParaView", false},
        {"particles", "particles_\\d+\\.vtp", "frames of the particles", true},
        {"", "grid\\.pvd", "fields on the grid over time, for ParaView", false},
        {"grid", "grid_\\d+\\.vti", "frames of the grid", true},
        {"", "profiles\\.pvd", "profiles over time, for ParaView", false},
        {"profiles", "profiles_\\d+\\.vtp", "frames of the profiles", true},
        {"", "barriers\\.pvd", "pressure on barriers over time, for ParaView", false},
        {"barriers", "barriers_\\d+\\.vtp", "frames of the barriers", true},
        {"", "barrier_meshes\\.vtp", "barriers that were given as meshes, for ParaView", false},
        {"", "survey_(areas|outlines)\\.vtp", "the survey on the terrain, for ParaView", false},
        {"", "terrain\\.vti", "bed elevation, slope and hillshade", false},
        {"", "run\\.(xdmf|h5)", "the same series for XDMF readers", false},
        {"", "series\\.nc", "the flow over time for readers of netCDF: QGIS, xarray, Panoply", false},
        {"rasters", raster_names + "\\.tif", "GeoTIFF", false},
        {"rasters", friction_names() + "\\.tif", "GeoTIFF of the friction as it was used", false},
        {"rasters", "forest_pressure\\.tif", "GeoTIFF of the detrainment K of the forest", false},
        {"rasters", "(" + raster_names + "|forest_pressure|" + friction_names() + ")\\.qml",
         "styles of the rasters, which QGIS takes up with them", true},
        {"", "footprint\\.geojson", "outline of everything ever covered", false},
        {"", "footprint\\.qml", "style of that outline, which QGIS takes up with it", false},
        {"", "barriers\\.csv", "what hit each barrier, when, and from which side", false},
        {"", "run\\.qgz", "project of QGIS: open it to see the run on its terrain", false},
        {"", "results\\.gpkg",
         "footprint, outlines, release, barriers, gauges, profiles, sections with their peaks, for a GIS", false},
        {"profiles", "[^.].*\\.csv", "the flow along a line, at every output", false},
        {"gauges", "[^.].*\\.csv", "the flow at a point, after every step", false},
        {"sections", "[^.].*\\.csv",
         "discharge through a line, the volume that passed it and its solid part, after every step", false},
        {"barriers", "[^.].*\\.csv",
         "run-up to a barrier and what went over it, of 3D points its forces and moments, after every step", false},
        {"figures", "((map|view|section|filmstrip|profile|gauges|sections|barrier|budget)_[^.].*|compare(_.+)?)\\.png",
         "figure", false},
        {"figures", "film_[^.].*\\.(mp4|gif)", "film", false},
        {"figures", "view\\.html", "the run in three dimensions and through time: open it in a browser", false},
        {"insitu", "[^.].*\\.csv", "sampled while the case ran", false},
        {"insitu", "[^.].*\\.pvd", "sampled while the case ran, for ParaView", false},
        {"insitu", "[^.].*\\.gpkg", "sampled while the case ran, for a GIS", false},
        {"insitu/*", "[^.].*_\\d+\\.(png|vtp|vtu)", "made while the case ran", true},
        {"states", ".*\\.pvsm", "ParaView state, File > Load State", false},
        {"states", "look\\.json", "colour ranges and cameras of the states", false},
        {"", "compare(_.+)?\\.(json|md)", "comparison with a survey", false},
        {"", "compare_(.+_)?bed_change\\.csv", "changes of the ground along the path, simulated and surveyed", false},
        {"", "checkpoint\\.h5", "last state", false}};
    return kinds;
}

namespace {

/// The folders of a kind, relative to the run's: one, or with "name/*" all in "name".
std::vector<fs::path> folders_of(const fs::path& run_dir, const ProductKind& kind) {
    const fs::path folder(kind.folder);
    if (folder.filename() != "*") return {folder};
    std::vector<fs::path> found;
    std::error_code none;  // a folder that is not there holds nothing
    for (const auto& entry : fs::directory_iterator(run_dir / folder.parent_path(), none))
        if (entry.is_directory()) found.push_back(folder.parent_path() / entry.path().filename());
    std::sort(found.begin(), found.end());
    return found;
}

/// To make one of a text takes longer than to match a folder's names with it. They are few and often used.
const Pattern& pattern_of(const ProductKind& kind) {
    static thread_local std::map<std::string, Pattern> known;
    const auto found = known.find(kind.pattern);
    return found != known.end() ? found->second : known.emplace(kind.pattern, Pattern(kind.pattern)).first->second;
}

std::vector<fs::path> files_in(const fs::path& folder, const ProductKind& kind) {
    std::vector<fs::path> found;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(folder, none))
        if (entry.is_regular_file() && pattern_of(kind).matches(entry.path().filename().string()))
            found.push_back(entry.path());
    std::sort(found.begin(), found.end());
    return found;
}

std::vector<fs::path> all_files_of(const fs::path& run_dir, const ProductKind& kind) {
    std::vector<fs::path> all;
    for (const fs::path& folder : folders_of(run_dir, kind)) {
        const std::vector<fs::path> files = files_in(run_dir / folder, kind);
        all.insert(all.end(), files.begin(), files.end());
    }
    return all;
}

/// A UserError with the way out that is the same for every trouble with the folder.
UserError trouble(const fs::path& run_dir, const std::string& what) {
    return UserError(fmt::format("{}: {}; expected a folder that can be written to; choose another one with --out",
                                 run_dir.string(), what));
}

std::string relative_to(const fs::path& run_dir, const fs::path& file) {
    return file.lexically_relative(run_dir).generic_string();
}

std::int64_t last_change(const fs::path& file) {
    std::error_code gone;
    return static_cast<std::int64_t>(fs::last_write_time(file, gone).time_since_epoch().count());
}

/// All files in the folder that are named like products, whosever they are.
std::vector<fs::path> files_named_like_products(const fs::path& run_dir) {
    std::vector<fs::path> all;
    for (const ProductKind& kind : product_kinds()) {
        const std::vector<fs::path> files = all_files_of(run_dir, kind);
        all.insert(all.end(), files.begin(), files.end());
    }
    return all;
}

/// Files that are named like products and are not the run's. Path relative to the run folder -> last change [ns of the
/// file clock]. One that has changed since is the run's: it was replaced.
using OtherFiles = std::map<std::string, std::int64_t>;

bool same_file(const fs::path& a, const fs::path& b) {
    std::error_code not_there;
    return fs::equivalent(a, b, not_there) && !not_there;
}

/// Whether files of a kind are written while the run goes on, and not at its end.
bool grows(const ProductKind& kind) {
    for (const char* folder : {"particles", "grid", "profiles", "gauges", "sections", "barriers", "insitu", "insitu/*"})
        if (kind.folder == folder) return true;
    static const Pattern growing(
        "(history|particles|grid|profiles|barrier(s\\\\\\.p|_)|run\\\\\\.(json|\\()|terrain|checkpoint|case|resolved)."
        "*");
    return kind.folder.empty() && growing.matches(kind.pattern);
}

/// By run.json: what its list lacks or, when the run did not end, what was there before it. Without a run.json
/// that says so, all files are others'.
OtherFiles other_files(const fs::path& run_dir) {
    const Json record = json_in(run_dir / "run.json");
    const bool ended = lists_files(record);
    const bool begun = record.is_object() && record.contains("others") && record["others"].is_object();
    const auto is_theirs = [&](const std::string& name, const fs::path& file) {
        if (ended) return std::find(record["files"].begin(), record["files"].end(), name) == record["files"].end();
        if (begun) return record["others"].contains(name) && record["others"][name] == last_change(file);
        return true;
    };
    OtherFiles others;
    for (const fs::path& file : files_named_like_products(run_dir)) {
        const std::string name = relative_to(run_dir, file);
        if (is_theirs(name, file)) others[name] = last_change(file);
    }
    return others;
}

bool is_others(const OtherFiles& others, const fs::path& run_dir, const fs::path& file) {
    const auto found = others.find(relative_to(run_dir, file));
    return found != others.end() && found->second == last_change(file);
}

/// Marks the folder as that of a running case and removes its products but those of the kinds that stay.
void clear(const fs::path& run_dir, const OtherFiles& others, const std::function<bool(const ProductKind&)>& stays) {
    // Written first: it also shows that the folder is writable.
    write_text(run_dir / "run.json", Json{{"exit_reason", kRunning}, {"others", others}}.dump(2) + "\n");
    remove_half_written(run_dir);
    std::error_code failure;
    for (const ProductKind& kind : product_kinds())
        for (const fs::path& file : all_files_of(run_dir, kind)) {
            const std::string name = file.filename().string();
            if (name == "run.json" || stays(kind) || is_others(others, run_dir, file)) continue;
            fs::remove(file, failure);
            if (failure)
                throw trouble(run_dir,
                              fmt::format("{} of an earlier run cannot be removed: {}", name, failure.message()));
        }
}

/// Without those that the case reads: a case may lie in the folder that it runs in.
std::vector<fs::path> files_in_the_way(const fs::path& run_dir, const std::vector<fs::path>& inputs) {
    std::vector<fs::path> found = files_named_like_products(run_dir);
    for (std::size_t i = 0; i < inputs.size(); ++i)
        for (const fs::path& file : found) {
            if (!same_file(file, inputs[i])) continue;
            if (i == 0 && same_file(file, run_dir / "case.toml")) continue;  // stays as it is
            throw UserError(
                fmt::format("{}: the case reads this file and a run writes one of its name; expected a "
                            "folder without the case's inputs; choose another one with --out",
                            file.string()));
        }
    if (!inputs.empty())
        found.erase(std::remove_if(found.begin(), found.end(),
                                   [&](const fs::path& file) { return same_file(file, inputs[0]); }),
                    found.end());
    return found;
}

/// Whether every run writes this very name. Names in gauges, states, ... are the case's or the user's.
bool has_one_name(const fs::path& run_dir, const fs::path& file) {
    const std::string folder = file.parent_path().lexically_relative(run_dir).generic_string();
    return folder == "." || folder == "rasters";
}

std::string names_of(const fs::path& run_dir, const std::vector<fs::path>& files) {
    constexpr std::size_t kNamed = 3;
    std::string text;
    for (std::size_t i = 0; i < std::min(kNamed, files.size()); ++i)
        text += (i > 0 ? ", " : "") + relative_to(run_dir, files[i]);
    return files.size() > kNamed ? fmt::format("{} and {} more", text, files.size() - kNamed) : text;
}

}  // namespace

/// A product that a killed process was writing when it died has a name like ".peak_depth.tmp4711.tif".
void remove_half_written(const fs::path& run_dir) {
    // SQLite, which writes GeoPackages, has files of its own next to one
    static const Pattern half_written("\\.(.*)\\.tmp\\d+(\\..*?)?(-journal|-wal|-shm)?");
    std::error_code ignored;
    for (const ProductKind& kind : product_kinds()) {
        std::vector<fs::path> found;
        for (const fs::path& folder : folders_of(run_dir, kind))
            for (const auto& entry : fs::directory_iterator(run_dir / folder, ignored)) {
                const auto parts = half_written.groups(entry.path().filename().string());
                if (parts && pattern_of(kind).matches((*parts)[0] + (*parts)[1])) found.push_back(entry.path());
            }
        for (const fs::path& file : found) fs::remove(file, ignored);
    }
    for (const char* film : {"film_depth.mp4", "film_depth.gif", "film_points.mp4", "film_points.gif"})
        fs::remove_all(run_dir / "figures" / (std::string(film) + ".part"), ignored);
}

std::vector<Product> products_in(const fs::path& run_dir) {
    const OtherFiles others = other_files(run_dir);
    std::vector<Product> products;
    for (const ProductKind& kind : product_kinds())
        for (const fs::path& folder : folders_of(run_dir, kind)) {
            std::vector<fs::path> files = files_in(run_dir / folder, kind);
            files.erase(std::remove_if(files.begin(), files.end(),
                                       [&](const fs::path& file) { return is_others(others, run_dir, file); }),
                        files.end());
            if (files.empty()) continue;
            if (kind.one_of_many)
                products.push_back({folder.generic_string() + "/", kind.meaning, files.size()});
            else
                for (const fs::path& file : files)
                    products.push_back({(folder / file.filename()).generic_string(), kind.meaning, 1});
        }
    return products;
}

std::vector<fs::path> product_files(const fs::path& run_dir) {
    const OtherFiles others = other_files(run_dir);
    std::vector<fs::path> files = files_named_like_products(run_dir);
    files.erase(std::remove_if(files.begin(), files.end(),
                               [&](const fs::path& file) { return is_others(others, run_dir, file); }),
                files.end());
    return files;
}

std::vector<std::string> files_made(const fs::path& run_dir) {
    std::vector<std::string> made = {"report.md", "run.json"};  // the last to be written
    for (const fs::path& file : product_files(run_dir)) made.push_back(relative_to(run_dir, file));
    std::sort(made.begin(), made.end());
    made.erase(std::unique(made.begin(), made.end()), made.end());
    return made;
}

void require_room_for_run(const fs::path& run_dir, const std::vector<fs::path>& inputs, Overwrite overwrite) {
    const std::vector<fs::path> found = files_in_the_way(run_dir, inputs);
    const OtherFiles others = other_files(run_dir);
    const auto stands = std::find_if(found.begin(), found.end(), [&](const fs::path& file) {
        return has_one_name(run_dir, file) && is_others(others, run_dir, file);
    });
    if (stands != found.end())  // --overwrite is no way out
        throw UserError(
            fmt::format("{}: found a file that no run left there, by the list in run.json; expected a "
                        "folder without files of such names; choose another one with --out, or move it "
                        "away",
                        stands->string()));
    if (overwrite == Overwrite::no && !found.empty())
        throw UserError(
            fmt::format("{}: found {}, which a run would replace; expected a folder without a run's files; "
                        "choose another one with --out, give --overwrite to replace an earlier run, or "
                        "--resume to go on with it",
                        run_dir.string(), names_of(run_dir, found)));
}

void require_no_others(const fs::path& dir, const std::string& mark, const std::vector<std::string>& names,
                       const std::string& what) {
    if (fs::exists(dir / mark)) return;
    std::vector<fs::path> found;
    std::error_code none;
    for (const std::string& name : names) {
        if (fs::is_directory(dir / name)) {
            for (const auto& entry : fs::recursive_directory_iterator(dir / name, none))
                if (!entry.is_directory(none)) found.push_back(entry.path());
        } else if (fs::exists(dir / name, none)) {
            found.push_back(dir / name);
        }
    }
    std::sort(found.begin(), found.end());
    if (!found.empty())
        throw UserError(
            fmt::format("{}: found {}, which {} would replace; expected a folder without files of such names; choose "
                        "another one with --out, or move them away",
                        dir.string(), names_of(dir, found), what));
}

void require_no_input(const std::string& option, const fs::path& out, const std::vector<fs::path>& inputs) {
    for (const fs::path& input : inputs)
        if (same_file(out, split_layer(input.string()).file))
            throw UserError(
                fmt::format("{} {}: found a file that this command reads; expected another name; choose one", option,
                            out.string()));
}

void prepare_run_folder(const fs::path& run_dir, const std::vector<fs::path>& inputs, Overwrite overwrite) {
    std::error_code failure;
    if (fs::exists(run_dir) && !fs::is_directory(run_dir)) throw trouble(run_dir, "this is a file");
    require_room_for_run(run_dir, inputs, overwrite);
    fs::create_directories(run_dir, failure);
    if (failure) throw trouble(run_dir, "cannot be made: " + failure.message());
    OtherFiles others = other_files(run_dir);
    const fs::path case_there = run_dir / "case.toml";
    if (!inputs.empty() && same_file(inputs[0], case_there)) others["case.toml"] = last_change(case_there);
    clear(run_dir, others, [](const ProductKind&) { return false; });
}

void clear_for_resume(const fs::path& run_dir) { clear(run_dir, other_files(run_dir), grows); }

std::function<void()> adding_to_files(const fs::path& run_dir) {
    return [run_dir, others = other_files(run_dir)] {
        Json record = json_in(run_dir / "run.json");
        if (!lists_files(record)) return;
        std::vector<std::string> made = record["files"];
        for (const fs::path& file : files_named_like_products(run_dir))
            if (!is_others(others, run_dir, file)) made.push_back(relative_to(run_dir, file));
        std::sort(made.begin(), made.end());
        made.erase(std::unique(made.begin(), made.end()), made.end());
        if (record["files"] == Json(made)) return;
        record["files"] = made;
        write_text(run_dir / "run.json", record.dump(2) + "\n");
    };
}

void add_to_files(const fs::path& run_dir, const std::function<void()>& work) {
    const std::function<void()> add = adding_to_files(run_dir);
    work();
    add();
}

OpenRecord::~OpenRecord() {
    static_assert(sizeof kRunning == sizeof kStopped, "the one takes the place of the other");
    std::fstream file(run_dir_ / "run.json", std::ios::in | std::ios::out | std::ios::binary);
    std::string begins(64, '\0');  // longer than the first line
    file.read(begins.data(), static_cast<std::streamsize>(begins.size()));
    const std::size_t at = begins.find(std::string("\"exit_reason\": \"") + kRunning);
    if (at == std::string::npos) return;
    file.clear();  // a short file ends before
    file.seekp(static_cast<std::streamoff>(begins.find(kRunning, at)));
    file << kStopped;
}

}  // namespace frana
