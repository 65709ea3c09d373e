#include "fake_gis.h"
#include "fuzz/answers.h"
#include "fuzz/targets.h"
#include "scene/build_scene.h"
#include "scene/case_file.h"

namespace frana::fuzz {
namespace {

/// A slope of 24 x 20 nodes, an outline and a depth.
const FakeGis& slope() {
    static const FakeGis gis = [] {
        FakeGis made;
        const GridGeometry grid{24, 20, 2.5, 2.5, 5.0};
        made.rasters["dem.tif"] = sampled(grid, [](double x, double y) { return 100.0 + 0.4 * x - 0.1 * y; });
        made.rasters["dem.tif"].source = "dem.tif";
        made.rasters["depth.tif"] = sampled(grid, [](double x, double) { return x > 60 ? 1.5 : Raster::nodata; });
        made.polygons["release.geojson"] = rectangle(40, 40, 80, 70);
        return made;
    }();
    return gis;
}

/// Without the marks of defaults, which a case in full has none of.
std::string unremarked(std::string text) {
    const std::string mark = "# default";
    for (auto at = text.find(mark); at != std::string::npos; at = text.find(mark, at)) {
        const auto from = text.find_last_not_of(' ', at - 1) + 1;
        text.erase(from, at + mark.size() - from);
    }
    return text;
}

/// What may take minutes or all memory because the case asks for it is no finding.
bool small(const CaseFile& file) { return !file.has("particles.count") || file.number("particles.count") < 1e5; }

}  // namespace

void case_file(const Input& bytes) {
    refused_fairly([&] {
        const CaseFile file = CaseFile::parse(bytes, "folder/case.toml");
        if (!small(file)) return;
        const BuiltScene built = build_scene_in_detail(file, slope());
        if (built.scene.particles.count() <= 0) throw std::logic_error("a scene without particles");
        const std::string resolved = resolved_toml(file);
        if (unremarked(resolved_toml(CaseFile::parse(resolved, "folder/case.toml"))) != unremarked(resolved))
            throw std::logic_error("the resolved case reads as another one");
    });
}

}  // namespace frana::fuzz
