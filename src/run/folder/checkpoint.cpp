#include "run/folder/checkpoint.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <exception>
#include <sstream>

#include "base/atomic_file.h"
#include "base/checksum.h"
#include "base/error.h"
#include "base/layer_name.h"
#include "base/on_threads.h"
#include "base/version.h"
#include "run/folder/input_sums.h"
#include "run/folder/run_folder.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

constexpr const char* kNotGiven = "not given";
constexpr const char* kWayOut = "or run with --overwrite instead of --resume to start at the beginning";

/// Whether two cases that differ in this key alone have the same states.
bool changes_nothing(const std::string& key) { return key == "output.checkpoint_minutes"; }

/// What a file holds is compared by its sum; where it lies says nothing, but its layer and its filter do.
std::string without_paths(const std::string& key, const std::string& value) {
    const Parameter* parameter = find_parameter(key);
    const bool may_be_path = parameter && names_files(parameter->kind);
    if (!may_be_path || value.find('"') == std::string::npos) return value;
    const std::size_t layer = std::min(value.find(kLayerMark), value.find(kFilterMark));
    return layer == std::string::npos ? "a file" : "a file" + value.substr(layer);
}

/// The resolved case as "key = value" by key; repeated tables are numbered.
std::map<std::string, std::string> keys_of(const std::string& resolved) {
    std::map<std::string, std::string> keys;
    std::map<std::string, int> counts;
    std::string table;
    std::istringstream lines(resolved);
    for (std::string line; std::getline(lines, line);) {
        if (line.empty() || line.front() == '#') continue;
        if (line.rfind("[[", 0) == 0) {
            const std::string name = line.substr(2, line.size() - 4);
            table = fmt::format("{}.{}.", name, counts[name]++);
            continue;
        }
        if (line.front() == '[') {
            table = line.substr(1, line.size() - 2) + ".";
            continue;
        }
        const std::size_t equals = line.find(" = ");
        const std::string mark = "  # default";
        if (line.size() > mark.size() && line.compare(line.size() - mark.size(), mark.size(), mark) == 0)
            line.resize(line.size() - mark.size());
        const std::string key = table + line.substr(0, equals);
        if (equals != std::string::npos && !changes_nothing(key))
            keys[key] = without_paths(key, line.substr(equals + 3));
    }
    return keys;
}

std::string case_text(const CaseFile& file) {
    std::string text;
    for (const auto& [key, value] : keys_of(resolved_toml(file))) text += fmt::format("{} = {}\n", key, value);
    return text;
}

std::string sum_of_bed(const Raster& bed) {
    const GridGeometry& grid = bed.geometry;
    Checksum sum;
    sum.add_all(
        std::array<double, 5>{grid.x0, grid.y0, grid.cell, static_cast<double>(grid.nx), static_cast<double>(grid.ny)});
    sum.add_all(bed.values);
    return fmt::format("{:016x}", sum.sum());
}

std::string sum_of_particles(const Scene& scene) {
    Checksum sum;
    for (const Seeds* of : scene.all_particles())
        for (const auto* array : {&of->x, &of->y, &of->vx, &of->vy, &of->volume, &of->depth, &of->size})
            sum.add_all(*array);
    return fmt::format("{:016x}", sum.sum());
}

/// "release.0.depth = 0123456789abcdef data/depth.tif" for each file that the case names: key, number among the files
/// of that key, sum, name.
std::string sums_of_inputs(const CaseFile& file) {
    std::string text;
    for (const InputSum& input : input_sums(file))
        text += fmt::format("{} = {} {}\n", input.key, input.sum, input.file.string());
    return text;
}

std::map<std::string, std::string> lines_of(const std::string& text) {
    std::map<std::string, std::string> keys;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
        if (const auto equals = line.find(" = "); equals != std::string::npos)
            keys[line.substr(0, equals)] = line.substr(equals + 3);
    return keys;
}

/// The case of a state that was left when choices had other words.
std::string in_todays_words(const std::string& text) {
    std::string result;
    for (const auto& [key, value] : lines_of(text)) {
        std::string now = value;
        if (const Parameter* parameter = find_parameter(key))
            for (const auto& [former, choice] : parameter->former)
                if (value == '"' + former + '"') now = '"' + choice + '"';
        result += fmt::format("{} = {}\n", key, now);
    }
    return result;
}

/// "material.bed.mu is 0.4 there and 0.5 here", the first key that differs.
std::string difference(const std::string& there, const std::string& here) {
    auto kept = lines_of(there), given = lines_of(here);
    for (const auto& [key, value] : given) kept.emplace(key, kNotGiven);
    for (const auto& [key, value] : kept) {
        const auto found = given.find(key);
        const std::string now = found == given.end() ? kNotGiven : found->second;
        if (now != value) return fmt::format("{} is {} there and {} here", key, value, now);
    }
    return "its keys differ";
}

/// Name of the first input that holds something else than it did, or empty.
std::string changed_input(const std::string& there, const std::string& here) {
    const auto kept = lines_of(there);
    for (const auto& [key, sum_and_name] : lines_of(here)) {
        const std::size_t space = sum_and_name.find(' ');
        const auto found = kept.find(key);
        if (found == kept.end() || found->second.compare(0, space + 1, sum_and_name, 0, space + 1) != 0)
            return sum_and_name.substr(space + 1);
    }
    return "";
}

std::string label(const CheckpointLabels& labels, const char* name) {
    const auto found = labels.find(name);
    return found == labels.end() ? kNotGiven : found->second;
}

void require_same(const fs::path& file, const CheckpointLabels& there, const CheckpointLabels& here) {
    const auto differs = [&](const char* name) { return label(there, name) != label(here, name); };
    const auto refused = [&](const std::string& what, const std::string& instead) {
        return UserError(fmt::format("{}: {}; {}, {}", file.string(), what, instead, kWayOut));
    };
    for (const char* name : {"version", "precision"})
        if (differs(name))
            throw refused(
                fmt::format("found a state of {} {}; expected {} {}", name, label(there, name), name,
                            label(here, name)),
                std::string(name) == "version" ? "use the program that left it" : "give scheme.precision as it was");
    if (const std::string its = in_todays_words(label(there, "case")); its != in_todays_words(label(here, "case")))
        throw refused("found the state of another case: " + difference(its, label(here, "case")),
                      "give the case and the --set it was left with");
    const std::string input = changed_input(label(there, "inputs"), label(here, "inputs"));
    if (!input.empty())
        throw refused(fmt::format("found a state from before the file {} was changed", input),
                      "put the file back as it was");
    if (differs("bed"))
        throw refused("found a state on another terrain: the elevations on the grid have changed since",
                      "put the elevation model back");
    if (differs("particles"))
        throw refused("found the state of another release: the particles at the start have changed since",
                      "put the files of the release back");
}

}  // namespace

CheckpointLabels checkpoint_labels(const Scene& scene, const CaseFile& file) {
    return {{"version", FRANA_VERSION},
            {"precision", scene.scheme.precision == Precision::single ? "float" : "double"},
            {"build",
             fmt::format("{}, {}, march {}, commit {}", FRANA_BUILD_TYPE, FRANA_COMPILER, FRANA_ARCH, FRANA_COMMIT)},
            {"case", case_text(file)},
            {"inputs", sums_of_inputs(file)},
            {"bed", sum_of_bed(scene.bed)},
            {"particles", sum_of_particles(scene)}};
}

std::unique_ptr<CheckpointFile> open_checkpoint(const fs::path& run_dir, const CheckpointLabels& labels) {
    auto file = std::make_unique<CheckpointFile>(run_dir / "checkpoint.h5");
    require_same(run_dir / "checkpoint.h5", file->labels(), labels);
    return file;
}

CheckpointKeeper::CheckpointKeeper(const fs::path& run_dir, CheckpointLabels labels,
                                   std::chrono::duration<double> interval, std::unique_ptr<CheckpointFile> from)
    : run_dir_(run_dir), labels_(std::move(labels)), interval_(interval), from_(std::move(from)) {
    if (from_ && label(from_->labels(), "build") != label(labels_, "build"))
        other_build_ = fmt::format("resumed by another build ({}; before: {}): up to round-off, not bit for bit",
                                   label(labels_, "build"), label(from_->labels(), "build"));
}

bool CheckpointKeeper::due() const {
    return interval_.count() > 0.0 && std::chrono::steady_clock::now() - last_ >= interval_;
}

void CheckpointKeeper::save(double time, const State& state) {
    try {
        flush_new_files();
        write_checkpoint(run_dir_ / "checkpoint.h5", labels_, [&](Archive& archive) {
            Progress now{time, progress_.written + 1, progress_.failed, progress_.first_failure, progress_.resumed_at};
            now.serialize(archive);
            state(archive);
        });
        ++progress_.written;
    } catch (const std::exception& error) {
        if (progress_.failed == 0) progress_.first_failure = fmt::format("t = {:.6g} s: {}", time, error.what());
        ++progress_.failed;
    }
    last_ = std::chrono::steady_clock::now();
}

bool CheckpointKeeper::load(const State& state) {
    if (!from_) return false;
    from_->load([&](Archive& archive) {
        progress_.serialize(archive);
        state(archive);
    });
    clear_for_resume(run_dir_);
    progress_.resumed_at.push_back(progress_.time);
    from_.reset();
    return true;
}

void CheckpointKeeper::Progress::serialize(Archive& archive) {
    const Archive::Part part(archive, "checkpoints");
    archive.number("time", time);
    archive.number("written", written);
    archive.number("failed", failed);
    archive.text("first_failure", first_failure);
    archive.array("resumed_at", resumed_at);
}

std::vector<std::string> CheckpointKeeper::warnings() const {
    std::vector<std::string> warnings;
    if (progress_.failed > 0)
        warnings.push_back(fmt::format("checkpoint: {} of {} could not be written, the first one at {}",
                                       progress_.failed, progress_.failed + progress_.written,
                                       progress_.first_failure));
    if (!other_build_.empty()) warnings.push_back(other_build_);
    return warnings;
}

/// A state that outlives a power cut is worth nothing without the frames that go with it. Each file waits for the disk. Disks
/// take several requests together in little more time than one.
void CheckpointKeeper::flush_new_files() {
    constexpr std::size_t kTogether = 16;
    const auto now = fs::file_time_type::clock::now();
    std::vector<fs::path> files;
    for (const fs::path& file : product_files(run_dir_)) {
        std::error_code gone;
        if (fs::last_write_time(file, gone) >= flushed_ && !gone) files.push_back(file);
    }
    std::atomic<std::size_t> next{0};
    std::vector<std::exception_ptr> failed(files.size());
    on_threads(std::min(kTogether, files.size()), [&] {
        for (std::size_t k = next++; k < files.size(); k = next++) try {
                flush_to_disk(files[k]);
            } catch (...) {
                failed[k] = std::current_exception();
            }
    });
    for (const std::exception_ptr& failure : failed)
        if (failure) std::rethrow_exception(failure);
    flushed_ = now;
}

}  // namespace frana
