#pragma once
// How long a step each scheme stands. It is the largest fraction of a cell for which a suite of scenes satisfies the
// invariants.
#include "checks/fuzz/trial.h"

namespace frana::fuzz {

/// A shape function with a transfer and a number of points.
struct Method {
    std::string preset = "default";
    Shape shape = Shape::quadratic;
    Transfer transfer = Transfer::tpic;
    int per_side = 2;          ///< points a cell and direction
    std::string name() const;  ///< "quadratic tpic"
};

struct CflRow {
    Method method;
    double largest = 0.0;      ///< of cfl_ladder(), with all below it stable too; 0: none
    std::string first_broken;  ///< scene and invariant that break beyond; empty when nothing did
};

/// The fractions tried, ascending.
const std::vector<double>& cfl_ladder();
std::vector<Method> cfl_methods();

/// The suite: a dam break on level ground, a column that collapses, streams that meet, a bowl that swings. Also a slide
/// on 40 degrees, a viscous mass and a thin film. All have an energy law.
struct SuiteScene {
    std::string name;
    Scene scene;
};
std::vector<SuiteScene> cfl_suite(const Method& method);

/// Runs the suite at rising fractions, `steps` steps each.
CflRow cfl_row(const Method& method, Index steps = 100);

/// For people: a row a shape and transfer, a column a number of points.
std::string cfl_table(const std::vector<CflRow>& rows);

}  // namespace frana::fuzz
