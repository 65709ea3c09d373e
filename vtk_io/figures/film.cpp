#include "vtk_io/figures/film.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <vector>

#include "base/error.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

const char* const kLog = "ffmpeg.log";

/// The program in the folders of PATH; empty when there is none.
fs::path found_in_path(const char* program) {
    const char* folders = std::getenv("PATH");
    std::istringstream list(folders ? folders : "");
    for (std::string folder; std::getline(list, folder, ':');) {
        std::error_code failure;
        fs::path file = fs::absolute(folder.empty() ? "." : folder, failure) / program;
        if (!failure && fs::is_regular_file(file, failure) && access(file.c_str(), X_OK) == 0) return file;
    }
    return {};
}

/// The last line that was said into a log.
std::string last_words(const fs::path& log) {
    std::ifstream stream(log);
    std::string said;
    for (std::string line; std::getline(stream, line);)
        if (!line.empty()) said = line.substr(0, 300);
    return said.empty() ? "no reason given" : said;
}

/// Runs a program in a folder, without a shell. False with the reason unless it ends well.
bool run_in(const fs::path& folder, const fs::path& program, std::vector<std::string> words, std::string& why_not) {
    std::vector<char*> argv;
    argv.reserve(words.size() + 1);
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, kLog, O_WRONLY | O_CREAT | O_TRUNC, 0644);
    posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
    pid_t child = 0;
    const int failure = posix_spawn(&child, program.c_str(), &actions, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failure != 0) {
        why_not = fmt::format("{} cannot be started: {}", program.string(), std::strerror(failure));
        return false;
    }
    int status = -1;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    if (status != 0) why_not = fmt::format("{} failed: {}", program.string(), last_words(folder / kLog));
    return status == 0;
}

/// Names only: no path of the user's ever comes to the command line.
std::vector<std::string> command(const std::string& extension, double pictures_per_second) {
    std::vector<std::string> words = {"ffmpeg",       "-nostdin",
                                      "-hide_banner", "-loglevel",
                                      "error",        "-y",
                                      "-framerate",   fmt::format("{:.6g}", pictures_per_second),
                                      "-i",           "frame_%06d.png"};
    if (extension == ".gif")  // a palette of its own preserves the colours of the map
        for (const char* word : {"-filter_complex",
                                 "scale=w='min(iw,800)':h=-1:flags=lanczos,split[a][b];[a]palettegen[p];"
                                 "[b][p]paletteuse=dither=none"})
            words.push_back(word);
    else  // players need an even size, this pixel format, and stumble over very few pictures a second
        for (const char* word : {"-vf", "fps=25,pad=w=ceil(iw/2)*2:h=ceil(ih/2)*2:color=white", "-pix_fmt", "yuv420p",
                                 "-movflags", "+faststart"})
            words.push_back(word);
    words.push_back("film" + extension);
    return words;
}

}  // namespace

std::string no_film_reason() {
    if (!found_in_path("ffmpeg").empty()) return "";
    return "there is no program ffmpeg in PATH; install the package ffmpeg, then frana figures with --film makes it";
}

FilmReel::FilmReel(fs::path film) : film_(std::move(film)), folder_(fs::absolute(film_)) {
    expect(film_.extension() == ".mp4" || film_.extension() == ".gif", "a film that is neither MP4 nor GIF");
    folder_ += ".part";
    std::error_code failure;
    fs::remove_all(folder_, failure);  // of a program that was killed
    fs::create_directories(folder_, failure);
    if (failure)
        throw UserError(fmt::format("{}: cannot be made ({}); check the folder's permissions and free space",
                                    folder_.string(), failure.message()));
}

FilmReel::~FilmReel() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
}

fs::path FilmReel::next() { return folder_ / fmt::format("frame_{:06d}.png", pictures_++); }

bool FilmReel::join(double pictures_per_second, std::string& why_not) const {
    expect(pictures_ > 0 && pictures_per_second > 0.0, "a film without pictures");
    const fs::path program = found_in_path("ffmpeg");
    why_not = no_film_reason();
    if (program.empty()) return false;
    const std::string extension = film_.extension().string();
    if (!run_in(folder_, program, command(extension, pictures_per_second), why_not)) return false;
    std::error_code failure;
    fs::rename(folder_ / ("film" + extension), film_, failure);
    if (failure)
        throw UserError(fmt::format("{}: cannot be written ({}); check the folder's permissions and free space",
                                    film_.string(), failure.message()));
    return true;
}

}  // namespace frana
