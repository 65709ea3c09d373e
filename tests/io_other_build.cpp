// The program beside a module of VTK that another build left.
#include <cstdlib>
#include <optional>

#include "plane_case.h"

using Catch::Contains;

namespace {

/// The loader looks there first, as long as it lives.
class ModuleFrom {
public:
    explicit ModuleFrom(const std::string& folder) {
        if (const char* const before = std::getenv(kName)) before_ = before;
        const auto bin = std::filesystem::read_symlink("/proc/self/exe").parent_path();
        REQUIRE(std::filesystem::exists(bin / folder / "frana_vtk.so"));
        setenv(kName, (bin / folder).c_str(), 1);
    }
    ~ModuleFrom() { before_ ? setenv(kName, before_->c_str(), 1) : unsetenv(kName); }
    ModuleFrom(const ModuleFrom&) = delete;
    ModuleFrom& operator=(const ModuleFrom&) = delete;

private:
    static constexpr const char* kName = "LD_LIBRARY_PATH";
    std::optional<std::string> before_;
};

}  // namespace

TEST_CASE("A module of VTK of another build is refused, and the results are kept", "[cli][figures]") {
    const std::string whose = GENERATE("older", "other");
    const PlaneCase scene;
    const ModuleFrom module(whose + "_build");
    const std::string complaint = "frana_vtk.so: found that of another build, ";
    const Outcome run = scene.frana("run CASE --out pictures --until 0.2 --set 'output.formats=[\"geotiff\",\"png\"]'");
    INFO(run.err);
    CHECK(run.code == 0);
    CHECK(std::filesystem::exists(scene.folder() / "pictures/rasters/peak_depth.tif"));
    CHECK_THAT(text_of(scene.folder() / "pictures/report.md"),
               Contains(complaint) && Contains("install it with the program"));
    const Outcome frames = scene.frana("run CASE --out frames --until 0.2 --set 'output.formats=[\"vtk\"]'");
    CHECK(frames.code == 2);
    CHECK_THAT(frames.err, Contains(complaint));
}
