#pragma once
// Tables of discharge over time, and triangles from a volume.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/types.h"

namespace frana {

/// A discharge over time, linear between its rows.
struct Hydrograph {
    std::vector<double> time;       ///< [s]
    std::vector<double> discharge;  ///< [m3/s]
    std::vector<double> velocity;   ///< along the bed [m/s]; empty: the table has none
    std::string remark = {};        ///< how it was understood, where it does not say itself

    double volume() const;  ///< [m3]
};

/// Reads a CSV (comma, semicolon or blanks) whose header names columns and units. These are t [s] or t_min or t_h,
/// discharge [m3/s] and, if there is one, velocity [m/s]. Also reads rows of r.avaflow, without units: t, Q and v of
/// one to three phases. They stand under a header T, Q1, v1, ... or without one. Their discharges are summed, and the
/// velocity is the mean of what flows, with a remark. Throws UserError with line, what was found and what is expected.
Hydrograph read_hydrograph(const std::filesystem::path& file);
/// The same from the table's text.
Hydrograph parse_hydrograph(const std::string& text, const std::string& source);

/// The empirical formulas of debris flows' largest discharge from their volume.
const std::vector<std::string>& peak_formulas();
/// That of a volume [m3] by one of them [m3/s].
double peak_discharge(const std::string& formula, double volume);
/// A triangle of that volume [m3] with that highest discharge [m3/s]. It begins at `at` [s] and is highest `rise` [s] later:
/// nothing, a tenth of its time.
Hydrograph triangle(double volume, double peak, double at = 0.0, std::optional<double> rise = {});

}  // namespace frana
