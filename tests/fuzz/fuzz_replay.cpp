// Hands every file of the corpora, seeds and past findings, to its target: fuzz_replay CORPUS_FOLDER
// A new seed for `checkpoint`: fuzz_replay --checkpoint FILE
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <vector>

#include "fuzz/targets.h"

int main(int argc, char** argv) {
    namespace fs = std::filesystem;
    if (argc == 3 && std::string(argv[1]) == "--checkpoint") {
        frana::fuzz::make_checkpoint(argv[2]);
        return 0;
    }
    if (argc != 2) {
        std::cerr << "fuzz_replay CORPUS_FOLDER\n";
        return 2;
    }
    int failures = 0;
    for (const auto& [name, target] : frana::fuzz::targets()) {
        int inputs = 0;
        for (const fs::directory_entry& entry : fs::directory_iterator(fs::path(argv[1]) / name)) {
            std::ifstream stream(entry.path(), std::ios::binary);
            std::ostringstream bytes;
            bytes << stream.rdbuf();
            ++inputs;
            try {
                target(bytes.str());
            } catch (const std::exception& error) {
                ++failures;
                std::cout << entry.path().string() << ": " << error.what() << '\n';
            }
        }
        std::cout << name << ": " << inputs << " inputs\n";
        failures += inputs == 0;
    }
    return failures == 0 ? 0 : 1;
}
