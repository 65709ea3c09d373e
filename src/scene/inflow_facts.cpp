#include "scene/inflow_facts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/constants.h"

namespace frana {

InflowFacts facts_of(const Inflow& of, double gravity) {
    InflowFacts facts;
    for (std::size_t n = 0; n + 1 < of.time.size(); ++n)
        facts.volume += 0.5 * (of.time[n + 1] - of.time[n]) * (of.discharge[n] + of.discharge[n + 1]);
    const auto peak =
        static_cast<std::size_t>(std::max_element(of.discharge.begin(), of.discharge.end()) - of.discharge.begin());
    const double cosine = 1.0 / std::sqrt(1.0 + of.slope * of.slope);
    facts.peak = of.discharge[peak], facts.peak_time = of.time[peak], facts.end = of.time.back();
    facts.area = of.area, facts.layer = of.layer;
    if (of.area > 0.0) return facts;
    facts.width = of.width();
    facts.slope_deg = std::atan(of.slope) / constants::kDegree + 0.0;  // no -0
    facts.speed = of.speed[peak] / cosine;
    facts.thickness = facts.peak / (facts.width * facts.speed);
    facts.froude = facts.speed / std::sqrt(gravity * cosine * facts.thickness);
    return facts;
}

std::string inflow_sentence(const std::string& name, const InflowFacts& f) {
    if (f.area > 0.0)
        return fmt::format(
            "inflow {}: {:.6g} m3 until {:.6g} s, at most {:.4g} m3/s at {:.6g} s; at rest over {:.5g} m2{}; in all a "
            "depth "
            "of {:.3g} m there, if none of it flowed off",
            name, f.volume, f.end, f.peak, f.peak_time, f.area,
            f.layer > 0.0 ? fmt::format(", in layers of {:.3g} m", f.layer) : "", f.volume / f.area);
    std::string text = fmt::format(
        "inflow {}: {:.6g} m3 until {:.6g} s, at most {:.4g} m3/s at {:.6g} s; the line is {:.4g} m wide on a slope of "
        "{:.3g} "
        "degrees; then {:.3g} m thick at {:.4g} m/s, Froude number {:.3g}",
        name, f.volume, f.end, f.peak, f.peak_time, f.width, f.slope_deg, f.thickness, f.speed, f.froude);
    if (f.froude < 1.0)
        text +=
            "; so slow a flow may be held up from below, and part of it spread upstream: look at it, or put the line "
            "where the "
            "ground is steeper, or narrower";
    return text;
}

}  // namespace frana
