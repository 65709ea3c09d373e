#include "run/folder/input_sums.h"

#include <fmt/core.h>

#include <map>

#include "io/gdal_sum.h"
#include "scene/case_file.h"

namespace frana {

std::vector<InputSum> input_sums(const CaseFile& file) {
    std::vector<InputSum> sums;
    std::map<std::string, int> counts;
    for (const auto& [key, path] : file.named_files())
        sums.push_back({fmt::format("{}.{}", key, counts[key]++), sum_of_input(path), path});
    return sums;
}

std::string mark_of_inputs(const CaseFile& file) {
    std::string text = file.text();
    for (const InputSum& input : input_sums(file)) text += fmt::format(" {} {}", input.key, input.sum);
    return text;
}

}  // namespace frana
