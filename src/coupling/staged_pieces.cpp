// What the points of a run in stages have come apart into, at its output times.
#include <fmt/core.h>

#include "coupling/staged_run.h"
#include "solid3d/pieces.h"

namespace frana {

void StagedRun::find_pieces() {
    timed_("pieces", [&] {
        const Pieces now = pieces_of(points_->body().points, points_->body().grid);
        apart_.pieces = now.count, apart_.apart = now.apart, apart_.alone = now.alone;
        if (!(now.apart > apart_.most_apart)) return;
        apart_.most_apart = now.apart;
        apart_.most_apart_time = points_->status().time;
    });
}

Extras StagedRun::extras() const {
    Extras extras;
    if (points_) extras.points_apart = apart_;
    return extras;
}

/// Drops and ends of less than a hundredth of the mass change no result that a run has.
void StagedRun::remark_pieces(std::vector<std::string>& remarks) const {
    constexpr double kWorthARemark = 0.01;
    if (apart_.most_apart < kWorthARemark) return;
    remarks.push_back(fmt::format(
        "3D points came apart: {:.3g} % of their mass lay more than a cell from the largest piece at {:.6g} s; "
        "at the last output {:.3g} % in {} pieces, and {:.3g} % felt nothing of the largest. Spray and what slides "
        "off part in nature, thin material that is drawn out further than its points does by the scheme (numerical "
        "fracture); more points, by a smaller stage.spacing, keep more of it together",
        100.0 * apart_.most_apart, apart_.most_apart_time, 100.0 * apart_.apart, apart_.pieces, 100.0 * apart_.alone));
}

}  // namespace frana
