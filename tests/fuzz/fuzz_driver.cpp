// libFuzzer's entry for one target, FRANA_FUZZ_TARGET.
#include "fuzz/targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    frana::fuzz::FRANA_FUZZ_TARGET(frana::fuzz::Input(reinterpret_cast<const char*>(data), size));
    return 0;
}
