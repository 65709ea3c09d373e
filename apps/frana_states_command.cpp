// `frana states RUN_DIR [NAME...]`: the ParaView states of a finished run written again, for where it lies now.
#include <fmt/core.h>

#include <algorithm>
#include <iostream>

#include "base/error.h"
#include "frana_commands.h"
#include "frana_figures.h"
#include "run/folder/look.h"
#include "run/folder/states.h"

namespace frana {
namespace {

void refuse_unknown(const std::vector<std::string>& names) {
    for (const std::string& name : names)
        if (std::find(state_names().begin(), state_names().end(), name) == state_names().end())
            throw UserError(
                fmt::format("states: found \"{}\"; expected overview, stress, profiles, survey, impact, "
                            "structure, phases, budgets or probability; leave the name away for all that the run has",
                            name));
}

}  // namespace

int states_command(const StatesOptions& options) {
    refuse_unknown(options.names);
    const bool ensemble = std::filesystem::exists(options.run_dir / "ensemble.json");
    const auto look = write_states(options.run_dir, ensemble ? "ensemble" : title_of_run(options.run_dir));
    for (const std::string& name : options.names) {
        const std::string why_not = look["states"][name].get<std::string>();
        if (!why_not.empty())
            throw UserError(fmt::format("{}: no state \"{}\": {}", options.run_dir.string(), name, why_not));
    }
    for (const std::string& name : state_names()) {
        const std::string why_not = look["states"][name].get<std::string>();
        if (why_not.empty())
            std::cout << (options.run_dir / "states" / (name + ".pvsm")).string() << '\n';
        else
            std::cout << "no state \"" << name << "\": " << why_not << '\n';
    }
    return 0;
}

}  // namespace frana
