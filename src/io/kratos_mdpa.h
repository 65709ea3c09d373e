#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "convert/solid_points.h"

namespace frana {

/// A constitutive law of Kratos' MPMApplication and its variables, as its ParticleMaterials.json names them.
struct KratosMaterial {
    std::string law;
    std::vector<std::pair<std::string, double>> variables;
};

/// The displacement-based Newtonian fluid, DispNewtonianFluid3DLaw: density [kg/m^3], viscosity [Pa s], and the bulk
/// modulus density * sound_speed^2 [Pa].
KratosMaterial kratos_fluid(double density, double viscosity, double sound_speed);

/// The material's body for Kratos: `file` (.mdpa) and, next to it, ParticleMaterials.json.
///
/// Kratos reads no points. It reads a mesh of the body, puts MATERIAL_POINTS_PER_ELEMENT points into each element and
/// drops the mesh. A point gets the element's volume, and DENSITY times it as mass. So each point becomes a hexahedron
/// around it with the point's volume and height, and one point per element. Slices that touch share their nodes. The
/// point's velocity stands in an ElementalData block (MP_VELOCITY), which Kratos stores with the element. Its own
/// generator starts every point at rest. `comments` and the README say how to pass the velocity on. The background grid
/// (_Grid.mdpa) is the user's. Sources: kratosmultiphysics.github.io, MPM Application, Input Files (mdpa, json),
/// Constitutive Laws, Material Point Variables; Kratos' material_point_generator_utility.cpp, model_part_io.cpp and
/// displacement_newtonian_fluid_3D_law.cpp (its Check), and tests/cl_tests/solid_cl/linear_elastic_3D_hexa_test.
///
/// Both files appear whole or not at all. Throws UserError when one cannot be written.
void write_kratos(const std::filesystem::path& file, const SolidPoints& points, const KratosMaterial& material,
                  const std::vector<std::string>& comments);

}  // namespace frana
