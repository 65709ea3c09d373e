#pragma once

namespace frana {

/// CPU time that the calling thread has used so far [s]. Other work on the machine does not count, unlike in wall time.
double thread_cpu_seconds();

}  // namespace frana
