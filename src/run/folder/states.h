#pragma once
// ParaView states that open on a run: RUN_DIR/states/*.pvsm, made from the templates in pvstates/.
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace frana {

/// A template, compiled into the program: a state that ParaView saved and pvstates/make_states.py cut down. Elements
/// with a `slot` attribute get their value from the run. slot="file:grid.pvd" is the file's absolute path. Others are
/// the number or text at that JSON pointer of look.json (run/folder/look.h), as slot="/camera/map/focal/0".
/// slot="/range/depth@0.25" is a quarter of the way between the two numbers there.
struct StateTemplate {
    std::string name;
    std::string text;
};

/// All templates. Generated from pvstates/*.pvsm by the build.
const std::vector<StateTemplate>& state_templates();

/// The template with its slots filled and their marks removed. Throws InternalError for a slot that `look` does not
/// have.
std::string filled_state(const std::string& text, const nlohmann::ordered_json& look,
                         const std::filesystem::path& run_dir);

/// Writes states/look.json and the states that the run, or the ensemble, has the files for. Removes those that it has
/// not. Paths in them are absolute: after moving the folder, write them again (frana states). Returns the content of
/// look.json. Throws UserError.
nlohmann::ordered_json write_states(const std::filesystem::path& run_dir, const std::string& title);

}  // namespace frana
