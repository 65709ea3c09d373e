// The Kratos body of converted points, read back by rules that are Kratos' own.
#include <nlohmann/json.hpp>

#include "catch.h"
#include "flow_maker.h"
#include "io/kratos_mdpa.h"
#include "read_mdpa.h"

using namespace frana;
using namespace flow_maker;

namespace {

SolidPoints some_points(Layers layers) {
    Raster bed = tilted_bed(8, 2.0);
    FlowParticles particles = uneven_flow(bed, 1300.0, 9.81);
    for (double& x : particles.x) x -= bed.geometry.x0;  // so that volumes are not lost in the digits of 5e6 m
    for (double& y : particles.y) y -= bed.geometry.y0;
    particles.depth[3] = 0.0;  // a particle without depth has to have a volume all the same
    ConversionChoice choice;
    choice.spacing = 0.5;
    choice.layers = layers;
    return particles_to_points(particles, choice);
}

}  // namespace

TEST_CASE("Kratos would make the very same points: place, volume, mass, velocity", "[convert]") {
    for (const Layers layers : {Layers::centres, Layers::end_points}) {
        const FreshFolder folder;
        const SolidPoints points = some_points(layers);
        write_kratos(folder.path() / "flow_Body.mdpa", points, kratos_fluid(1300.0, 50.0, 40.0), {"a remark"});
        const test::Mdpa body = test::read_mdpa(folder.path() / "flow_Body.mdpa");
        REQUIRE(body.elements.size() == points.count());
        REQUIRE(body.velocities.size() == points.count());
        CHECK(body.element_name == "MPMUpdatedLagrangian3D8N");
        CHECK(body.part == "Flow");
        CHECK(body.part_elements.size() == points.count());
        CHECK(body.part_nodes.size() == body.nodes.size());
        double volume_error = 0.0, place_error = 0.0;
        for (std::size_t k = 0; k < points.count(); ++k) {
            const long id = static_cast<long>(k) + 1;
            volume_error = std::max(volume_error, std::abs(body.volume(id) / points.volume[k] - 1.0));
            const auto middle = body.centroid(id), velocity = body.velocities.at(id);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                place_error = std::max(place_error, std::abs(middle[axis] - points.position[3 * k + axis]));
                CHECK(velocity[axis] == points.velocity[3 * k + axis]);
            }
        }
        CHECK(volume_error < 1e-11);  // differences of elevations of 900 m over slices of 0.5 m
        CHECK(place_error < 1e-12);   // round-off of 900 m
        // Four nodes a level: slices of a particle share them only where they touch.
        const std::size_t particles = points.first.size() - 1;
        const std::size_t levels = layers == Layers::centres ? points.count() + particles : 2 * points.count();
        CHECK(body.nodes.size() == 4 * levels);

        const auto json = nlohmann::json::parse(text_of(folder.path() / "ParticleMaterials.json"));
        const auto& property = json.at("properties").at(0);
        CHECK(property.at("model_part_name") == "Initial_MPM_Material.Flow");
        CHECK(property.at("Material").at("constitutive_law").at("name") == "DispNewtonianFluid3DLaw");
        const auto& variables = property.at("Material").at("Variables");
        CHECK(variables.at("MATERIAL_POINTS_PER_ELEMENT") == 1);
        CHECK(variables.at("DENSITY") == 1300.0);
        CHECK(variables.at("DYNAMIC_VISCOSITY") == 50.0);
        CHECK(variables.at("BULK_MODULUS") == 1300.0 * 1600.0);
    }
}

TEST_CASE("A Kratos body cannot be written into a folder that is not there, and the file is named", "[convert]") {
    const FreshFolder folder;
    CHECK_THROWS_WITH(write_kratos(folder.path() / "absent" / "a.mdpa", some_points(Layers::centres),
                                   kratos_fluid(1000.0, 0.0, 10.0), {}),
                      Catch::Contains("absent/a.mdpa: cannot be written"));
}
