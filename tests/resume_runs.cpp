// resume_runs FRANA FOLDER [KILLS [SEED]]: kills runs with SIGKILL at random moments, resumes them until they are
// finished, and holds every file they leave against that of a run that nobody disturbed, byte for byte. KILLS are spread
// over three cases (default 6); every resumed run changes between one and two threads.
#include <algorithm>
#include <random>

#include "run_cases.h"

namespace {

using namespace run_cases;

/// Kills and resumes until a run is finished; how many kills that took.
int disturbed_run(const Runner& runner, const fs::path& out, double wall, std::mt19937& random, int most) {
    fs::remove_all(out);
    std::uniform_real_distribution<double> share(0.0, 1.0);
    int kills = 0, resumed = 0;
    for (int attempt = 0;; ++attempt) {
        const bool resume = fs::exists(out / "checkpoint.h5");
        // Some die while they start, some at the very end, most in between.
        const double patience = kills < most ? wall * share(random) * (share(random) < 0.7 ? 0.6 : 1.2) : 1e9;
        resumed += resume;
        Disturbance kill;
        kill.moment = patience;
        const Ending ending = runner.run(resume, 1 + attempt % 2, kill);
        if (ending.code == 0) break;
        if (ending.signal != SIGKILL) throw std::runtime_error("the program failed: " + ending.errors);
        ++kills;
    }
    std::printf("  %d kills, %d times resumed\n", kills, resumed);
    return kills;
}

}  // namespace

int main(int count, char** words) try {
    if (count < 3) throw std::runtime_error("usage: resume_runs FRANA FOLDER [KILLS [SEED]]");
    const int wanted = count > 3 ? std::atoi(words[3]) : 6;
    const unsigned seed = count > 4 ? static_cast<unsigned>(std::atoi(words[4])) : 1;
    std::mt19937 random(seed);
    int kills = 0, failures = 0, number = 0;
    for (const Case& of : cases) {
        const fs::path folder = fs::absolute(fs::path(words[2]) / of.name), out = folder / "out";
        fs::remove_all(folder);
        make_case(folder, of);
        const Runner runner(fs::absolute(words[1]), folder);
        const auto start = Clock::now();
        runner.run_well(false, 1);
        const double wall = std::chrono::duration<double>(Clock::now() - start).count();
        fs::rename(out, folder / "undisturbed");
        const int share = wanted * (number + 1) / 3 - wanted * number / 3;
        std::printf("%s: %.2f s undisturbed\n", of.name, wall);
        for (int done = 0; done < share;) {
            const int now = disturbed_run(runner, out, wall, random, share - done);
            const int same = compare(folder / "undisturbed", out);
            if (same < 0) {
                ++failures;
                fs::rename(out, folder / ("different_" + std::to_string(failures)));
            } else {
                std::printf("  %d files, all the same\n", same);
            }
            done += now;
            kills += now;
            std::fflush(stdout);
        }
        ++number;
    }
    std::printf("%d kills (seed %u), %d runs that differ\n", kills, seed, failures);
    return failures == 0 ? 0 : 1;
} catch (const std::exception& error) {
    std::fprintf(stderr, "resume_runs: %s\n", error.what());
    return 2;
}
