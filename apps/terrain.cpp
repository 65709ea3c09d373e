// frana_terrain: writes the made-up ground and releases of the cases. The build calls it; see
// apps/CMakeLists.txt.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "base/error.h"
#include "terrain_files.h"

namespace {

const frana::NamedScene& find_scene(const std::string& name) {
    std::string known;
    for (const frana::NamedScene& scene : frana::made_scenes()) {
        if (name == scene.name) return scene;
        known += (known.empty() ? "" : ", ") + std::string(scene.name);
    }
    throw frana::UserError("NAME: found '" + name + "'; expected one of " + known);
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app("Writes the terrain (GeoTIFF) and releases (GeoJSON) that the cases use");
    std::string name, out;
    bool list = false;
    app.add_option("NAME", name, "scene to write");
    app.add_option("--out", out, "folder to write into");
    app.add_flag("--list", list, "show the names");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }
    if (list || name.empty() || out.empty()) {
        for (const frana::NamedScene& scene : frana::made_scenes())
            std::printf("%-16s %s\n", scene.name, scene.meaning);
        if (list) return 0;
        throw frana::UserError("frana_terrain: give a NAME of the list above and --out DIR");
    }
    frana::write_scene(find_scene(name).make(), out);
    return 0;
} catch (const frana::UserError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
} catch (const std::exception& error) {
    std::fprintf(stderr, "internal error: %s\n", error.what());
    return 1;
}
