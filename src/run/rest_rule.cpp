#include "run/rest_rule.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/constants.h"
#include "run/end_remarks.h"
#include "run/round_off_speed.h"
#include "run/simulation.h"

namespace frana {
namespace {

constexpr double kMovingShare = 0.01;   ///< of the mass: what a deposit may change by
constexpr double kHold = 0.05;          ///< of the time so far: how long all must be calm
constexpr double kCheck = 0.1 * kHold;  ///< the same between samples

}  // namespace

double RestRule::slow_at(double time) const {
    return time > 0.0 ? 2.0 * cell_ / time : std::numeric_limits<double>::infinity();
}

namespace {

/// Over all that has been released: what has become bed is slow as well.
double mean_speed(const Status& now) {
    const double became_bed = now.bed.deposited - now.bed.eroded;
    return became_bed > 0.0 ? now.mean_speed * now.mass / (now.mass + became_bed) : now.mean_speed;
}

}  // namespace

double round_off_speed(const Simulation& simulation) {
    constexpr double round_off = std::numeric_limits<double>::epsilon();
    const Status& now = simulation.status();
    const double speed = std::sqrt(2.0 * constants::kGravity * round_off * now.max_depth);
    // Extras of solids take long to find. They are not asked of anything faster.
    return now.max_speed_on_map <= speed && of_water_alone(simulation.extras()) ? speed : 0.0;
}

void RestRule::note(const Simulation& simulation) {
    const Status& now = simulation.status();
    peak_mean_speed_ = std::max(peak_mean_speed_, mean_speed(now));
    const bool may_rest = simulation.may_rest();
    const bool still = now.max_speed_on_map == 0.0 || now.max_speed_on_map <= round_off_speed(simulation);
    nothing_moves_ = may_rest && still;
    if (now.time < next_check_) return;
    next_check_ = (1.0 + kCheck) * now.time;
    if (!may_rest || !is_at_rest(simulation)) calm_since_ = now.time;
    rests_ = now.time > 0.0 && now.time - calm_since_ >= kHold * now.time;
}

bool RestRule::is_at_rest(const Simulation& simulation) const {
    const Status& now = simulation.status();
    if (!(mean_speed(now) < fraction_ * peak_mean_speed_)) return false;
    const MovingMass motion = simulation.motion({slow_at(now.time), (1.0 - kHold) * now.time});
    return motion.share() <= kMovingShare && motion.fronts == 0;
}

void RestRule::serialize(Archive& archive) {
    Index nothing_moves = nothing_moves_, rests = rests_;
    archive.numbers("rest", {&peak_mean_speed_, &calm_since_, &next_check_});
    archive.number("nothing_moves", nothing_moves);
    archive.number("rests", rests);
    nothing_moves_ = nothing_moves != 0, rests_ = rests != 0;
}

}  // namespace frana
