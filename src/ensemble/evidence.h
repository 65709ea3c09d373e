#pragma once
// What of a survey counts, and how likely it is if a run were right.
#include <array>
#include <optional>
#include <vector>

#include "base/types.h"

namespace frana {

/// What was surveyed of an event.
enum class Evidence { outline, runout, deposit, bed_change, gauges };
constexpr std::size_t kEvidence = 5;

struct EvidenceKind {
    const char *word, *unit, *meaning;  ///< of the distance between run and survey
};
const EvidenceKind& kind_of(Evidence evidence);
/// In the order of the words.
const std::array<Evidence, kEvidence>& all_evidence();

/// Standard deviations of survey and model together.
struct SurveyErrors {
    double outline = 20.0;      ///< of the distance of the outlines [m]
    double correlation = 50.0;  ///< length over which errors go together, along an outline and in a deposit [m]
    double runout = 20.0;       ///< [m]
    double height = 0.5;        ///< of a deposit or a change of the bed, on the mean of a block [m]
    double log = 0.5;           ///< of the natural logarithm of a depth or speed [1]

    double of(Evidence evidence) const;
};

/// How far a run is from what was surveyed of a kind. It is off by so much, in so many places that err independently.
struct Misfit {
    double rms = 0.0;         ///< root of the mean square [unit of the kind]
    double number = 0.0;      ///< of independent errors [1]
    double unsurveyed = 0.0;  ///< simulated where a surveyed raster has no data; in neither of them [m3]
};

/// How near a run came to the survey of its event; nothing where there is no answer.
struct EventScores {
    std::optional<double> iou;       ///< of the footprints [1]
    std::optional<double> boundary;  ///< mean distance of the outlines [m]
    std::array<std::optional<Misfit>, kEvidence> misfits;
};

/// Logarithm of the likelihood of what was surveyed: independent normal errors. Minus infinity where a kind that counts has no
/// answer.
double log_likelihood(const EventScores& scores, const std::vector<Evidence>& objective, const SurveyErrors& errors);

}  // namespace frana
