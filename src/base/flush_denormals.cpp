#include "base/flush_denormals.h"

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace frana {

void flush_denormals_on_all_threads() {
#if defined(__SSE2__)
    constexpr unsigned kFlushToZero = 0x8000, kDenormalsAreZero = 0x0040;
#pragma omp parallel
    _mm_setcsr(_mm_getcsr() | kFlushToZero | kDenormalsAreZero);
#endif
}

}  // namespace frana
