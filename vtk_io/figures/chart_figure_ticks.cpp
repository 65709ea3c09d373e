#include "vtk_io/figures/chart_figure_ticks.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace frana {
namespace {

constexpr double kSlack = 1e-9;  // relative, so that 0.3 counts as a multiple of 0.1

double power_of_ten_below(double value) { return std::pow(10.0, std::floor(std::log10(value) + kSlack)); }

}  // namespace

double round_down_125(double value) {
    const double power = power_of_ten_below(value);
    const double lead = value / power * (1.0 + kSlack);
    return power * (lead >= 5.0 ? 5.0 : lead >= 2.0 ? 2.0 : 1.0);
}

double round_up_125(double value) {
    const double power = power_of_ten_below(value);
    const double lead = value / power * (1.0 - kSlack);
    return power * (lead <= 1.0 ? 1.0 : lead <= 2.0 ? 2.0 : lead <= 5.0 ? 5.0 : 10.0);
}

double round_limit(double value) {
    constexpr std::array<double, 11> steps{1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10};
    const double power = power_of_ten_below(value);
    const double lead = value / power * (1.0 - kSlack);
    return power * *std::lower_bound(steps.begin(), steps.end() - 1, lead);
}

std::string with_step(double value, double step) {
    const double digits = std::max(0.0, std::ceil(-std::log10(step) - kSlack));
    if (digits > 6 || std::abs(value) >= 1e9) return fmt::format("{:.3g}", value);
    return fmt::format("{:.{}f}", std::abs(value) < kSlack * step ? 0.0 : value, static_cast<int>(digits));
}

Ticks ticks_between(double low, double high, int most) {
    Ticks ticks;
    if (!(high > low)) return ticks;
    double step = round_down_125((high - low) / most);
    const auto first = [&] { return std::ceil(low / step - kSlack); };
    const auto last = [&] { return std::floor(high / step + kSlack); };
    while (last() - first() + 1 > most) {
        const double finer = step;
        step = round_up_125(1.5 * step);
        if (last() - first() + 1 >= 2) continue;
        step = finer;
        break;
    }
    for (double k = first(); k <= last(); ++k) {
        ticks.at.push_back(k * step);
        ticks.labels.push_back(with_step(k * step, step));
    }
    return ticks;
}

Ticks log_ticks(double low, double high, int most) {
    Ticks ticks;
    const int first = static_cast<int>(std::ceil(std::log10(low) - kSlack));
    const int last = static_cast<int>(std::floor(std::log10(high) + kSlack));
    const int stride = std::max(1, (last - first + most) / std::max(most, 1));
    for (int k = first; k <= last; k += stride) {
        ticks.at.push_back(std::pow(10.0, k));
        ticks.labels.push_back(k >= -3 && k <= 4 ? with_step(std::pow(10.0, k), std::pow(10.0, k))
                                                 : fmt::format("1e{}", k));
    }
    return ticks;
}

std::string length_text(double metres) {
    if (metres >= 1000.0) return fmt::format("{:g} km", metres / 1000.0);
    return fmt::format("{:g} m", metres);
}

std::pair<std::string, std::string> name_and_unit(const std::string& label) {
    const auto open = label.rfind('[');
    const auto close = label.rfind(']');
    if (open == std::string::npos || close == std::string::npos || close < open) return {label, ""};
    std::string name = label.substr(0, open);
    while (!name.empty() && name.back() == ' ') name.pop_back();
    return {name, label.substr(open + 1, close - open - 1)};
}

}  // namespace frana
