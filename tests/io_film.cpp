// Films: made by ffmpeg without a shell, read back by ffmpeg, and missing without harm.
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/atomic_file.h"
#include "catch.h"
#include "fake_scene.h"
#include "fresh_folder.h"
#include "io_figures_scene.h"
#include "run/folder/run_folder.h"
#include "run/folder/run_job.h"
#include "scene/case_file.h"
#include "vtk_io/figures/canvas.h"
#include "vtk_io/figures/film.h"

using namespace frana;
namespace fs = std::filesystem;

namespace {

/// PATH for the time of a test.
class Path {
public:
    explicit Path(const fs::path& folder) : before_(std::getenv("PATH")) { ::setenv("PATH", folder.c_str(), 1); }
    ~Path() { ::setenv("PATH", before_.c_str(), 1); }

private:
    std::string before_;
};

bool cannot_film() {
    const std::string reason = no_film_reason();
    if (!reason.empty()) WARN("no films here (" << reason << "); this test is skipped");
    return !reason.empty() || figures::cannot_draw();
}

/// A picture of one colour with odd sides, which MP4 does not like.
void paint(const fs::path& png, const Colour& colour) {
    Canvas canvas;
    canvas.fill(Rectangle{0, 0, 401, 301}, colour);
    Pixels picture(401, 301);
    canvas.paint(picture);
    write_png(picture, png);
}

/// A picture of a film by its number, taken out by ffmpeg's own reader.
Pixels picture_of(const fs::path& film, int number, const fs::path& folder) {
    const fs::path copy = folder / ("copy" + film.extension().string()), png = folder / "read.png";
    fs::copy_file(film, copy, fs::copy_options::overwrite_existing);  // a plain name, for the shell
    fs::remove(png);
    const std::string line =
        fmt::format("cd {} && ffmpeg -loglevel error -nostdin -y -i {} -vf 'select=eq(n\\,{})' -frames:v 1 read.png",
                    folder.string(), copy.filename().string(), number);
    REQUIRE(std::system(line.c_str()) == 0);
    return read_png(png);
}

RunRecord run_with_film(const fs::path& dir) {
    FakeSimulation simulation;
    Scene scene = fake_scene(simulation);
    scene.output.xdmf = scene.output.geotiff = scene.output.png = false;
    scene.output.film = "mp4";
    prepare_run_folder(dir);
    const CaseFile file =
        CaseFile::parse("[terrain]\ndem = \"dem.tif\"\n[[release]]\ndepth = 2\n[time]\nend = 2\n", "hill/case.toml");
    std::ostringstream stream;
    Progress progress(stream, Progress::Style::silent, scene.density);
    return carry_out(scene, simulation, dir, begin_record(scene, file), Interrupt(), progress);
}

}  // namespace

TEST_CASE("a film holds its pictures in their order, whatever its folder is called", "[film]") {
    if (cannot_film()) return;
    const FreshFolder folder, plain;
    const fs::path odd = folder.path() / "it's a \"film\" %d; $(touch no) -y";
    fs::create_directories(odd);
    const Colour colours[] = {{200, 40, 40}, {40, 160, 40}, {40, 40, 200}};
    for (const char* name : {"film.mp4", "film.gif"}) {
        INFO(name);
        const fs::path film = odd / name;
        {
            FilmReel reel(film);
            for (const Colour& colour : colours) paint(reel.next(), colour);
            std::string why_not;
            REQUIRE(reel.join(2.0, why_not));
        }
        CHECK(std::distance(fs::directory_iterator(odd), fs::directory_iterator()) ==
              (film.extension() == ".mp4" ? 1 : 2));
        for (int k = 0; k < 3; ++k) {
            const bool mp4 = film.extension() == ".mp4";  // 25 pictures a second, of which 12 or 13 are the same
            const Pixels picture = picture_of(film, mp4 ? 5 + 25 * k / 2 : k, plain.path());
            CHECK(picture.width == (mp4 ? 402 : 401));
            // the colours of a film are rounded to its own (YUV in 8 bits): a few units
            CHECK(figures::distance(picture.at(200, 150), colours[k]) <= 6);
        }
    }
    CHECK_FALSE(fs::exists("no"));
}

TEST_CASE("an ffmpeg that fails is quoted, and nothing is left of the film", "[film]") {
    const FreshFolder folder, programs;
    write_text(programs.path() / "ffmpeg", "#!/bin/sh\necho first\necho No space left on device\nexit 1\n");
    fs::permissions(programs.path() / "ffmpeg", fs::perms::owner_all);
    const Path path(programs.path());
    std::string why_not;
    {
        FilmReel reel(folder.path() / "film.gif");
        write_text(reel.next(), "no picture");
        CHECK_FALSE(reel.join(2.0, why_not));
    }
    CHECK(why_not == (programs.path() / "ffmpeg").string() + " failed: No space left on device");
    CHECK(fs::is_empty(folder.path()));
}

TEST_CASE("a run makes its film", "[film]") {
    if (cannot_film()) return;
    const FreshFolder folder, plain;
    const RunRecord record = run_with_film(folder.path());
    REQUIRE(record.figures.size() == 1);
    CHECK(record.figures[0].path == "figures/film_depth.mp4");
    CHECK(std::distance(fs::directory_iterator(folder.path() / "figures"), fs::directory_iterator()) == 1);
    CHECK(text_of(folder.path() / "report.md").find("[depth through time](figures/film_depth.mp4)") !=
          std::string::npos);
    // five outputs at two pictures a second
    const Pixels first = picture_of(folder.path() / "figures/film_depth.mp4", 5, plain.path());
    const Pixels last = picture_of(folder.path() / "figures/film_depth.mp4", 55, plain.path());
    const auto middle = [](const Pixels& picture) {
        Vec2 sum(0, 0);
        double count = 0.0;
        for (int y = 0; y < picture.height; ++y)
            for (int x = 0; x < picture.width * 9 / 10; ++x)  // without the colour bar
                if (figures::saturation(picture.at(x, y)) > 60) sum += Vec2(x, y), count += 1.0;
        REQUIRE(count > 1000.0);
        return Vec2(sum / count);
    };
    const Vec2 moved = middle(last) - middle(first);  // (3, -1) m
    CHECK(moved.x() > 20.0);
    CHECK(moved.y() / moved.x() == Approx(-1.0 / 3.0).margin(0.05));
}

TEST_CASE("without ffmpeg a run goes on and says so once", "[film]") {
    const FreshFolder folder, empty;
    const Path path(empty.path());
    const RunRecord record = run_with_film(folder.path());
    CHECK(record.summary.reason == "end");
    CHECK(record.figures.empty());
    int warnings = 0;
    for (const std::string& warning : record.warnings)
        if (warning ==
            "figures/film_depth.mp4 was not drawn: there is no program ffmpeg in PATH; install the package "
            "ffmpeg, then frana figures with --film makes it")
            ++warnings;
    CHECK(warnings == 1);
    CHECK(fs::is_empty(folder.path() / "figures"));
}
