#pragma once
// What an ensemble is to do, from its file: which keys of a case vary and how, which results count.
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "ensemble/design.h"
#include "ensemble/distribution.h"
#include "ensemble/hazard.h"

namespace frana {

constexpr Index kMostSamples = 10'000'000;

/// A key of the case that varies.
struct Vary {
    std::string key;
    Distribution distribution;
    std::string prior = {};              ///< in words, where it follows from the kind of mass; "": the file gives it
    Index levels = 0;                    ///< of method "grid"; of a discrete distribution the number of its values
    std::vector<double> return_periods;  ///< of a discrete one whose values are scenarios [years]; else empty
};

/// One run of an ensemble.
struct SamplePoint {
    double weight = 1.0;              ///< sum over all samples: their number [1]
    std::vector<std::string> values;  ///< of the keys that vary, as a case file has them
    double return_period = 0.0;       ///< of its scenario [years]; 0 without one
};

struct EnsemblePlan {
    std::filesystem::path file, case_file;
    std::string table_text;  ///< of the table of samples, where they come from one
    Method method = Method::lhs;
    std::string method_name = "lhs";
    Index samples = 0;  ///< of the file, then the number of runs that they become
    std::uint64_t seed = 1;
    std::vector<std::string> fields;                    ///< stored of each run; the first is peak_depth
    std::map<std::string, std::vector<double>> exceed;  ///< by field: thresholds, in the field's unit
    std::vector<double> quantiles;
    std::optional<HazardTable> hazard;
    std::vector<Vary> vary;
    Design design;
    std::vector<SamplePoint> points;

    std::vector<std::string> sets_of(Index sample) const;  ///< "key=value" as for `frana run --set`
};

/// A value of a sample as a table with commas has it: a text is without the quotes of a case file.
std::string shown_value(const std::string& value);

/// Node fields that an ensemble can store, with unit and meaning.
struct PeakField {
    const char *name, *unit, *meaning;
    bool is_time = false;  ///< of arrival: there is none where a run never came
    bool of_bed = false;   ///< of a bed that changes; 0 in runs whose bed does not
};
const std::vector<PeakField>& peak_fields();
/// The one of that name; InternalError without it.
const PeakField& peak_field(const std::string& name);

/// Reads and checks `file`. Throws one UserError with every problem found.
EnsemblePlan read_ensemble(const std::filesystem::path& file);

/// Adds the threshold "FIELD=VALUE" of the command line. Throws UserError.
void add_exceedance(EnsemblePlan& plan, const std::string& argument);

}  // namespace frana
