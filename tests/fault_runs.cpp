// fault_runs FRANA FOLDER CLOCK_JUMP: what a machine can do to a run. Each fault must end in exit code 2 with one
// sentence on stderr that names the file or the limit (or in a whole run, where the fault hits nothing), never in a
// crash or in 1 (Ctrl-C and SIGTERM: in 130), and the run that follows without the fault (resumed where a state was
// left) must leave the files of an undisturbed run, byte for byte. Prints a table. Where the system does not let it
// mount a small disk, that fault is said to be skipped.
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <algorithm>
#include <ctime>
#include <map>
#include <set>

#include "run_cases.h"

namespace {

using namespace run_cases;

struct Tally {
    int tried = 0, whole = 0, refused = 0, bad = 0;
};

class Faults {
public:
    Faults(const fs::path& frana, const fs::path& folder, const Case& of) : folder_(folder), runner_(frana, folder) {
        fs::remove_all(folder);
        make_case(folder, of);
        const auto start = Clock::now();
        const double peak = runner_.run_well(false, 1).peak;
        wall_ = std::chrono::duration<double>(Clock::now() - start).count();
        fs::rename(out(), folder / "undisturbed");
        check_forecast(frana, peak);
    }
    fs::path out() const { return folder_ / "out"; }
    fs::path undisturbed() const { return folder_ / "undisturbed"; }
    double wall() const { return wall_; }

    /// One try. `mend` makes the machine well again before the run that follows.
    void attempt(
        const std::string& fault, const Disturbance& disturbance, const std::function<void()>& mend = [] {},
        const std::set<int>& expected = {}) {
        const Ending ending = runner_.run(false, 1, disturbance);
        Tally& tally = tallies_[fault];
        ++tally.tried;
        if (ending.code == 127) {  // the loader found no room for the libraries: nothing began
            --tally.tried;
            mend();
            return;
        }
        const bool refused = ending.code == 2 && says_why(ending.errors);
        // The signal may come when all is written and nobody listens any more.
        const bool late = ending.signal != 0 && ending.signal == disturbance.signal && is_whole();
        const bool whole = ending.code == 0 || late;
        const bool good = late || (expected.empty() ? ending.code == 0 || refused : expected.count(ending.code) > 0);
        ++(good ? whole ? tally.whole : tally.refused : tally.bad);
        if (!good)
            std::printf("%s: exit %d, signal %d, said: %s\n", fault.c_str(), ending.code, ending.signal,
                        ending.errors.c_str());
        else if (said_.insert(fault + ending.errors.substr(0, 60)).second && !ending.errors.empty())
            std::printf("%s: %s", fault.c_str(), ending.errors.c_str());
        mend();
        runner_.run_well(fs::exists(out() / "checkpoint.h5"), 2);
        if (compare(undisturbed(), out()) < 0) {
            ++tally.bad;
            std::printf("%s: the run that followed left other files\n", fault.c_str());
        }
        empty(out());
        std::fflush(stdout);
    }
    /// `frana check` says how much memory a run will need: within 20 % of what it took.
    void check_forecast(const fs::path& frana, double peak) {
        const fs::path said = folder_ / "check.txt";
        const std::string call = "'" + frana.string() + "' check '" + (folder_ / "case.toml").string() + "' > '";
        if (std::system((call + said.string() + "'").c_str()) != 0) throw std::runtime_error("frana check failed");
        const std::string text = text_of(said), words = "memory      about ";
        const double foretold = 1e6 * std::stod(text.substr(text.find(words) + words.size()));
        std::printf("memory foretold %.0f MB, taken %.0f MB\n", foretold / 1e6, peak / 1e6);
        Tally& tally = tallies_["memory foretold within 20 %"];
        ++tally.tried;
        ++(std::abs(foretold / peak - 1.0) <= 0.2 ? tally.whole : tally.bad);
    }
    /// The folder itself stays where it is a mount point.
    static void empty(const fs::path& folder) {
        std::error_code ignored;
        for (const auto& entry : fs::directory_iterator(folder, ignored)) fs::remove_all(entry.path());
    }
    /// Prints the table; how many tries went wrong.
    int print() const {
        int bad = 0;
        std::printf("\n%-44s %6s %6s %8s %5s\n", "fault", "tried", "whole", "refused", "bad");
        for (const auto& [fault, t] : tallies_) {
            std::printf("%-44s %6d %6d %8d %5d\n", fault.c_str(), t.tried, t.whole, t.refused, t.bad);
            bad += t.bad;
            if (t.refused == 0 && must_refuse_.count(fault) > 0) {
                std::printf("  not one was refused: the fault does not reach the program\n");
                ++bad;
            }
        }
        return bad;
    }

private:
    /// A sentence that names the file or the limit, and is not the text of a crash.
    bool says_why(const std::string& errors) const {
        const bool names = errors.find(out().filename().string() + "/") != std::string::npos ||
                           errors.find("memory") != std::string::npos || errors.find("checkpoint") != std::string::npos;
        return names && errors.size() > 20 && std::count(errors.begin(), errors.end(), '\n') <= 3 &&
               errors.find("std::") == std::string::npos && errors.find("nternal") == std::string::npos;
    }
    bool is_whole() const { return fs::exists(out() / "run.json") && compare(undisturbed(), out()) >= 0; }
    fs::path folder_;
    Runner runner_;
    double wall_ = 0.0;
    std::map<std::string, Tally> tallies_;
    std::set<std::string> said_;
    const std::set<std::string> must_refuse_ = {"files may not grow beyond a size", "the disk is full", "little memory",
                                                "Ctrl-C or SIGTERM"};
};

void limit(decltype(RLIMIT_FSIZE) resource, rlim_t bytes) {
    const rlimit both{bytes, bytes};
    ::setrlimit(resource, &both);
}

/// No file may grow beyond sizes from 1 kB (stderr is a file too) to the largest one's.
void small_files(Faults& faults) {
    std::uintmax_t largest = 0;
    for (const auto& entry : fs::recursive_directory_iterator(faults.undisturbed()))
        if (entry.is_regular_file()) largest = std::max(largest, entry.file_size());
    for (double share = 1.0; share * static_cast<double>(largest) > 1000.0; share *= 0.45) {
        Disturbance full;
        full.in_program = [bytes = static_cast<rlim_t>(share * static_cast<double>(largest)) - 1] {
            ::signal(SIGXFSZ, SIG_IGN);
            limit(RLIMIT_FSIZE, bytes);
        };
        faults.attempt("files may not grow beyond a size", full);
    }
}

/// A disk of its own for the run's folder, full after a share of what the run needs.
void small_disk(Faults& faults) {
    std::uintmax_t total = 0;
    for (const auto& entry : fs::recursive_directory_iterator(faults.undisturbed()))
        if (entry.is_regular_file()) total += (entry.file_size() + 4095) / 4096 * 4096;
    fs::create_directories(faults.out());
    struct Unmounted {
        fs::path at;
        ~Unmounted() { ::umount2(at.c_str(), MNT_DETACH); }
    } const unmounted{faults.out()};
    const auto mount = [&](unsigned long flags, std::uintmax_t bytes) {
        return ::mount("frana", faults.out().c_str(), "tmpfs", flags, ("size=" + std::to_string(bytes)).c_str()) == 0;
    };
    if (!mount(0, 4096)) {
        std::printf("a disk that is full: skipped, since this system does not let the test mount one\n");
        return;
    }
    for (int n = 0; n < 14; ++n) {
        mount(MS_REMOUNT, 4096 + total * static_cast<std::uintmax_t>(n) / 12);
        faults.attempt("the disk is full", {}, [&] { mount(MS_REMOUNT, 10 * total + (1u << 24)); });
    }
}

void folder_removed(Faults& faults) {
    for (const double share : {0.3, 0.5, 0.7, 0.9}) {
        Disturbance removed;
        removed.moment = share * faults.wall();
        removed.at_moment = [&](pid_t) {
            std::error_code ignored;
            fs::rename(faults.out(), faults.out().string() + "_gone", ignored);
        };
        faults.attempt("the run's folder is taken away", removed,
                       [&] { fs::remove_all(faults.out().string() + "_gone"), fs::remove_all(faults.out()); });
    }
}

void little_memory(Faults& faults) {
    for (const rlim_t megabytes : {60, 120, 180, 220, 228, 236, 244, 260, 300, 500, 1000}) {
        Disturbance little;
        little.in_program = [megabytes] { limit(RLIMIT_AS, megabytes << 20); };
        faults.attempt("little memory", little);
    }
}

void closed_streams(Faults& faults) {
    Disturbance closed;
    closed.in_program = [] { ::close(STDOUT_FILENO), ::close(STDIN_FILENO); };
    faults.attempt("no stdin and stdout", closed, [] {}, {0});
    Disturbance full;
    full.in_program = [] { ::dup2(::open("/dev/full", O_WRONLY), STDOUT_FILENO); };
    faults.attempt("stdout is full", full, [] {}, {0});
}

/// Before main() has begun a signal ends any program; on a busy machine libraries take a while to load.
bool catches(pid_t program, int number) {
    std::istringstream status(text_of("/proc/" + std::to_string(program) + "/status"));
    for (std::string line; std::getline(status, line);)
        if (line.rfind("SigCgt:", 0) == 0) return std::stoull(line.substr(7), nullptr, 16) >> (number - 1) & 1;
    return false;
}

void signals(Faults& faults) {
    for (const int number : {SIGINT, SIGTERM})
        for (const double share : {0.2, 0.5, 0.8}) {
            Disturbance signalled;
            signalled.ready = [number](pid_t program) { return catches(program, number); };
            signalled.moment = share * faults.wall();
            signalled.signal = number;
            signalled.at_moment = [number](pid_t program) { ::kill(program, number); };
            faults.attempt("Ctrl-C or SIGTERM", signalled, [] {}, {130, 0});  // 0: it was done by then
        }
}

/// The wall clock is set while the program runs: nothing but the times of day in its report may differ.
void clock_jumps(Faults& faults, const std::string& preloaded) {
    Disturbance jumps;
    jumps.in_program = [&] { ::setenv("LD_PRELOAD", preloaded.c_str(), 1); };
    const auto look = [&] {
        const std::string started = nlohmann::json::parse(text_of(faults.out() / "run.json")).at("started");
        const std::time_t now = std::time(nullptr);
        char today[16];
        std::strftime(today, sizeof today, "%Y-%m-%d", std::gmtime(&now));
        if (started.rfind(today, 0) == 0) throw std::runtime_error("the clock's jumps do not reach the program");
        if (compare(faults.undisturbed(), faults.out()) < 0)
            throw std::runtime_error("a run whose wall clock jumps leaves other files");
    };
    faults.attempt("the wall clock jumps", jumps, look, {0});
}

}  // namespace

int main(int count, char** words) try {
    if (count < 4) throw std::runtime_error("usage: fault_runs FRANA FOLDER CLOCK_JUMP");
    const fs::path frana = fs::absolute(words[1]);
    // A name with blanks and letters beyond ASCII, as people have them.
    Faults faults(frana, fs::absolute(words[2]) / "frana più 滑り", cases[0]);
    small_files(faults);
    small_disk(faults);
    folder_removed(faults);
    little_memory(faults);
    closed_streams(faults);
    signals(faults);
    clock_jumps(faults, fs::absolute(words[3]).string());
    return faults.print() == 0 ? 0 : 1;
} catch (const std::exception& error) {
    std::fprintf(stderr, "fault_runs: %s\n", error.what());
    return 2;
}
