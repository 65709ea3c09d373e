#pragma once
// Sums of what the files of a case hold, for seeing that one of them has changed.
#include <filesystem>
#include <string>
#include <vector>

namespace frana {

class CaseFile;

struct InputSum {
    std::string key;             ///< "release.0.depth.0": the key, and which of the files that it names
    std::string sum;             ///< as of sum_of_input
    std::filesystem::path file;  ///< as it is opened
};

/// Of every file that the case names, in the order of the keys.
std::vector<InputSum> input_sums(const CaseFile& file);

/// A text that changes with the case's own text and with each of those files, wherever they lie.
std::string mark_of_inputs(const CaseFile& file);

}  // namespace frana
