// Layer "release" of results.gpkg: masks, overlapping polygons and lakes beside releases.
#include <nlohmann/json.hpp>

#include "catch.h"
#include "plane_case.h"
#include "read_layer.h"

using namespace frana;
namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

constexpr double kExact = 1e-12;  // sums of a few products in double precision

/// Pixels of 5 m with 1 in columns and rows of a box, counted from the south-west, the last ones included.
std::string mask_text(int i0, int j0, int i1, int j1) {
    std::string text = "ncols 30\nnrows 20\nxllcorner 0\nyllcorner 0\ncellsize 5\nNODATA_value -9999\n";
    for (int j = 19; j >= 0; --j)
        for (int i = 0; i < 30; ++i)
            text += std::string(i >= i0 && i <= i1 && j >= j0 && j <= j1 ? "1" : "0") + (i < 29 ? " " : "\n");
    return text;
}

/// The rows of that layer after a run with the releases, and what else is in the case.
class ReleaseRows {
public:
    ReleaseRows(const PlaneCase& plane, const std::string& releases, const std::string& rest) {
        write_text(plane.file(), "[terrain]\ndem = \"dem.asc\"\n" + releases + "[time]\nend = 2\n" + rest +
                                     "[output]\nevery = 2\nformats = [\"geotiff\"]\n");
        const fs::path dir = plane.folder() / "out";
        const Outcome run = plane.frana("run CASE --quiet --overwrite --out " + dir.string());
        INFO(run.err);
        REQUIRE(run.code == 0);
        record = Json::parse(text_of(dir / "run.json"));
        const Layer layer(dir / "results.gpkg", "release");
        for (OGRFeatureUniquePtr& row : layer.get()) rows_.push_back(std::move(row));
    }
    std::size_t size() const { return rows_.size(); }
    double number(std::size_t row, const char* field) const { return rows_.at(row)->GetFieldAsDouble(field); }
    bool has(std::size_t row, const char* field) const {
        return rows_.at(row)->IsFieldSetAndNotNull(rows_.at(row)->GetFieldIndex(field)) != 0;
    }
    double drawn_area(std::size_t row) const { return rows_.at(row)->GetGeometryRef()->toPolygon()->get_Area(); }

    Json record;

private:
    std::vector<OGRFeatureUniquePtr> rows_;
};

}  // namespace

// Their pixels were those of arrival at t = 0, with what the flow covers around them; later ones were missing.
TEST_CASE("Masks of releases are rows of a GIS as outlines are, those that enter later too", "[program][late][gis]") {
    const PlaneCase plane;
    write_text(plane.folder() / "first.asc", mask_text(4, 5, 9, 9));
    write_text(plane.folder() / "later.asc", mask_text(14, 5, 15, 8));
    write_text(plane.folder() / "never.asc", mask_text(20, 17, 20, 17));
    const std::string later = "[[release]]\nmask = \"later.asc\"\ndepth = 2\nat = 1\n",
                      never = "[[release]]\nmask = \"never.asc\"\ndepth = 2\nwhen_hit = true\n";
    const ReleaseRows rows(plane, "[[release]]\nmask = \"first.asc\"\ndepth = 1.5\n" + later + never, "");
    REQUIRE(rows.size() == 3);
    const double areas[] = {30 * 25.0, 8 * 25.0, 25.0}, depths[] = {1.5, 2.0, 2.0};
    for (std::size_t n = 0; n < 3; ++n) {
        CAPTURE(n);
        CHECK(rows.number(n, "release") == double(n));
        CHECK(rows.drawn_area(n) == Approx(areas[n]).epsilon(kExact));
        CHECK(rows.number(n, "area_m2") == areas[n]);
        CHECK(rows.number(n, "volume_m3") == Approx(depths[n] * areas[n]).epsilon(kExact));
        CHECK(rows.has(n, "entered_s") == (n != 2));
    }
    CHECK(rows.number(0, "entered_s") == 0.0);
    CHECK(rows.number(1, "entered_s") == 1.0);
}

TEST_CASE("Where polygons of a release overlap, its row of a GIS counts the area once", "[program][gis]") {
    const PlaneCase plane;
    write_text(plane.folder() / "twice.geojson",
               R"({"type": "Feature", "properties": {}, "geometry": {"type": "MultiPolygon", "coordinates": [
                  [[[20, 30], [50, 30], [50, 70], [20, 70], [20, 30]]],
                  [[[40, 30], [60, 30], [60, 70], [40, 70], [40, 30]]]]}})");
    const ReleaseRows rows(plane, "[[release]]\noutline = \"twice.geojson\"\ndepth = 1.5\n", "");
    REQUIRE(rows.size() == 1);
    CHECK(rows.number(0, "area_m2") == Approx(1600.0).epsilon(kExact));
    CHECK(rows.number(0, "volume_m3") == Approx(1.5 * 1600.0).epsilon(kExact));
}

TEST_CASE("Beside a lake the row of a release has the volume of the release alone", "[program][gis]") {
    const PlaneCase plane;
    const char* const lake = "[water]\nmodel = \"free\"\nlevel = 90\n[boundary]\nsides = \"wall\"\n";
    const ReleaseRows rows(plane, "[[release]]\noutline = \"release.geojson\"\ndepth = 1.5\n", lake);
    REQUIRE(rows.size() == 1);
    CHECK(rows.number(0, "area_m2") == Approx(1200.0).epsilon(kExact));
    CHECK(rows.number(0, "volume_m3") == Approx(1800.0).epsilon(kExact));
    CHECK(rows.record["release_volume"].get<double>() > 1.1 * 1800.0);
}
