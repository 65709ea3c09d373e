#pragma once
// What other open codes reach on the same problems: error and wall time. This project measured their released versions
// on one quiet machine (2 cores, x86-64). Times are the least of three runs where not said otherwise.
#include <string>
#include <vector>

namespace frana::verify {

struct PeerPoint {
    double seconds, error;
};

struct PeerCurve {
    std::string problem;   ///< as in the library
    std::string quantity;  ///< l1_depth or l2_depth
    std::string code;      ///< name, version and setting
    std::vector<PeerPoint> points;
};

const std::vector<PeerCurve>& peers();

}  // namespace frana::verify
