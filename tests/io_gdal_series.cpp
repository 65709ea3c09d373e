// Shapes through time for a GIS: a run that is resumed, a disk that is full.
#include <map>

#include "catch.h"
#include "fake_scene.h"
#include "fresh_folder.h"
#include "io/gdal_series.h"
#include "observe/memory_archive.h"
#include "read_layer.h"
#include "small_disk.h"

using namespace frana;
namespace fs = std::filesystem;

TEST_CASE("shapes go on after a run is resumed, without those that come again", "[insitu][gdal]") {
    const FreshFolder folder;
    const fs::path file = folder.path() / "lines.gpkg";
    const auto line = [](double level) {
        return std::vector<std::pair<double, Polyline>>{{level, {{0.0, 0.0}, {1.0, 2.0}}}};
    };
    {
        ShapeSeries first(file, "");
        for (const double t : {0.0, 1.0, 2.0}) first.add_lines(t, line(t), "m");
    }
    ShapeSeries again(file, "");
    for (const double t : {1.0, 1.5}) again.add_lines(t, line(10.0 + t), "m");
    const Layer layer(file);
    std::map<double, double> levels;
    for (const OGRFeatureUniquePtr& feature : layer.get())
        levels[feature->GetFieldAsDouble("t_s")] = feature->GetFieldAsDouble("level");
    CHECK(levels == std::map<double, double>{{0.0, 0.0}, {1.0, 11.0}, {1.5, 11.5}});
    REQUIRE(layer.get().GetSpatialRef());
    CHECK(layer.get().GetSpatialRef()->IsLocal());  // metres of nowhere, and no degrees
}

TEST_CASE("a state that is restored takes away what came after it, without another sample", "[insitu][gdal][resume]") {
    const FreshFolder folder;
    const fs::path file = folder.path() / "lines.gpkg";
    const auto at = [](double t) { return std::vector<std::pair<double, Polyline>>{{t, {{0.0, 0.0}, {1.0, 2.0}}}}; };
    MemoryArchive state;
    {
        ShapeSeries first(file, "");
        for (const double t : {0.0, 2.0}) first.add_lines(t, at(t), "m");
        first.serialize(state);
        for (const double t : {3.0, 4.0}) first.add_lines(t, at(t), "m");
    }
    const auto times = [&] {
        const Layer layer(file);
        std::vector<double> all;
        for (const OGRFeatureUniquePtr& feature : layer.get()) all.push_back(feature->GetFieldAsDouble("t_s"));
        return all;
    };
    REQUIRE(times() == std::vector<double>{0.0, 2.0, 3.0, 4.0});
    ShapeSeries again(file, "");
    state.rewind();
    again.serialize(state);
    CHECK(times() == std::vector<double>{0.0, 2.0});
    again.add_lines(3.5, at(3.5), "m");
    CHECK(times() == std::vector<double>{0.0, 2.0, 3.5});
}

TEST_CASE("a series that is repeated or goes on after a kill has the same bytes", "[insitu][gdal][resume]") {
    const FreshFolder folder;
    const fs::path whole = folder.path() / "whole" / "lines.gpkg", other = folder.path() / "other" / "lines.gpkg";
    // Of some times there is no line, and of others more than fit a page of the file.
    const auto at = [](int t) {
        std::vector<std::pair<double, Polyline>> lines;
        for (int n = 0; n < (t % 3 == 1 ? 0 : 7 * t); ++n) lines.push_back({0.5, Polyline(50, Vec2(t, 0.1 * n))});
        return lines;
    };
    const auto add = [&](ShapeSeries& series, int from, int until) {
        for (int t = from; t <= until; ++t) series.add_lines(t, at(t), "m");
    };
    ShapeSeries first(whole, utm32);
    add(first, 0, 12);
    const std::string bytes = text_of(whole);
    CHECK(bytes.find("2000-01-01T00:00:00") != std::string::npos);  // the one date, so none of the clock

    ShapeSeries repeated(other, utm32);
    add(repeated, 0, 12);
    CHECK((text_of(other) == bytes));
    ShapeSeries again(other, utm32);
    add(again, 0, 12);
    CHECK((text_of(other) == bytes));

    for (const int saved : {0, 4, 8}) {
        CAPTURE(saved);
        fs::remove(other);
        MemoryArchive state;
        {
            ShapeSeries killed(other, utm32);
            add(killed, 0, saved);
            killed.serialize(state);
            add(killed, saved + 1, saved + 3);
        }
        ShapeSeries resumed(other, utm32);
        state.rewind();
        resumed.serialize(state);
        add(resumed, saved + 1, 12);
        CHECK((text_of(other) == bytes));
    }
}

TEST_CASE("a full disk takes no shapes, and leaves those before", "[insitu][gdal]") {
    const FreshFolder folder;
    const fs::path file = folder.path() / "lines.gpkg";
    ShapeSeries series(file, utm32);
    series.add_lines(0.0, {{1.0, {{0.0, 0.0}, {1.0, 2.0}}}}, "m");
    const Polyline long_line(20000, Vec2(3.0, 4.0));
    {
        const SmallDisk disk(fs::file_size(file));
        CHECK_THROWS_WITH(series.add_lines(1.0, {{1.0, long_line}}, "m"),
                          Catch::StartsWith(file.string() + ": cannot be written"));
    }
    CHECK(Layer(file).get().GetFeatureCount() == 1);
    series.add_lines(2.0, {{1.0, {{0.0, 0.0}, {1.0, 2.0}}}}, "m");
    CHECK(Layer(file).get().GetFeatureCount() == 2);
}
