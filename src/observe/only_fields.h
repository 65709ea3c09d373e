#pragma once
#include <memory>
#include <string>
#include <vector>

#include "observe/observer.h"

namespace frana {

/// Passes frames on to `inner` with the named fields only, besides "position", "elevation" and "id" that every
/// reader needs. No names: every field.
std::unique_ptr<Observer> only_fields(std::unique_ptr<Observer> inner, std::vector<std::string> names);

}  // namespace frana
