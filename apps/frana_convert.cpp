// `frana convert`: the particles of a run become 3D points for other programs (Fois, de Falco, Formaggia 2025,
// Algorithm 2). A table tells what was conserved on the way.
#include <fmt/format.h>

#include <cmath>
#include <iostream>

#include "base/atomic_file.h"
#include "base/compensated_sum.h"
#include "base/error.h"
#include "base/free_memory.h"
#include "base/text_file.h"
#include "convert/conservation.h"
#include "frana_commands.h"
#include "frana_export.h"
#include "frana_figures.h"
#include "io/kratos_mdpa.h"
#include "run/folder/run_state.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

VelocityProfile profile_of(const std::string& word) {
    if (word == "linear") return VelocityProfile::linear;
    if (word == "parabolic") return VelocityProfile::parabolic;
    return word == "bagnold" ? VelocityProfile::bagnold : VelocityProfile::plug;
}

ConversionChoice choice_of(const ConvertOptions& options) {
    ConversionChoice choice;
    choice.spacing = *options.spacing;
    require_spacing(choice.spacing);
    choice.layers = options.layers == "end-points" ? Layers::end_points : Layers::centres;
    choice.vertical = options.vertical == "zero" ? Vertical::zero : Vertical::along_bed;
    choice.profile = profile_of(options.profile);
    return choice;
}

std::string listed(const double* numbers, std::size_t count) {
    std::string text;
    for (std::size_t k = 0; k < count; ++k) text += fmt::format("{}{}", k > 0 ? "," : "", numbers[k]);
    return text;
}

/// What lies in the window; everything when there is none.
FlowParticles chosen_particles(const RunState& state, const std::vector<double>& window) {
    if (window.empty()) return state.particles;
    const std::string text = "--window " + listed(window.data(), window.size());
    if (!(window[0] < window[2] && window[1] < window[3]))
        throw UserError(text +
                        ": is empty; expected xmin,ymin,xmax,ymax with xmin < xmax and ymin < ymax; give the "
                        "corners in that order");
    const auto terrain = state.bed.geometry.pixel_extent();
    if (window[2] < terrain[0] || window[0] > terrain[2] || window[3] < terrain[1] || window[1] > terrain[3])
        throw UserError(
            fmt::format("{}: lies outside the terrain; expected a part of {}; give map coordinates of the run", text,
                        listed(terrain.data(), terrain.size())));
    FlowParticles inside = particles_within(state.particles, {window[0], window[1], window[2], window[3]});
    if (inside.count() == 0)
        throw UserError(
            fmt::format("{}: holds no material at {:.6g} s; expected particles of the flow in it; give another "
                        "window or time",
                        text, state.time));
    return inside;
}

/// Points are of the solids alone.
void tell_of_water(const ConvertOptions& options, const RunState& state) {
    if (case_of_run(options.run_dir).word("water.model") == "none") return;
    std::cout << "free water of the run is left out, the points are of the particles alone"
              << (state.free_water > 0.0 ? fmt::format(": {:.6g} m3 on the whole terrain", state.free_water) : "")
              << '\n';
}

/// Memory that points take until they are written [bytes]. Writing VTK needs cells, compressed blocks and their base64
/// besides. Measured from 2.5e5 to 4.5e6 points: 142 bytes a point for HDF5, 318 for VTK.
double bytes_needed(double points, const std::string& format) {
    constexpr double kIds = 8.0, kVtk = 176.0;
    return points * (kBytesPerPoint + kIds + (format == ".vtp" ? kVtk : 0.0));
}

/// Refuses what does not fit, before any of it is allocated.
void require_memory(const FlowParticles& particles, double spacing, const std::string& format) {
    const double points = forecast_points(particles, spacing);
    const double bytes = bytes_needed(points, format), free = free_memory();
    if (bytes <= free) return;
    throw UserError(
        fmt::format("--spacing {:.6g}: makes {:.3g} points, about {:.3g} GB; expected what fits into the {:.3g} "
                    "GB that are free; give a larger spacing or a --window",
                    spacing, points, bytes / 1e9, free / 1e9));
}

double total(const std::vector<double>& numbers) {
    CompensatedSum sum;
    for (const double number : numbers) sum.add(number);
    return sum.value();
}

PointTable table_of(const SolidPoints& points, const RunState& state, double density, const ConvertOptions& options,
                    const std::string& conservation) {
    PointTable table;
    table.format = "frana 3D points 1";
    table.crs_wkt = state.bed.crs_wkt;
    table.constants = {{"time", "s", state.time}, {"spacing", "m", *options.spacing}, {"density", "kg/m3", density}};
    table.texts = {{"layers", options.layers},
                   {"vertical", options.vertical},
                   {"profile", options.profile},
                   {"frames", state.frames},
                   {"conservation", conservation}};
    table.count = points.count();
    table.columns = {{"position", "m", {"x", "y", "z"}, points.position.data()},
                     {"velocity", "m/s", {"vx", "vy", "vz"}, points.velocity.data()},
                     {"mass", "kg", {"mass"}, points.mass.data()},
                     {"volume", "m3", {"volume"}, points.volume.data()},
                     {"pressure", "Pa", {"pressure"}, points.pressure.data()},
                     {"stress", "Pa", {"sxx", "syy", "szz", "sxy", "syz", "sxz"}, points.stress.data()},
                     {"height", "m", {"height"}, points.height.data()},
                     {"column", "1", {"column"}, points.particle.data()}};
    return table;
}

/// A fluid that is stiff enough for its own flow. Sound is ten times as fast as its waves and its material. So the
/// density changes by about 1 % (Monaghan 1994).
double sound_speed(const SolidPoints& points, const FlowParticles& particles, double gravity) {
    double fastest = 0.0;
    for (const double depth : particles.depth) fastest = std::max(fastest, std::sqrt(gravity * depth));
    for (std::size_t k = 0; k < points.count(); ++k) {
        const double* v = &points.velocity[3 * k];
        fastest = std::max(fastest, std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]));
    }
    return 10.0 * std::max(fastest, 0.1);
}

/// The case's viscosity goes along; laws that Kratos' fluid has not are named.
void write_for_kratos(const ConvertOptions& options, const RunState& state, const FlowParticles& particles,
                      const SolidPoints& points, double density) {
    const CaseFile run_case = case_of_run(options.run_dir);
    const std::string law = run_case.word("material.rheology.law");
    const char* const key = "material.rheology.viscosity";
    if (law != "none" && run_case.is_text(key))
        throw UserError(
            fmt::format("{}: found a raster; expected one viscosity, since Kratos' fluid has no other; give "
                        "the file a number instead of it in {}",
                        run_case.place(key), run_case.file().string()));
    const double viscosity = law == "none" ? 0.0 : run_case.number(key);
    const double sound = sound_speed(points, particles, run_case.number("terrain.gravity"));
    make_folder_of(options.out);
    write_kratos(
        options.out, points, kratos_fluid(density, viscosity, sound),
        {fmt::format("frana 3D points: {} at {} s, a hexahedron for each", state.frames, state.time),
         "MP_VELOCITY is data of the elements; Kratos starts its points at rest, hand it on before the first step:",
         "for body, point in zip(model[\"Initial_MPM_Material.Flow\"].Elements, "
         "model[\"MPM_Material.Flow\"].Elements):",
         "    point.SetValuesOnIntegrationPoints(MP_VELOCITY, [body.GetValue(MP_VELOCITY)], process_info)"});
    std::cout << fmt::format("{}: viscosity {:.6g} Pa s, sound {:.4g} m/s{}\n",
                             (options.out.parent_path() / "ParticleMaterials.json").string(), viscosity, sound,
                             law == "bingham" ? "; the yield stress has no place in this law" : "");
}

std::string record_json(const RunState& state, const ConvertOptions& options, const std::string& conservation) {
    std::string window;
    if (!options.window.empty())
        window = fmt::format("\n\"window\": [{}],", listed(options.window.data(), options.window.size()));
    return fmt::format(
        "{{\n\"frames\": {},\n\"time\": {},\n\"asked_time\": {},\n\"spacing\": {},\n\"layers\": {},\n"
        "\"vertical\": {},\n\"profile\": {},{}\n\"conservation\": {}}}\n",
        json_text(state.frames), state.time, *options.time, *options.spacing, json_text(options.layers),
        json_text(options.vertical), json_text(options.profile), window, conservation);
}

/// The run's own files stay what they are.
void require_own_name(const ConvertOptions& options) {
    for (const char* name : {"run.h5", "checkpoint.h5", "run.json", "compare.json", "history.csv"})
        if (fs::weakly_canonical(options.out) == fs::weakly_canonical(options.run_dir / name))
            throw UserError(fmt::format("--out {}: is a file of the run itself; expected another name; choose one",
                                        options.out.string()));
}

/// One way or the other, with all that it needs.
void require_options(const ConvertOptions& options) {
    std::string missing;
    const auto need = [&](bool given, const char* name) {
        if (!given) missing += (missing.empty() ? "" : ", ") + std::string(name);
    };
    const bool back = !options.points.empty() || !options.back.empty();
    need(back || options.time, "--time");
    need(back || options.spacing, "--spacing");
    need(back || !options.out.empty(), "--out");
    need(!back || !options.points.empty(), "--points");
    need(!back || !options.back.empty(), "--back");
    if (!missing.empty())
        throw UserError(
            fmt::format("command line: found no {}; expected --time, --spacing and --out, or --points and --back "
                        "for the way from 3D; see `frana convert --help`",
                        missing));
    const ConvertOptions usual;
    const bool forward = options.time || options.spacing || !options.out.empty() || !options.window.empty() ||
                         options.layers != usual.layers || options.vertical != usual.vertical ||
                         options.profile != usual.profile;
    if (back && forward)
        throw UserError(
            "command line: found both ways at once; expected --time, --spacing and --out, or --points and --back "
            "for the way from 3D; call frana convert twice");
}

}  // namespace

int convert_command(const ConvertOptions& options) {
    require_options(options);
    if (!options.back.empty()) return convert_back(options);
    const std::string format = export_format(options.out, {".mdpa"});
    require_own_name(options);
    const ConversionChoice choice = choice_of(options);
    const RunState state = read_run_state(options.run_dir, *options.time);
    if (std::abs(state.time - *options.time) > 1e-9 * std::max(1.0, std::abs(state.time)))
        std::cout << fmt::format("no frame at {:.6g} s; the nearest, at {:.6g} s, is taken\n", *options.time,
                                 state.time);
    tell_of_water(options, state);
    const FlowParticles particles = chosen_particles(state, options.window);
    require_memory(particles, choice.spacing, format);

    const SolidPoints points = particles_to_points(particles, choice);
    const Conservation kept = conservation_of(particles, points, choice);
    const std::string conservation = conservation_json(kept);
    const double density = total(particles.mass) / total(particles.volume);
    if (format == ".mdpa")
        write_for_kratos(options, state, particles, points, density);
    else
        write_points(options.out, format, table_of(points, state, density, options, conservation),
                     points.position.data());
    const fs::path record = options.out.string() + ".conservation.json";
    write_text(record, record_json(state, options, conservation));
    std::cout << conservation_text(kept)
              << fmt::format("{} points of {} particles at {:.6g} s in {}\n{}\n", points.count(), particles.count(),
                             state.time, options.out.string(), record.string());
    return 0;
}

}  // namespace frana
