// tests/support/sanitized.h — whether a sanitizer slows this program, for tests that would take too long there.
#pragma once

// The tests' own objects need no sanitizer to be linked with libraries that have one, so the program is asked.
extern "C" {
[[gnu::weak]] void __asan_init();  // NOLINT: the sanitizers' names
[[gnu::weak]] void __tsan_init();  // NOLINT
}

namespace orthant {

inline const bool kSanitized = __asan_init != nullptr || __tsan_init != nullptr;

/// Of many trials a fifth, where they are slow.
inline int share_of(int trials) { return kSanitized ? trials / 5 : trials; }

}  // namespace orthant
