#pragma once
// Small value types shared by every room. SI units everywhere; angles in radians inside the program.
#include <Eigen/Core>
#include <cstdint>

namespace frana {

using Index = std::int64_t;
using Vec2 = Eigen::Vector2d;
using Mat2 = Eigen::Matrix2d;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
static_assert(alignof(Mat2) == 32,
              "all files have Eigen's alignment of CMakeLists.txt, whatever processor they are for");

}  // namespace frana
