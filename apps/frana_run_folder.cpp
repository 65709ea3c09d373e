#include "frana_run_folder.h"

#include <fmt/core.h>

#include <algorithm>
#include <functional>
#include <regex>

#include "base/atomic_file.h"
#include "base/error.h"

namespace frana {
namespace fs = std::filesystem;

const std::vector<ProductKind>& product_kinds() {
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
        {"rasters",
         "(peak_(depth|speed|pressure|dynamic_pressure)|arrival_time|final_(depth|velocity_[xy]))\\.tif",
         "GeoTIFF", false},
        {"", "footprint\\.geojson", "outline of everything ever covered", false},
        {"profiles", "[^.].*\\.csv", "the flow along a line, at every output", false},
        {"gauges", "[^.].*\\.csv", "the flow at a point, after every step", false},
        {"barriers", "[^.].*\\.csv", "forces and moments on a barrier, run-up and what went over, after every step", false},
        {"figures", "((map|view|section|filmstrip|profile|gauges|barrier|budget)_[^.].*|compare)\\.png", "figure", false},
        {"figures", "film_[^.].*\\.(mp4|gif)", "film", false},
        {"insitu", "[^.].*\\.csv", "looked at while the case ran", false},
        {"insitu", "[^.].*\\.pvd", "looked at while the case ran, for ParaView", false},
        {"insitu", "[^.].*\\.gpkg", "looked at while the case ran, for a GIS", false},
        {"insitu/*", "[^.].*_\\d+\\.(png|vtp|vtu)", "made while the case ran", true},
        {"states", ".*\\.pvsm", "ParaView state, File > Load State", false},
        {"states", "look\\.json", "colour ranges and cameras of the states", false},
        {"", "compare\\.(json|md)", "comparison with a survey", false},
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

std::vector<fs::path> files_in(const fs::path& folder, const ProductKind& kind) {
    const std::regex pattern(kind.pattern);
    std::vector<fs::path> found;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(folder, none))
        if (entry.is_regular_file() && std::regex_match(entry.path().filename().string(), pattern))
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
    return UserError(
        fmt::format("{}: {}; expected a folder that can be written to; choose another one with --out",
                    run_dir.string(), what));
}

/// Whether files of a kind are written while the run goes on, and not at its end.
bool grows(const ProductKind& kind) {
    for (const char* folder : {"particles", "grid", "profiles", "gauges", "barriers", "insitu", "insitu/*"})
        if (kind.folder == folder) return true;
    static const std::regex growing("(history|particles|grid|profiles|barrier|run|terrain|checkpoint|resolved).*");
    return kind.folder.empty() && std::regex_match(kind.pattern, growing);
}

/// A product that a killed process was writing when it died has a name like ".peak_depth.tmp4711.tif".
void remove_half_written(const fs::path& run_dir) {
    static const std::regex half_written("\\.(.*)\\.tmp\\d+(\\..*)?");
    std::error_code ignored;
    for (const ProductKind& kind : product_kinds()) {
        const std::regex product(kind.pattern);
        std::vector<fs::path> found;
        for (const fs::path& folder : folders_of(run_dir, kind))
            for (const auto& entry : fs::directory_iterator(run_dir / folder, ignored)) {
                const std::string name = entry.path().filename().string();
                std::smatch parts;
                if (std::regex_match(name, parts, half_written) &&
                    std::regex_match(parts[1].str() + parts[2].str(), product))
                    found.push_back(entry.path());
            }
        for (const fs::path& file : found) fs::remove(file, ignored);
    }
}

/// Marks the folder as that of a running case and removes all products but those of the kinds that stay.
void clear(const fs::path& run_dir, const std::function<bool(const ProductKind&)>& stays) {
    write_text(run_dir / "run.json",
               "{\"exit_reason\": \"running\"}\n");  // also shows that the folder is writable
    remove_half_written(run_dir);
    std::error_code failure;
    for (const ProductKind& kind : product_kinds())
        for (const fs::path& file : all_files_of(run_dir, kind)) {
            const std::string name = file.filename().string();
            if (name == "run.json" || name == "case.toml" || stays(kind)) continue;  // case.toml may be the case itself
            fs::remove(file, failure);
            if (failure)
                throw trouble(run_dir, fmt::format("{} of an earlier run cannot be removed: {}", name,
                                                   failure.message()));
        }
}

}  // namespace

std::vector<Product> products_in(const fs::path& run_dir) {
    std::vector<Product> products;
    for (const ProductKind& kind : product_kinds())
        for (const fs::path& folder : folders_of(run_dir, kind)) {
            const std::vector<fs::path> files = files_in(run_dir / folder, kind);
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
    std::vector<fs::path> all;
    for (const ProductKind& kind : product_kinds()) {
        const std::vector<fs::path> files = all_files_of(run_dir, kind);
        all.insert(all.end(), files.begin(), files.end());
    }
    return all;
}

void prepare_run_folder(const fs::path& run_dir) {
    std::error_code failure;
    if (fs::exists(run_dir) && !fs::is_directory(run_dir)) throw trouble(run_dir, "this is a file");
    fs::create_directories(run_dir, failure);
    if (failure) throw trouble(run_dir, "cannot be made: " + failure.message());
    clear(run_dir, [](const ProductKind&) { return false; });
}

void clear_for_resume(const fs::path& run_dir) {
    clear(run_dir, [](const ProductKind& kind) { return grows(kind); });
}

}  // namespace frana
