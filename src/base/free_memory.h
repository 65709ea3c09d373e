#pragma once

namespace frana {

/// Memory that this process can still get without swapping [bytes]. It is what the system has left, or the container's
/// limit leaves where that is less. Infinite where neither is known.
double free_memory();

}  // namespace frana
