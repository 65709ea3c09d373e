#pragma once
// The program as a person calls it, built beside the tests.
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "catch.h"
#include "fresh_folder.h"

struct Outcome {
    int code = -1;
    std::string out, err;
};

/// Runs `frana ARGUMENTS` in a folder, where it leaves out.txt and err.txt.
inline Outcome call_frana(const std::filesystem::path& folder, const std::string& arguments) {
    const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "frana";
    INFO("the test needs the target `frana` built beside it");
    REQUIRE(std::filesystem::exists(program));
    const std::string command =
        "cd " + folder.string() + " && " + program.string() + " " + arguments + " > out.txt 2> err.txt";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of(folder / "out.txt"), text_of(folder / "err.txt")};
}
