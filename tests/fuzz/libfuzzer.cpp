// One program of libFuzzer's for the target named ORTHANT_FUZZ_TARGET (preset fuzz).
#include "target.h"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  orthant::fuzz::ORTHANT_FUZZ_TARGET({reinterpret_cast<const char*>(data), size});
  return 0;
}
