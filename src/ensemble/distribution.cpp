#include "ensemble/distribution.h"

#include <fmt/format.h>

#include <boost/math/distributions/beta.hpp>
#include <boost/math/distributions/normal.hpp>
#include <cmath>

#include "base/error.h"

namespace frana {
namespace {

/// A normal distribution without what lies outside of [low, high].
double cut_normal(double mean, double deviation, double low, double high, double u) {
    const boost::math::normal normal(mean, deviation);
    const double below = std::isfinite(low) ? boost::math::cdf(normal, low) : 0.0;
    const double above = std::isfinite(high) ? boost::math::cdf(normal, high) : 1.0;
    return std::min(high, std::max(low, boost::math::quantile(normal, below + u * (above - below))));
}

double triangular(double low, double mode, double high, double u) {
    const double at_mode = (mode - low) / (high - low);
    if (u < at_mode) return low + std::sqrt(u * (high - low) * (mode - low));
    return high - std::sqrt((1.0 - u) * (high - low) * (high - mode));
}

}  // namespace

double Distribution::number(double u) const {
    switch (kind) {
        case Kind::uniform:
            return low + u * (high - low);
        case Kind::loguniform:
            return std::exp(std::log(low) + u * (std::log(high) - std::log(low)));
        case Kind::normal:
            return cut_normal(middle, spread, low, high, u);
        case Kind::lognormal:
            return std::exp(cut_normal(std::log(middle), std::log(spread), std::log(low), std::log(high), u));
        case Kind::triangular:
            return triangular(low, middle, high, u);
        case Kind::beta:
            return low + (high - low) * boost::math::quantile(boost::math::beta_distribution<double>(alpha, beta), u);
        case Kind::discrete:
            break;
    }
    throw InternalError("internal error: a discrete distribution has no numbers");
}

double Distribution::share_between() const {
    const bool log = kind == Kind::lognormal;
    const boost::math::normal normal(log ? std::log(middle) : middle, log ? std::log(spread) : spread);
    const auto below = [&](double x) {
        const double z = log ? std::log(x) : x;
        return std::isfinite(z) ? boost::math::cdf(normal, z) : z > 0.0 ? 1.0 : 0.0;
    };
    return below(high) - below(low);
}

std::size_t Distribution::choice(double u) const {
    double below = 0.0;
    for (std::size_t k = 0; k + 1 < values.size(); ++k)
        if ((below += weights[k]) > u) return k;
    return values.size() - 1;
}

std::string Distribution::text(double u) const {
    return kind == Kind::discrete ? values[choice(u)] : fmt::format("{}", number(u));
}

}  // namespace frana
