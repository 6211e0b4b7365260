// tests/support/sanitized.h — whether a sanitizer slows this build, for tests that would take too long there.
#pragma once

namespace orthant {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

/// Of many trials a fifth, where they are slow.
inline constexpr int share_of(int trials) { return kSanitized ? trials / 5 : trials; }

}  // namespace orthant
