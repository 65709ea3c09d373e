#pragma once
// The scene that the fake simulation stands for: what a run of it needs besides.
#include "fake_simulation.h"
#include "scene/scene.h"

namespace frana {

inline const char* const utm32 = R"(PROJCS["WGS 84 / UTM zone 32N",GEOGCS["WGS 84",DATUM["WGS_1984",)"
                                 R"(SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],)"
                                 R"(UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],)"
                                 R"(PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",9],)"
                                 R"(PARAMETER["scale_factor",0.9996],PARAMETER["false_easting",500000],)"
                                 R"(PARAMETER["false_northing",0],UNIT["metre",1],AUTHORITY["EPSG","32632"]])";

inline Scene fake_scene(const FakeSimulation& simulation) {
    Scene scene;
    scene.name = "hill";
    scene.title = "A hill that slides";
    scene.case_file = "hill/case.toml";
    scene.bed = Raster::filled(simulation.grid(), 0.0);
    for (Index j = 0; j < scene.bed.geometry.ny; ++j)
        for (Index i = 0; i < scene.bed.geometry.nx; ++i)
            scene.bed.at(i, j) = FakeSimulation::bed({scene.bed.geometry.x(i), scene.bed.geometry.y(j)});
    scene.bed.crs_wkt = utm32;
    scene.particles.x.assign(25, 1010.0);
    scene.particles.volume.assign(25, 1.0);
    scene.end = 2.0;
    scene.output.every = 0.5;
    scene.output.xdmf = true;
    scene.profiles = {{"along", {{1002, 2022}, {1030, 2013}}}};
    scene.gauges = {{"bridge", {1014, 2018}}};
    scene.log = {"a remark | made while building"};
    return scene;
}

}  // namespace frana
