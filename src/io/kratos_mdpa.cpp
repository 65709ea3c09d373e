#include "io/kratos_mdpa.h"

#include <cmath>

#include "base/error.h"
#include "base/text_file.h"

namespace frana {
namespace {

constexpr const char* kPart = "Flow";

/// A point's box: square in the map, with the point's volume.
struct Box {
    double x = 0.0, y = 0.0, bottom = 0.0, top = 0.0, half = 0.0;
};

/// A column of no depth has points of no height: they become cubes.
Box box_of(const SolidPoints& points, std::size_t k) {
    const double* place = &points.position[3 * k];
    const double cube = std::cbrt(points.volume[k]);
    const double height = points.height[k] > 0.0 ? points.height[k] : cube;
    return {place[0], place[1], place[2] - 0.5 * height, place[2] + 0.5 * height,
            0.5 * std::sqrt(points.volume[k] / height)};
}

/// Whether the upper box stands on the lower one, to round-off of elevations.
bool touch(const Box& lower, const Box& upper) {
    const double slack = 1e-9 * (lower.top - lower.bottom) + 1e-14 * std::abs(upper.bottom);
    return std::abs(lower.top - upper.bottom) <= slack;
}

/// Calls see(k, box, shared) for every point; shared: its bottom nodes are the top nodes of the point before.
template <class Visit>
void for_each_box(const SolidPoints& points, Visit&& visit) {
    for (std::size_t p = 0; p + 1 < points.first.size(); ++p) {
        Box before;
        for (std::size_t k = points.first[p]; k < points.first[p + 1]; ++k) {
            const Box box = box_of(points, k);
            visit(k, box, k > points.first[p] && touch(before, box));
            before = box;
        }
    }
}

void put_square(TextFile& text, std::size_t& node, const Box& box, double z) {
    const double sides[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    for (const auto& side : sides)
        text.put("{} {} {} {}\n", ++node, box.x + side[0] * box.half, box.y + side[1] * box.half, z);
}

/// Returns how many there are.
std::size_t put_nodes(TextFile& text, const SolidPoints& points) {
    std::size_t node = 0;
    text.put("Begin Nodes\n");
    for_each_box(points, [&](std::size_t, const Box& box, bool shared) {
        if (!shared) put_square(text, node, box, box.bottom);
        put_square(text, node, box, box.top);
    });
    text.put("End Nodes\n\n");
    return node;
}

/// Hexahedra: the lower square counterclockwise, then the upper one.
void put_elements(TextFile& text, const SolidPoints& points) {
    std::size_t node = 0;
    text.put("Begin Elements MPMUpdatedLagrangian3D8N\n");
    for_each_box(points, [&](std::size_t k, const Box&, bool shared) {
        if (shared) node -= 4;
        text.put("{} 0", k + 1);
        for (int corner = 0; corner < 8; ++corner) text.put(" {}", ++node);
        text.put("\n");
    });
    text.put("End Elements\n\n");
}

void put_velocities(TextFile& text, const SolidPoints& points) {
    text.put("Begin ElementalData MP_VELOCITY\n");
    for (std::size_t k = 0; k < points.count(); ++k) {
        const double* v = &points.velocity[3 * k];
        text.put("{} [3] ({},{},{})\n", k + 1, v[0], v[1], v[2]);
    }
    text.put("End ElementalData\n\n");
}

void put_part(TextFile& text, std::size_t nodes, std::size_t elements) {
    text.put("Begin SubModelPart {}\n  Begin SubModelPartNodes\n", kPart);
    for (std::size_t k = 1; k <= nodes; ++k) text.put("{}\n", k);
    text.put("  End SubModelPartNodes\n  Begin SubModelPartElements\n");
    for (std::size_t k = 1; k <= elements; ++k) text.put("{}\n", k);
    text.put("  End SubModelPartElements\nEnd SubModelPart\n");
}

void require_finite(const SolidPoints& points) {
    for (const auto* numbers : {&points.position, &points.velocity, &points.volume, &points.height})
        for (const double number : *numbers) expect(std::isfinite(number), "what is exported is finite numbers");
}

void write_material(const std::filesystem::path& file, const KratosMaterial& material) {
    TextFile text(file);
    text.put("{{\n  \"properties\": [{{\n    \"model_part_name\": \"Initial_MPM_Material.{}\",\n", kPart);
    text.put("    \"properties_id\": 1,\n    \"Material\": {{\n");
    text.put("      \"constitutive_law\": {{\"name\": {}}},\n      \"Variables\": {{\n", json_text(material.law));
    text.put("        \"MATERIAL_POINTS_PER_ELEMENT\": 1");
    for (const auto& [name, value] : material.variables) text.put(",\n        {}: {:#}", json_text(name), value);
    text.put("\n      }},\n      \"Tables\": {{}}\n    }}\n  }}]\n}}\n");
    text.commit();
}

}  // namespace

KratosMaterial kratos_fluid(double density, double viscosity, double sound_speed) {
    return {"DispNewtonianFluid3DLaw",
            {{"DENSITY", density},
             {"BULK_MODULUS", density * sound_speed * sound_speed},
             {"DYNAMIC_VISCOSITY", viscosity}}};
}

void write_kratos(const std::filesystem::path& file, const SolidPoints& points, const KratosMaterial& material,
                  const std::vector<std::string>& comments) {
    require_finite(points);
    TextFile text(file);
    for (const std::string& comment : comments) text.put("// {}\n", comment);
    text.put("Begin ModelPartData\nEnd ModelPartData\n\nBegin Properties 0\nEnd Properties\n\n");
    const std::size_t nodes = put_nodes(text, points);
    put_elements(text, points);
    put_velocities(text, points);
    put_part(text, nodes, points.count());
    text.commit();
    write_material(file.parent_path() / "ParticleMaterials.json", material);
}

}  // namespace frana
