// Ctrl-C while pictures are drawn: an end within two seconds, a sentence, and a folder in order.
#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "catch.h"
#include "plane_case.h"
#include "vtk_io/figures/offscreen.h"
#include "vtk_io/figures/png_file.h"

namespace fs = std::filesystem;
using Catch::Contains;
using Clock = std::chrono::steady_clock;

namespace {

struct Ending {
    int code = -1;         ///< -1: a signal ended it
    double seconds = 0.0;  ///< from the signal on
    std::string errors;
};

/// Whether the program has a handler of its own for Ctrl-C; before it is loaded, the test's is there.
bool listens(pid_t process) {
    std::error_code gone;
    const fs::path running = fs::read_symlink("/proc/" + std::to_string(process) + "/exe", gone);
    if (running.filename() != "frana") return false;
    std::ifstream status("/proc/" + std::to_string(process) + "/status");
    for (std::string line; std::getline(status, line);)
        if (line.rfind("SigCgt:", 0) == 0) return (std::stoull(line.substr(7), nullptr, 16) >> (SIGINT - 1)) & 1;
    return false;
}

/// `frana ARGUMENTS` in a folder, with Ctrl-C as soon as `ready`.
Ending interrupted(const fs::path& folder, const std::string& arguments, const std::function<bool(pid_t)>& ready) {
    const std::string program = fs::read_symlink("/proc/self/exe").parent_path() / "frana";
    std::vector<std::string> words = {program};
    std::istringstream stream(arguments);
    for (std::string word; stream >> word;) words.push_back(word);
    const pid_t child = ::fork();
    if (child == 0) {
        std::vector<char*> list;
        for (std::string& word : words) list.push_back(word.data());
        list.push_back(nullptr);
        ::signal(SIGINT, SIG_DFL);  // a test in the background of a script ignores it
        const int errors = ::open((folder / "err.txt").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
        if (::chdir(folder.c_str()) != 0 || ::dup2(errors, STDERR_FILENO) < 0) ::_exit(126);
        ::execv(program.c_str(), list.data());
        ::_exit(127);
    }
    int status = 0;
    while (::waitpid(child, &status, WNOHANG) == 0 && !ready(child))
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const auto start = Clock::now();
    ::kill(child, SIGINT);
    ::waitpid(child, &status, 0);
    const std::chrono::duration<double> took = Clock::now() - start;
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, took.count(), text_of(folder / "err.txt")};
}

std::vector<fs::path> pictures_in(const fs::path& run_dir) {
    std::vector<fs::path> found;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(run_dir / "figures", none)) found.push_back(entry.path());
    return found;
}

/// Every file in figures/ is a whole picture, and run.json lists it.
void check_pictures(const fs::path& run_dir) {
    const auto listed = nlohmann::json::parse(text_of(run_dir / "run.json"))["files"];
    for (const fs::path& picture : pictures_in(run_dir)) {
        CAPTURE(picture.string());
        CHECK(frana::read_png(picture).width > 0);
        const std::string name = "figures/" + picture.filename().string();
        CHECK(std::find(listed.begin(), listed.end(), name) != listed.end());
    }
}

}  // namespace

TEST_CASE("Ctrl-C while a run draws its pictures leaves a whole run without the rest of them", "[cli][figures]") {
    if (!frana::no_renderer_reason().empty()) return;
    const PlaneCase scene;
    scene.write("[output]\nevery = 5.0\nformats = [\"vtk\", \"geotiff\", \"png\"]\n");
    const fs::path out = scene.folder() / "out";
    const Ending ending = interrupted(scene.folder(), "run " + scene.file().string() + " --quiet --out out",
                                      [&](pid_t) { return !pictures_in(out).empty(); });
    CHECK(ending.code == 130);
    CHECK(ending.seconds < 2.0);
    CHECK(ending.errors ==
          "interrupted while pictures were drawn; all else of the run is in out; `frana figures out` "
          "draws the pictures\n");
    const auto record = nlohmann::json::parse(text_of(out / "run.json"));
    CHECK(record["exit_reason"] != "running");
    CHECK_THAT(text_of(out / "report.md"), Contains("interrupted while pictures were drawn; `frana figures out`"));
    check_pictures(out);
    const std::size_t some = pictures_in(out).size();
    REQUIRE(scene.frana("figures out --size 300x300").code == 0);
    CHECK(pictures_in(out).size() > some);
    check_pictures(out);
}

TEST_CASE("Ctrl-C ends frana figures although a picture takes longer", "[cli][figures]") {
    if (!frana::no_renderer_reason().empty()) return;
    const PlaneCase scene;
    scene.write("[output]\nevery = 5.0\nformats = [\"vtk\", \"geotiff\"]\n");
    REQUIRE(scene.frana("run CASE --quiet --out out").code == 0);
    // Half a minute a picture: none is whole when the signal comes.
    const std::string size = GENERATE("16000x16000", "400x400");
    CAPTURE(size);
    const Ending ending = interrupted(scene.folder(), "figures out --size " + size, listens);
    CHECK(ending.code == 130);
    CHECK(ending.seconds < 2.0);
    CHECK(ending.errors == "interrupted; the pictures that are there are whole; `frana figures out` draws all again\n");
    check_pictures(scene.folder() / "out");
}
