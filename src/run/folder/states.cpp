#include "run/folder/states.h"

#include <fmt/core.h>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/number_text.h"
#include "run/folder/look.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

std::string escaped(const std::string& text) {
    std::string result;
    for (const char letter : text) {
        if (letter == '&')
            result += "&amp;";
        else if (letter == '<')
            result += "&lt;";
        else if (letter == '>')
            result += "&gt;";
        else if (letter == '"')
            result += "&quot;";
        else
            result += letter;
    }
    return result;
}

std::string text_of(const Json& value) {
    if (value.is_string()) return escaped(value.get<std::string>());
    return fmt::format("{}", value.get<double>());
}

/// What belongs into a slot (run/folder/states.h has the grammar).
std::string slot_value(const std::string& slot, const Json& look, const fs::path& run_dir) {
    const std::string file = "file:";
    if (slot.rfind(file, 0) == 0) return escaped((run_dir / slot.substr(file.size())).string());
    const std::size_t at = slot.find('@');
    const Json::json_pointer pointer(slot.substr(0, at));
    expect(look.contains(pointer), ("a state's slot " + slot + " is in the look of the run").c_str());
    const Json& value = look.at(pointer);
    if (at == std::string::npos) return text_of(value);
    const double low = value.at(0).get<double>(), high = value.at(1).get<double>();
    return fmt::format("{}", low + number_in(slot.substr(at + 1)).value() * (high - low));
}

}  // namespace

std::string filled_state(const std::string& text, const Json& look, const fs::path& run_dir) {
    const std::string value_mark = " value=\"", slot_mark = " slot=\"";
    std::string result;
    std::size_t done = 0;
    for (std::size_t slot = text.find(slot_mark); slot != std::string::npos; slot = text.find(slot_mark, done)) {
        const std::size_t name = slot + slot_mark.size(), name_end = text.find('"', name);
        const std::size_t value = text.rfind(value_mark, slot) + value_mark.size();  // the generator puts it first
        expect(value > done && value < slot && text[slot - 1] == '"', "a slot stands behind its value");
        result += text.substr(done, value - done);
        result += slot_value(text.substr(name, name_end - name), look, run_dir) + "\"";
        done = name_end + 1;
    }
    return result + text.substr(done);
}

Json write_states(const fs::path& run_dir, const std::string& title) {
    Json look = fs::exists(run_dir / "maps.vti") ? look_at_maps(run_dir, title) : look_at_run(run_dir, title);
    const fs::path folder = run_dir / "states";
    std::error_code failure;
    fs::create_directories(folder, failure);
    if (failure)
        throw UserError(fmt::format("{}: cannot be made: {}; give a folder that may be written to", folder.string(),
                                    failure.message()));
    write_text(folder / "look.json", look.dump(1) + "\n");
    for (const StateTemplate& state : state_templates()) {
        const fs::path file = folder / (state.name + ".pvsm");
        if (look["states"][state.name].get<std::string>().empty())
            write_text(file, filled_state(state.text, look, fs::absolute(run_dir).lexically_normal()));
        else
            fs::remove(file, failure);
    }
    return look;
}

}  // namespace frana
