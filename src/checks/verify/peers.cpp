#include "checks/verify/peers.h"

namespace frana::verify {

const std::vector<PeerCurve>& peers() {
    static const std::vector<PeerCurve> all = {
        // OpenNHM/AvaFrame efeb01c3 (com1DFA), triangular placement, time of its step loop; error at t = 5.00 s.
        {"similarity",
         "l2_depth",
         "AvaFrame",
         {{0.031, 3.54e-2}, {0.035, 2.60e-2}, {0.50, 1.03e-2}, {4.54, 8.4e-3}, {15.5, 7.7e-3}, {28.0, 6.3e-3}}},
        {"slope_dam", "l2_depth", "AvaFrame", {{0.074, 4.96e-2}, {1.09, 2.24e-2}, {9.5, 1.59e-2}, {60.9, 9.6e-3}}},
        // geoflows/dclaw 28ec749a on clawpack 5.14, one level, order 2, cfl 0.4.
        {"similarity", "l2_depth", "D-Claw", {{0.021, 5.71e-2}, {0.116, 3.05e-2}, {0.675, 2.21e-2}, {4.19, 1.67e-2}}},
        {"slope_dam", "l2_depth", "D-Claw", {{0.011, 7.39e-2}, {0.043, 4.63e-2}, {0.152, 2.57e-2}, {0.440, 1.37e-2}}},
        // GeoClaw 5.14.0, one level, order 2, MC limiter, cfl 0.9; dam breaks as a strip of four rows.
        {"thacker_period", "l1_depth", "GeoClaw, dry 1e-5", {{1.82, 2.56e-2}, {12.2, 1.42e-2}}},
        {"thacker_period", "l1_depth", "GeoClaw, dry 1e-4", {{0.96, 3.98e-2}, {5.13, 2.46e-2}, {38.6, 1.45e-2}}},
        {"ritter", "l1_depth", "GeoClaw", {{0.019, 1.322e-2}, {0.037, 6.93e-3}, {0.144, 3.56e-3}}},
        {"stoker", "l1_depth", "GeoClaw", {{0.011, 7.38e-3}, {0.031, 3.91e-3}, {0.124, 2.01e-3}}},
    };
    return all;
}

}  // namespace frana::verify
