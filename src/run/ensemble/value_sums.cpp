#include "run/ensemble/value_sums.h"

#include <fmt/core.h>

#include "io/gdal_sum.h"
#include "run/ensemble/kept_rows.h"
#include "scene/case_file.h"

namespace frana {
namespace {

std::string set_of(const EnsemblePlan& plan, Index sample, std::size_t key) {
    return plan.vary[key].key + "=" + plan.points[static_cast<std::size_t>(sample)].values[key];
}

}  // namespace

ValueSums::ValueSums(const EnsemblePlan& plan) : plan_(plan) {
    for (std::size_t k = 0; k < plan.vary.size(); ++k) {
        const bool texts =
            plan.method == Method::table || plan.vary[k].distribution.kind == Distribution::Kind::discrete;
        if (const Parameter* parameter = find_parameter(plan.vary[k].key); texts && parameter)
            if (names_files(parameter->kind)) keys_.push_back(k);
    }
    if (keys_.empty()) return;
    const CaseFile file = CaseFile::read(plan.case_file);
    std::map<std::string, bool> seen;
    for (Index i = 0; i < plan.samples; ++i)
        for (const std::size_t key : keys_) {
            const std::string set = set_of(plan, i, key);
            if (!seen.try_emplace(set, true).second) continue;
            std::string sums;
            for (const std::filesystem::path& path : file.files_of_set(set)) sums += sum_of_input(path);
            if (!sums.empty()) sums_[set] = sums;
        }
}

std::string ValueSums::of(Index sample) const {
    std::string all;
    for (const std::size_t key : keys_)
        if (const auto found = sums_.find(set_of(plan_, sample, key)); found != sums_.end())
            all += " " + plan_.vary[key].key + " " + found->second;
    return all.empty() ? "" : fmt::format("{:016x}", sum_of(all));
}

std::string ValueSums::values_of(Index sample) const {
    std::string all;
    for (const std::size_t key : keys_)
        if (sums_.count(set_of(plan_, sample, key)) > 0)
            all += fmt::format("{}{}={}", all.empty() ? "" : ", ", plan_.vary[key].key,
                               shown_value(plan_.points[static_cast<std::size_t>(sample)].values[key]));
    return all;
}

}  // namespace frana
