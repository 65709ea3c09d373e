#pragma once
#include <optional>
#include <string>
#include <vector>

#include "observe/frame.h"

namespace frana {

/// One number a node or particle, borrowed from a frame.
struct Scalar {
    std::string name, unit;
    const double* data = nullptr;
    Index count = 0;
    int stride = 1;
    double operator[](Index k) const { return data[k * stride]; }
};

/// A scalar field by its name, or a component as "velocity_x", "stress_xy"; nothing when there is none.
std::optional<Scalar> find_scalar(const std::vector<Field>& fields, const std::string& name);

/// The same; throws UserError when the fields of `whose` ("the grid") have no such name.
Scalar scalar(const std::vector<Field>& fields, const std::string& name, const char* whose);

}  // namespace frana
