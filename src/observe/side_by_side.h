#pragma once
#include <memory>
#include <string>
#include <vector>

#include "observe/observer.h"

namespace frana {

/// Several observers as one, for writers of files that do not need one another. They observe a frame on several
/// threads, each on one of them. All else they do one after the other. The first part in their order that fails is the
/// one that is told of.
std::unique_ptr<Observer> side_by_side(std::string name, std::vector<std::unique_ptr<Observer>> parts, int threads);

}  // namespace frana
