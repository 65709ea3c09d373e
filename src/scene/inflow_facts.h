#pragma once
#include <string>

#include "scene/scene.h"

namespace frana {

/// Main figures of an inflow.
struct InflowFacts {
    double volume = 0.0;                 ///< of the table [m3]
    double peak = 0.0, peak_time = 0.0;  ///< largest discharge [m3/s]; [s]
    double end = 0.0;                    ///< of the table [s]
    double width = 0.0;                  ///< of the line [m]
    double area = 0.0;                   ///< [m2]; above 0: there is no line, and what follows is 0
    double layer = 0.0;                  ///< depth that comes in at once over an area; 0: free water [m]
    double slope_deg = 0.0;              ///< of the bed there; below 0: it climbs [degrees]
    double thickness = 0.0;              ///< normal to the bed, at the peak [m]
    double speed = 0.0;                  ///< along the bed, at the peak [m/s]
    double froude = 0.0;                 ///< speed over that of long waves, at the peak [1]
};

InflowFacts facts_of(const Inflow& inflow, double gravity);
/// The same in a line for people, with what a slow flow means.
std::string inflow_sentence(const std::string& name, const InflowFacts& facts);

}  // namespace frana
