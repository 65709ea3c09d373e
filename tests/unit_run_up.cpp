#include "coupling/run_up.h"

#include <cmath>

#include "catch.h"

using namespace frana;

TEST_CASE("Run-up is the height below which 99.9 % of the mass lies, whatever single drops do", "[barrier]") {
    RunUp reached;
    reached.begin();
    CHECK(reached.level() == -INFINITY);
    for (int k = 0; k < 5000; ++k) reached.add(0.001 * ((k * 1709) % 5000), 2.0);  // 0 to 4.999, in any order
    reached.add(40.0, 2.0);
    reached.add(50.0, 2.0);
    // 0.1 % of 5002 equal points are five whole ones: the two drops, 4.999, 4.998 and 4.997 may be above.
    CHECK(reached.level() == 4.996);
    reached.begin();
    reached.add(3.0, 1.0);
    CHECK(reached.level() == 3.0);  // a single point is all there is
}

TEST_CASE("A heavy point counts with its mass, two drops never do", "[barrier]") {
    RunUp reached;
    reached.begin();
    for (int k = 0; k < 100; ++k) reached.add(0.01 * k, 1.0);
    reached.add(9.0, 1.0);
    reached.add(8.0, 1.0);
    CHECK(reached.level() == 0.99);  // each drop has 1 % of the mass and is a drop all the same
    reached.begin();
    for (int k = 0; k < 100; ++k) reached.add(0.01 * k, 1.0);
    for (const double z : {9.0, 8.0, 7.0}) reached.add(z, 1.0);
    CHECK(reached.level() == 7.0);  // three of a hundred are no drops any more
}
