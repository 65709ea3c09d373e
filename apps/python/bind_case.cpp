// Case files: their values by key, what `frana check` and `frana describe` tell.
#include <fmt/format.h>

#include "apps/frana_check.h"
#include "base/error.h"
#include "bindings.h"
#include "io/gdal_reader.h"
#include "run/folder/run_page.h"
#include "scene/build_scene.h"
#include "scene/memory_need.h"
#include "vtk_io/barrier_mesh.h"

namespace frana {
namespace {

/// The table's row of a key. KeyError with the nearest of all keys.
const Parameter& parameter_of(const std::string& key) {
    if (const Parameter* found = find_parameter(key)) return *found;
    std::vector<std::string> known;
    for (const Parameter& parameter : parameters()) known.push_back(parameter.key);
    const std::string near = closest(without_numbers(key), known);
    throw py::key_error(fmt::format("{}: unknown key; {}", key,
                                    near.empty() ? "frana.describe() lists all keys" : "did you mean " + near + "?"));
}

/// Whether the key is written with the numbers of its repeated tables, "release.0.depth".
void require_numbers(const std::string& key) {
    for (const std::string& table : repeated_tables())
        if (key.compare(0, table.size() + 1, table + ".") == 0 && without_numbers(key) == key)
            throw py::key_error(fmt::format("{}: expected the number of its [[{}]], counted from 0: {}.0.{}", key,
                                            table, table, key.substr(table.size() + 1)));
}

py::object of_python(const Value& value, Kind kind) {
    if (const auto* number = std::get_if<double>(&value); number && kind == Kind::integer)
        return py::int_(static_cast<long long>(*number));
    if (const auto* points = std::get_if<std::vector<Vec2>>(&value)) {
        py::list list;
        for (const Vec2& point : *points) list.append(py::make_tuple(point.x(), point.y()));
        return list;
    }
    return std::visit(
        [](const auto& held) -> py::object {
            using Held = std::decay_t<decltype(held)>;
            if constexpr (std::is_same_v<Held, std::vector<Vec2>>)
                return py::none();
            else
                return py::cast(held);
        },
        value);
}

py::object value_of(const CaseFile& file, const std::string& key) {
    const Parameter& parameter = parameter_of(key);
    require_numbers(key);
    const Value* value = file.find(key);
    return value ? of_python(*value, parameter.kind) : py::none();
}

/// What a check finds when nothing is wrong.
struct Checked {
    std::string text;
    Index particles = 0;
    double volume = 0.0, memory = 0.0;  ///< [m3], [bytes]
};

Checked check(const CaseFile& file) {
    return aside([&] {
        Checked found;
        const MeshReader meshes = barrier_meshes_told([&](const std::string& line) { found.text += line + '\n'; });
        const BuiltScene built = build_scene_in_detail(file, GdalReader(), meshes);
        check_page(file);
        found.text += told_of(built);
        for (const Seeds* seeds : built.scene.all_particles()) found.particles += seeds->count();
        for (const ReleaseSummary& release : built.releases) found.volume += release.report.particle_volume;
        found.memory = memory_need(built.scene).total();
        return found;
    });
}

}  // namespace

void bind_case(py::module_& module) {
    py::class_<CaseFile>(module, "CaseFile")
        .def_static("read", [](const std::string& file,
                               const std::vector<std::string>& sets) { return CaseFile::read(file, sets); })
        .def_static("parse", [](const std::string& text, const std::string& file,
                                const std::vector<std::string>& sets) { return CaseFile::parse(text, file, sets); })
        .def("value", &value_of)
        .def("given",
             [](const CaseFile& file, const std::string& key) {
                 parameter_of(key);
                 return file.given(key);
             })
        .def("count", &CaseFile::count)
        .def_property_readonly("name", &CaseFile::name)
        .def("resolved", [](const CaseFile& file) { return resolved_toml(file); });
    module.def("require_key", [](const std::string& key) {
        parameter_of(key);
        require_numbers(key);
    });
    py::class_<Checked>(module, "Checked")
        .def_readonly("text", &Checked::text)
        .def_readonly("particles", &Checked::particles)
        .def_readonly("volume", &Checked::volume)
        .def_readonly("memory", &Checked::memory);
    module.def("check", &check);
    module.def("describe", [](const std::string& key) { return describe(key); });
    module.def("keys", [] {
        py::list keys;
        for (const Parameter& parameter : parameters()) keys.append(parameter.key);
        return keys;
    });
    module.def("repeated_tables", [] { return repeated_tables(); });
}

}  // namespace frana
