#include "ensemble/evidence.h"

#include <limits>

namespace frana {

const EvidenceKind& kind_of(Evidence evidence) {
    static const std::array<EvidenceKind, kEvidence> kinds = {
        {{"outline", "m", "distance of the outlines"},
         {"runout", "m", "difference of the runouts"},
         {"deposit", "m", "difference of the deposits, on the mean of blocks"},
         {"bed_change", "m", "difference of the changes of the ground, on the mean of blocks"},
         {"gauges", "1", "difference of the logarithms of largest depths and speeds at gauges"}}};
    return kinds[static_cast<std::size_t>(evidence)];
}

const std::array<Evidence, kEvidence>& all_evidence() {
    static const std::array<Evidence, kEvidence> all = {Evidence::outline, Evidence::runout, Evidence::deposit,
                                                        Evidence::bed_change, Evidence::gauges};
    return all;
}

double SurveyErrors::of(Evidence evidence) const {
    switch (evidence) {
        case Evidence::outline:
            return outline;
        case Evidence::runout:
            return runout;
        case Evidence::gauges:
            return log;
        case Evidence::deposit:
        case Evidence::bed_change:
            break;
    }
    return height;
}

double log_likelihood(const EventScores& scores, const std::vector<Evidence>& objective, const SurveyErrors& errors) {
    double sum = 0.0;
    for (const Evidence evidence : objective) {
        const auto& misfit = scores.misfits[static_cast<std::size_t>(evidence)];
        if (!misfit) return -std::numeric_limits<double>::infinity();
        const double apart = misfit->rms / errors.of(evidence);
        sum -= 0.5 * misfit->number * apart * apart;
    }
    return sum;
}

}  // namespace frana
