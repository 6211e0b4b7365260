// tests/support/sanitized.h — whether a sanitizer slows this program, for tests that would take too long there.
#pragma once

extern "C" void __asan_init() __attribute__((weak));  // of the address sanitizer, where the program has it

namespace orthant {

#if defined(__SANITIZE_THREAD__)
inline const bool kSanitized = true;
#else
inline const bool kSanitized = __asan_init != nullptr;
#endif

/// Of many trials a fifth, where they are slow.
inline int share_of(int trials) { return kSanitized ? trials / 5 : trials; }

}  // namespace orthant
