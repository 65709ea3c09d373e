#include <cstdlib>

#include "base/error.h"
#include "catch.h"
#include "fresh_folder.h"
#include "particles/export.h"
#include "release_maker.h"
#include "terrain/bed_points.h"

using namespace frana;
using namespace release_maker;

TEST_CASE("The bed between nodes is bilinear, and unknown outside and next to nodata", "[particles]") {
    Raster bed = flat_bed(4, 4, 10.0, 100.0, 200.0);
    for (Index j = 0; j < 4; ++j)
        for (Index i = 0; i < 4; ++i) bed.at(i, j) = static_cast<double>(i + 10 * j + i * j);
    CHECK(bed_elevation(bed, 105.0, 215.0) == Approx(0.5 + 15.0 + 0.75).epsilon(1e-15));
    CHECK(bed_elevation(bed, 130.0, 230.0) == 42.0);
    CHECK(std::isnan(bed_elevation(bed, 99.9, 215.0)));
    bed.at(2, 2) = Raster::nodata;
    CHECK(std::isnan(bed_elevation(bed, 115.0, 215.0)));
    CHECK(std::isfinite(bed_elevation(bed, 110.0, 215.0)));  // on a line of nodes that does not touch the gap
    CHECK(bed_below(bed, 105.0, 215.0) == bed_elevation(bed, 105.0, 215.0));
    CHECK(bed_below(bed, 99.0, 215.0) == bed_elevation(bed, 100.0, 215.0));
    CHECK(bed_below(bed, 115.0, 215.0) == Approx((12.0 + 14.0 + 23.0) / 3.0).epsilon(1e-15));  // of the three that have
}

TEST_CASE("CSV gives back every particle bit by bit", "[particles]") {
    const FreshFolder folder;
    Raster bed = flat_bed(31, 31, 2.0, 512345.6, 5123456.7);
    const Vec2 centre(bed.geometry.x0 + 30.0, bed.geometry.y0 + 30.0);
    Release release = release_of_ring(star(centre, 25.0, 12.0, 5, 0.1), 1.7);
    release.velocity = Vec2(1.0 / 3.0, -0.25);
    const Made made = make({release}, bed);
    write_seeds_csv(folder.path() / "seeds.csv", make_seeds_export(made.seeds, 1300.0, bed));

    std::istringstream text(text_of(folder.path() / "seeds.csv"));
    std::string line;
    std::getline(text, line);
    CHECK(line == "id,x,y,elevation,depth,size,vx,vy,volume,mass");
    std::size_t p = 0;
    for (; std::getline(text, line); ++p) {
        std::vector<double> values;
        std::istringstream cells(line);
        for (std::string cell; std::getline(cells, cell, ',');) values.push_back(std::strtod(cell.c_str(), nullptr));
        REQUIRE(p < made.seeds.x.size());
        const Seeds& s = made.seeds;
        CHECK(values == std::vector<double>{static_cast<double>(p), s.x[p], s.y[p], 100.0, s.depth[p], s.size[p],
                                            1.0 / 3.0, -0.25, s.volume[p], 1300.0 * s.volume[p]});
    }
    CHECK(p == made.seeds.x.size());
}

TEST_CASE("Particles that are no numbers or stand off the bed are never exported", "[particles][nan]") {
    const Raster bed = flat_bed(11, 11, 1.0);
    Made made = make({release_of_ring(rectangle_ring(2, 2, 5, 5), 1.0)}, bed);
    SeedsExport data = make_seeds_export(made.seeds, 1000.0, bed);
    made.seeds.depth[3] = Raster::nodata;
    CHECK_THROWS_AS(seeds_columns(data), InternalError);
    made.seeds.x[0] = -1.0;
    CHECK_THROWS_WITH(make_seeds_export(made.seeds, 1000.0, bed), Catch::Contains("particle 0 at x = -1.00"));
}
