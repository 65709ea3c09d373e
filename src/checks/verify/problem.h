#pragma once
// What a verification problem is: a scene from formulas, its exact answer, the checks of that answer, and gates.
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace frana::verify {

using Function = std::function<double(double x, double y)>;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();  ///< a quantity that a problem does not have

/// What a user may vary in a problem.
struct Setup {
    Index cells = 100;               ///< along the problem's reference length
    std::string preset = "default";  ///< "fast", "paper", or "float": the default with scheme.precision = "float"
    int per_side = 2;                ///< points a cell and direction
    std::function<void(Scene&)> edit = {};  ///< last word on the scene: a component switched off, another cfl
};

/// A quantity that only some problems have.
struct Extra {
    std::string name;
    double value = kNone;
    std::string unit = "1";
};

/// One run held against the exact answer; relative norms sum|q - q_e| / sum|q_e| over the nodes (canon, section 0).
struct Measurement {
    std::string name, preset;
    Index cells = 0, particles = 0, steps = 0;
    int per_side = 2;
    int dimensions = 2;         ///< in which points are per_side a cell
    double wall_seconds = 0.0;  ///< of the time loop
    double l1_depth = kNone, l2_depth = kNone, linf_depth = kNone;
    double l1_momentum = kNone, l2_momentum = kNone;  ///< of depth times velocity
    double front_error = kNone;                       ///< [m]
    double mass_error = kNone;                        ///< |V + V_left - V_0| / V_0
    double energy_error =
        kNone;  ///< residual of the energy budget over the largest kinetic or dissipated energy, signed
    std::vector<Extra> extras;
    double observed_order = kNone;  ///< of Problem::order_of, against the next coarser grid; none at round-off

    Index per_cell() const { return dimensions == 3 ? per_side * per_side * per_side : per_side * per_side; }
    /// Any of the above, or of the extras, by name; kNone when there is none.
    double value(const std::string& quantity) const;
    void add(const std::string& extra, double value, const std::string& unit = "1");
};

/// An equation that the exact answer must satisfy, and by how much it fails to.
struct Residual {
    std::string what;
    double value = 0.0;
    double bound = 0.0;
};

/// One list after the other.
inline std::vector<Residual> joined(std::vector<Residual> list, const std::vector<Residual>& more) {
    list.insert(list.end(), more.begin(), more.end());
    return list;
}

/// The largest absolute value that a quantity may have at so many cells (0: at every number of cells).
struct Gate {
    Index cells = 0;
    std::string quantity;
    double bound = 0.0;
    std::string source;  ///< why this bound: the order of the scheme, a table, a peer, round-off
};

struct Problem {
    std::string name;          ///< lower-case word, as `frana verify NAME` has it
    std::string title;         ///< one line: what happens, and whose solution it is
    std::vector<Index> grids;  ///< three or more unless the answer is exact on any grid
    std::function<std::vector<Residual>()> residuals;
    std::function<Measurement(const Setup&)> run;
    std::vector<Gate> gates = {};
    std::string order_of = "l1_depth";  ///< quantity whose order is observed
    bool needs_level = false;           ///< the paper preset is given the still level
    bool takes_minutes = false;         ///< runs when it is named only
    bool finest_is_long = false;  ///< twenty seconds or more, or five that prove what other grids do: `frana verify
                                  ///< --coarse` leaves the last grid out, and the problem where it has no other
    bool in_3d = false;           ///< of the 3D model: has no presets
    bool has_presets = true;      ///< false: of a model on the plane that has none
};

/// The problem's grids; "coarse" those without a last one that takes long: none, where there is no other.
std::vector<Index> grids_of(const Problem& problem, bool coarse);

/// Runs the problem on each grid and fills observed_order in.
std::vector<Measurement> measure(const Problem& problem, Setup setup, const std::vector<Index>& grids);

/// The gates that these measurements miss, each in one sentence; only gates of the default preset, 2 points a side.
std::vector<std::string> missed_gates(const Problem& problem, const std::vector<Measurement>& measurements);

}  // namespace frana::verify
