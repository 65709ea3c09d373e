#pragma once
// The program on three small cases, as resume_runs and fault_runs disturb it, and what tells whether the files of two runs
// are the same. What tells of wall time is left out and nothing else: see without_wall_time().
#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace run_cases {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

inline void write(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::binary) << text; }

inline std::string text_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
}

/// The end of every case file: all kinds of series that a run can leave.
inline const char* const looks = R"(
[[profile]]
name = "down"
line = [[10, 52], [200, 48], [300, 90]]
[[gauge]]
name = "top"
point = [60, 60]
[[gauge]]
name = "foot"
point = [180.5, 71.25]
[[insitu]]
kind = "reduce"
name = "most"
fields = ["depth", "speed"]
every_steps = 3
[[insitu]]
kind = "contour"
name = "lines"
field = "depth"
levels = [0.2, 1.0]
every = 0.37
[[insitu]]
kind = "threshold"
name = "fast"
field = "speed"
of = "particles"
from = 4.0
[[insitu]]
kind = "profile"
name = "cut"
line = [[10, 40], [300, 80]]
fields = ["depth", "speed"]
every = 0.41
)";

struct Case {
    const char* name;
    const char* text;  ///< of the case file, without the looks
};

inline const Case cases[] = {{"voellmy", R"(
[terrain]
dem = "dem.asc"
[[release]]
outline = "release.geojson"
depth = 3.0
[particles]
per_cell = 4
placement = "r2"
[material.bed]
law = "voellmy"
friction_angle_deg = 12.0
xi = 500.0
[time]
end = 13.1
[output]
every = 0.6
formats = ["vtk", "xdmf", "geotiff"]
)"},
                             {"bingham_walls", R"(
[terrain]
dem = "dem.asc"
[[release]]
outline = "release.geojson"
depth = 3.0
[material.bed]
law = "coulomb"
friction_angle_deg = 8.0
[material.rheology]
law = "bingham"
viscosity = 50.0
yield_stress = 200.0
[boundary]
sides = "wall"
[time]
end = 9.0
[output]
every = 0.7
formats = ["xdmf"]
history = "output"
)"},
                             {"paper", R"(
[terrain]
dem = "dem.asc"
model = "shallow"
[[release]]
outline = "release.geojson"
depth = 3.0
[material.bed]
law = "voellmy"
friction_angle_deg = 30.0
xi = 200.0
[scheme]
preset = "paper"
[time]
end = 30.0
stop_at_rest = true
rest_fraction = 0.3
[output]
every = 0.5
formats = ["vtk"]
)"}};

/// A bumpy slope of 100 x 40 pixels of 4 m.
inline void make_case(const fs::path& folder, const Case& of) {
    fs::create_directories(folder);
    std::ostringstream dem;
    dem << "ncols 100\nnrows 40\nxllcorner 0\nyllcorner 0\ncellsize 4\nNODATA_value -9999\n";
    for (int row = 0; row < 40; ++row)
        for (int column = 0; column < 100; ++column)
            dem << 200.0 - 1.6 * column + 3.0 * std::sin(0.31 * column) * std::cos(0.23 * row)
                << (column < 99 ? ' ' : '\n');
    write(folder / "dem.asc", dem.str());
    write(folder / "release.geojson", R"({"type": "FeatureCollection", "features": [
        {"type": "Feature", "properties": {}, "geometry":
        {"type": "Polygon", "coordinates": [[[20, 30], [110, 40], [120, 100], [30, 110], [20, 30]]]}}]})");
    write(folder / "case.toml", std::string(of.text) + looks);
}

/// How the program ended.
struct Ending {
    int code = -1;  ///< its exit code, -1: a signal ended it
    int signal = 0;
    std::string errors;  ///< what it said on stderr
    double peak = 0.0;   ///< memory [bytes]
};

/// What else happens to a run.
struct Disturbance {
    std::function<void()> in_program = [] {};                       ///< before the program starts, in its process
    std::function<bool(pid_t)> ready = [](pid_t) { return true; };  ///< from then on the moment counts
    double moment = 1e9;                                            ///< [s]
    int signal = 0;                                                 ///< that may end it, besides
    std::function<void(pid_t)> at_moment = [](pid_t program) { ::kill(program, SIGKILL); };
};

/// The program on the case in `folder`, into folder/out.
class Runner {
public:
    Runner(fs::path frana, fs::path folder) : frana_(std::move(frana)), folder_(std::move(folder)) {}

    Ending run(bool resume, int threads, const Disturbance& disturbance) const {
        std::vector<std::string> words = {frana_.string(), "run", (folder_ / "case.toml").string(), "--quiet", "--out",
                                          (folder_ / "out").string(), "--threads", std::to_string(threads),
                                          // 20 ms: kills then lose little, and some fall into a checkpoint
                                          "--set", "output.checkpoint_minutes=0.00033"};
        words.push_back(resume ? "--resume" : "--overwrite");  // one that died early left a folder without a state
        const pid_t child = ::fork();
        if (child == 0) become(words, disturbance);
        auto start = Clock::now();
        int status = 0;
        rusage used{};
        bool ready = false, disturbed = false;
        while (::wait4(child, &status, WNOHANG, &used) == 0) {
            std::this_thread::sleep_for(std::chrono::microseconds(300));
            if (!ready && !(ready = disturbance.ready(child))) start = Clock::now();
            if (!ready || disturbed || std::chrono::duration<double>(Clock::now() - start).count() < disturbance.moment)
                continue;
            disturbance.at_moment(child);
            disturbed = true;
        }
        return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, WIFSIGNALED(status) ? WTERMSIG(status) : 0,
                text_of(folder_ / "err.txt"), 1024.0 * static_cast<double>(used.ru_maxrss)};
    }

    /// Without disturbance; throws what the program said when it fails.
    Ending run_well(bool resume, int threads) const {
        const Ending ending = run(resume, threads, {});
        if (ending.code != 0) throw std::runtime_error("the program failed: " + ending.errors);
        return ending;
    }

private:
    [[noreturn]] void become(std::vector<std::string>& words, const Disturbance& disturbance) const {
        std::vector<char*> arguments;
        for (std::string& word : words) arguments.push_back(word.data());
        arguments.push_back(nullptr);
        ::setenv("OMP_WAIT_POLICY", "passive", 1);  // two threads on a busy machine
        const int errors = ::open((folder_ / "err.txt").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
        if (errors >= 0) ::dup2(errors, STDERR_FILENO);
        disturbance.in_program();
        ::execv(arguments[0], arguments.data());
        ::_exit(127);
    }
    fs::path frana_, folder_;
};

/// A file's text without what depends on wall time, threads or how often a run was taken up.
inline std::string without_wall_time(const fs::path& file) {
    const std::string text = text_of(file);
    if (file.filename() == "run.json") {
        auto json = nlohmann::ordered_json::parse(text);
        for (const char* key :
             {"started", "ended", "wall_seconds", "particle_steps_per_second", "threads", "checkpoints"})
            if (json.erase(key) != 1) throw std::runtime_error(file.string() + ": has no " + key);
        return json.dump();
    }
    if (file.filename() != "report.md") return text;
    std::istringstream lines(text);
    std::string kept;
    bool times = false;
    for (std::string line; std::getline(lines, line);) {
        if (line.rfind("## ", 0) == 0) times = line == "## Wall time";
        if (!times && line.rfind("Case `", 0) != 0) kept += line + "\n";  // that line has the clock and the threads
    }
    return kept;
}

inline std::set<std::string> files_in(const fs::path& folder) {
    std::set<std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file()) files.insert(fs::relative(entry.path(), folder).generic_string());
    files.erase("checkpoint.h5");  // has wall times in it; that it is right is what the other files show
    return files;
}

/// Prints what differs; how many files were the same, or -1.
inline int compare(const fs::path& expected, const fs::path& found) {
    const std::set<std::string> names = files_in(expected), others = files_in(found);
    bool same = names == others;
    for (const std::string& name : others)
        if (names.count(name) == 0) std::printf("  %s: should not be there\n", name.c_str());
    for (const std::string& name : names) {
        if (others.count(name) == 0) {
            std::printf("  %s: is missing\n", name.c_str());
        } else if (without_wall_time(expected / name) != without_wall_time(found / name)) {
            std::printf("  %s: differs\n", name.c_str());
            same = false;
        }
    }
    return same ? static_cast<int>(names.size()) : -1;
}

}  // namespace run_cases
