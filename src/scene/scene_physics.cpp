#include "base/error.h"
#include "scene/law_places.h"
#include "scene/scene_parts.h"

namespace frana {
namespace {

Transfer transfer_of(const std::string& word) {
    if (word == "tpic") return Transfer::tpic;
    if (word == "apic") return Transfer::apic;
    if (word == "flip") return Transfer::flip;
    return Transfer::pic;
}

Shape shape_of(const std::string& word) {
    if (word == "linear") return Shape::linear;
    return word == "cubic" ? Shape::cubic : Shape::quadratic;
}

Scheme scheme_of(const CaseFile& file) {
    const auto value = [&](const char* name) { return file.number(std::string("scheme.") + name); };
    Scheme scheme;
    scheme.preset = file.word("scheme.preset");
    scheme.shape = shape_of(file.word("scheme.shape"));
    scheme.transfer = transfer_of(file.word("scheme.transfer"));
    scheme.precision = file.word("scheme.precision") == "float" ? Precision::single : Precision::full;
    scheme.flip_ratio = value("flip_ratio");
    scheme.cfl = value("cfl");
    scheme.filter = value("filter");
    scheme.wave_shift = value("wave_shift");
    scheme.margin = file.flag("scheme.margin");
    scheme.sub_point_reach = value("sub_point_reach");
    scheme.margin_limit = value("margin_limit");
    scheme.viscosity_linear = value("viscosity_linear");
    scheme.viscosity_quadratic = value("viscosity_quadratic");
    scheme.lateral_drag = value("lateral_drag");
    scheme.shock_gate = value("shock_gate");
    scheme.shock_sensor = value("shock_sensor");
    scheme.split = file.flag("scheme.split");
    scheme.merge = file.flag("scheme.merge");
    scheme.reset_domains = file.flag("scheme.reset_domains");
    scheme.sleep = file.flag("scheme.sleep");
    scheme.split_length = value("split_length");
    scheme.split_min_mass = value("split_min_mass");
    scheme.mass_fit = file.flag("scheme.mass_fit");
    scheme.curvature_length = value("curvature_length");
    scheme.strain_rate_floor = value("strain_rate_floor");
    scheme.stress_cap = value("stress_cap");
    if (file.given("scheme.still_level")) scheme.still_level = value("still_level");
    scheme.paper_pressure = scheme.preset == "paper";
    return scheme;
}

Output output_of(const CaseFile& file) {
    Output output;
    output.every = file.number("output.every");
    output.vtk = output.xdmf = output.geotiff = output.png = false;
    for (const std::string& format : file.words("output.formats")) {
        output.vtk |= format == "vtk";
        output.xdmf |= format == "xdmf";
        output.geotiff |= format == "geotiff";
        output.png |= format == "png";
    }
    if (file.word("output.film") != "none") output.film = file.word("output.film");
    output.fields = file.words("output.fields");
    output.footprint_depth = file.number("output.footprint_depth");
    output.history_per_step = file.word("output.history") == "step";
    output.whole_terrain = file.word("output.extent") == "terrain";
    output.checkpoint_minutes = file.number("output.checkpoint_minutes");
    return output;
}

TerrainModel terrain_of(const std::string& word) {
    if (word == "shallow") return TerrainModel::shallow;
    return word == "linearised" ? TerrainModel::linearised : TerrainModel::steep;
}

Curvature curvature_of(const std::string& word) {
    if (word == "full") return Curvature::full;
    return word == "inertia" ? Curvature::inertia : Curvature::none;
}

Sides sides_of(const std::string& word) {
    if (word == "mirror") return Sides::mirror;
    return word == "wall" ? Sides::wall : Sides::open;
}

}  // namespace

void set_physics(const CaseFile& file, Scene& scene) {
    scene.gravity = file.number("terrain.gravity");
    scene.density = file.number("material.density");
    scene.terrain = terrain_of(file.word("terrain.model"));
    scene.curvature = curvature_of(file.word("terrain.curvature"));
    scene.sides = sides_of(file.word("boundary.sides"));
    scene.bed_law = law_of<BedLaw>(file, kBedPlace);
    scene.rheology = law_of<Rheology>(file, kRheologyPlace);
    scene.scheme = scheme_of(file);
    scene.end = file.number("time.end");
    scene.stop_at_rest = file.flag("time.stop_at_rest");
    scene.rest_fraction = file.number("time.rest_fraction");
    scene.output = output_of(file);
    if (water_alone(file)) {
        scene.density = file.number("water.density");
        if (file.word("water.friction") == "none" && file.word("material.bed.law") == "none")
            scene.log.push_back("water.friction is not given: the bed is without friction");
    } else if (!file.given("material.bed.law"))
        scene.log.push_back("material.bed.law is not given: the bed is without friction");
}

}  // namespace frana
