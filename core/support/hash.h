// core/support/hash.h — FNV-1a hash of bytes, 64 bits: the same on every machine; detects damage, not malice.
// Source: Fowler, Noll & Vo, http://www.isthe.com/chongo/tech/comp/fnv
#pragma once

#include <cstdint>
#include <string_view>

namespace orthant {

inline constexpr std::uint64_t kHashOfNothing = 0xcbf29ce484222325U;

/// Of the bytes that `hash` has been made of, and these.
inline std::uint64_t fnv1a(std::string_view bytes, std::uint64_t hash = kHashOfNothing) {
  for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001b3U;
  return hash;
}

}  // namespace orthant
