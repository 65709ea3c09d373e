#pragma once
// What was measured when a dam broke before a box: MARIN's experiment (Kleefsman, Fekken, Veldman, Iwanowski and Buchner
// 2005, J. Comput. Phys. 206, 363, doi:10.1016/j.jcp.2004.12.007). It is the second test of SPHERIC (Issa and Violeau
// 2006). Means over short times of the public records, which have a value each millisecond. Pressures drift by some 80
// Pa before the water comes.
#include <array>

namespace frana::verify::marin {

constexpr double kTank[3] = {3.22, 1.0, 1.0};            ///< [m]; open above
constexpr double kReservoirFrom = 1.992, kDepth = 0.55;  ///< the water at rest, to the end of the tank [m]
constexpr double kBoxFrom = 0.6635, kBoxTo = 0.8245;     ///< along the tank; the water comes from kTank[0] [m]
constexpr double kBoxSide = 0.2955, kBoxWidth = 0.403;   ///< [m]
constexpr double kBoxHeight = 0.161;                     ///< [m]
constexpr std::array<double, 4> kGauges{2.638, 1.488, 0.992, 0.496};  ///< of the level, in the middle of the tank [m]

/// Four sensors stand one above the other, near the middle of the face that the water meets. Each represents a quarter
/// of its height. Of their mean: when it passes 300 Pa [s], and its integral over 0.25 s from then [Pa s]. Also its
/// mean from 0.046 to 0.086 s after it, when all four are wet [Pa].
constexpr double kArrival = 0.394, kThreshold = 300.0, kImpulse = 1244.0, kImpulseOver = 0.25;
constexpr double kEarlyFrom = 0.046, kEarlyTo = 0.086, kEarly = 6796.0;

/// Means from one time to another: levels at kGauges [m], and the mean of the four sensors [Pa].
struct Window {
    double from, to;
    std::array<double, 4> level;
    double pressure;
};
constexpr std::array<Window, 9> kWindows{{{0.753, 0.828, {0.335, 0.135, 0.146, 0.002}, 3485},
                                          {1.000, 1.076, {0.269, 0.157, 0.184, 0.165}, 2864},
                                          {1.247, 1.323, {0.217, 0.156, 0.205, 0.305}, 2361},
                                          {1.495, 1.572, {0.178, 0.143, 0.233, 0.356}, 2189},
                                          {1.740, 1.816, {0.150, 0.127, 0.331, 0.303}, 2400},
                                          {1.986, 2.060, {0.129, 0.157, 0.293, 0.293}, 2409},
                                          {2.230, 2.307, {0.114, 0.296, 0.291, 0.295}, 2271},
                                          {2.478, 2.553, {0.103, 0.268, 0.277, 0.319}, 1961},
                                          {2.970, 3.048, {0.203, 0.234, 0.203, 0.229}, 1257}}};
constexpr double kLate = 1.0;  ///< from here on the load is late [s]

}  // namespace frana::verify::marin
