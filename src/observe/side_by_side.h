#pragma once
#include <memory>
#include <string>
#include <vector>

#include "observe/observer.h"

namespace frana {

/// Observers as one that looks at a frame on several threads, each part on one of them: for writers of files, of which none
/// needs another. All else they do one after the other. The first part in their order that fails is the one that is told of.
std::unique_ptr<Observer> side_by_side(std::string name, std::vector<std::unique_ptr<Observer>> parts, int threads);

}  // namespace frana
