#pragma once
// Sums of what the files hold that only values of an ensemble name, for seeing that one of them has changed.
#include <map>
#include <string>
#include <vector>

#include "ensemble/plan.h"

namespace frana {

class ValueSums {
public:
    /// Of the files as they are now.
    explicit ValueSums(const EnsemblePlan& plan);

    /// Of all files that a sample's values name, as hexadecimal digits; empty where they name none.
    std::string of(Index sample) const;
    /// "release.0.outline=b.geojson": the values of a sample that name files, for people.
    std::string values_of(Index sample) const;

private:
    const EnsemblePlan& plan_;
    std::vector<std::size_t> keys_;            ///< of the varied ones, those that can name files
    std::map<std::string, std::string> sums_;  ///< by "key=value"; of those that do
};

}  // namespace frana
