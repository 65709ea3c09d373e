#include "observe/file_arrays.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"

namespace frana {
namespace {

template <class T>
bool holds(double value) {
    constexpr double largest = static_cast<double>(std::numeric_limits<T>::max());
    return std::abs(value) <= largest;  // false for NaN
}

double smallest(const Field& field) {
    double least = std::numeric_limits<double>::infinity();
    for (Index k = 0; k < field.count; ++k)
        if (std::isfinite(field.data[k])) least = std::min(least, field.data[k]);
    return std::isfinite(least) ? least : 0.0;
}

bool ends_with(const std::string& text, const std::string& tail) {
    return text.size() >= tail.size() && text.compare(text.size() - tail.size(), tail.size(), tail) == 0;
}

}  // namespace

Storage storage_of(const Field& field) {
    if (field.name == "id") return Storage::int64;
    if (field.name == "mass" || field.name == "volume" || field.name == "position") return Storage::float64;
    return Storage::float32;
}

std::vector<std::string> component_names(const Field& field) {
    if (field.components == 6) return {"xx", "yy", "zz", "xy", "yz", "xz"};
    if (field.components != 3) return {};
    if (ends_with(field.name, "stress")) return {"xx", "yy", "xy"};
    return {"x", "y", "z"};
}

std::vector<std::uint8_t> outside_nodes(const Frame& frame) {
    const Field* elevation = frame.node("elevation");
    if (!elevation) return {};
    const double* end = elevation->data + elevation->count;
    if (std::none_of(elevation->data, end, [](double z) { return std::isnan(z); })) return {};
    std::vector<std::uint8_t> outside(static_cast<std::size_t>(elevation->count));
    std::transform(elevation->data, end, outside.begin(),
                   [](double z) { return static_cast<std::uint8_t>(std::isnan(z) ? 1 : 0); });
    return outside;
}

template <class T>
void copy_array(const Field& field, const std::vector<std::uint8_t>& outside, T* target) {
    const Index numbers = field.count * field.components;
    Index misfits = 0;
    for (Index k = 0; k < numbers; ++k) {
        const bool fits = holds<T>(field.data[k]);
        misfits += fits ? 0 : 1;
        target[k] = fits ? static_cast<T>(field.data[k]) : T{0};
    }
    if (misfits == 0) return;
    const double stand_in = field.components == 1 ? smallest(field) : 0.0;
    for (Index k = 0; k < numbers; ++k) {
        if (holds<T>(field.data[k])) continue;
        const Index item = k / field.components;
        const bool hidden = !outside.empty() && outside[static_cast<std::size_t>(item)] != 0;
        if (!hidden || !std::isnan(field.data[k]))
            throw NumericsError(
                fmt::format("{} of item {} is {}: a file takes finite numbers up to {:.3g} only; look "
                            "at the step before in history.csv",
                            field.name, item, field.data[k], static_cast<double>(std::numeric_limits<T>::max())));
        target[k] = static_cast<T>(stand_in);
    }
}

template void copy_array<float>(const Field&, const std::vector<std::uint8_t>&, float*);
template void copy_array<double>(const Field&, const std::vector<std::uint8_t>&, double*);
template void copy_array<std::int64_t>(const Field&, const std::vector<std::uint8_t>&, std::int64_t*);

}  // namespace frana
