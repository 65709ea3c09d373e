#include <set>

#include "base/error.h"
#include "catch.h"
#include "frana_run_folder.h"
#include "fresh_folder.h"

using namespace frana;
namespace fs = std::filesystem;

namespace {

void touch(const fs::path& file) {
    fs::create_directories(file.parent_path());
    std::ofstream(file) << "text";
}

}  // namespace

TEST_CASE("preparing a run folder removes the files of an earlier run and nothing else") {
    const FreshFolder folder;
    const std::vector<std::string> ours = {"report.md",
                                           "history.csv",
                                           "grid.pvd",
                                           "particles/particles_000099.vtp",
                                           "run.h5",
                                           "profiles/x675.csv",
                                           "figures/map_peak_depth.png",
                                           "rasters/peak_depth.tif",
                                           "footprint.geojson",
                                           "compare.json"};
    const std::vector<std::string> theirs = {"notes.txt",
                                             "figures/mine.png",
                                             "rasters/dem.tif",
                                             "case.toml",
                                             "particles/particles_best.vtp",
                                             "profiles/.hidden.csv"};
    for (const auto& names : {ours, theirs})
        for (const std::string& name : names) touch(folder.path() / name);
    prepare_run_folder(folder.path());
    for (const std::string& name : ours) CHECK_FALSE(fs::exists(folder.path() / name));
    for (const std::string& name : theirs) CHECK(fs::exists(folder.path() / name));
}

TEST_CASE("a run folder that is a file is refused with a way out") {
    const FreshFolder folder;
    touch(folder.path() / "out");
    CHECK_THROWS_WITH(prepare_run_folder(folder.path() / "out"),
                      Catch::Contains("this is a file") && Catch::Contains("--out"));
    CHECK_THROWS_AS(prepare_run_folder(folder.path() / "out" / "deeper"), UserError);
    CHECK(text_of(folder.path() / "out") == "text");
}

TEST_CASE("products are listed by name, frames by their folder and number") {
    const FreshFolder folder;
    for (const char* name : {"grid/grid_000000.vti", "grid/grid_000001.vti", "rasters/final_depth.tif",
                             "run.xdmf", "run.h5", "stranger.txt"})
        touch(folder.path() / name);
    const std::vector<Product> products = products_in(folder.path());
    REQUIRE(products.size() == 4);
    CHECK(products[0].path == "grid/");
    CHECK(products[0].files == 2);
    CHECK(products[1].path == "run.h5");
    CHECK(products[2].path == "run.xdmf");
    CHECK(products[3].path == "rasters/final_depth.tif");
    CHECK(products_in(folder.path() / "nothing").empty());
}
