#include "allocations.h"

#include <atomic>
#include <cstdlib>
#include <new>

// The linker turns malloc(…) into __wrap_malloc(…) and __real_malloc(…) into malloc(…): tests/CMakeLists.txt.
extern "C" {
void* __real_malloc(std::size_t size);                                // NOLINT: the linker's names
void* __real_calloc(std::size_t count, std::size_t size);             // NOLINT
void* __real_realloc(void* memory, std::size_t size);                 // NOLINT
void* __real_aligned_alloc(std::size_t alignment, std::size_t size);  // NOLINT
void* __wrap_malloc(std::size_t size);                                // NOLINT
void* __wrap_calloc(std::size_t count, std::size_t size);             // NOLINT
void* __wrap_realloc(void* memory, std::size_t size);                 // NOLINT
void* __wrap_aligned_alloc(std::size_t alignment, std::size_t size);  // NOLINT
}

namespace {

std::atomic<std::size_t> allocations{0};

void* checked(void* memory) {
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

namespace orthant {

std::size_t AllocationCount::now() { return allocations; }

}  // namespace orthant

void* __wrap_malloc(std::size_t size) { return ++allocations, __real_malloc(size); }
void* __wrap_calloc(std::size_t count, std::size_t size) { return ++allocations, __real_calloc(count, size); }
void* __wrap_realloc(void* memory, std::size_t size) { return ++allocations, __real_realloc(memory, size); }
void* __wrap_aligned_alloc(std::size_t alignment, std::size_t size) {
  return ++allocations, __real_aligned_alloc(alignment, size);
}

void* operator new(std::size_t size) { return checked(__wrap_malloc(size > 0 ? size : 1)); }
void* operator new[](std::size_t size) { return operator new(size); }
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return __wrap_malloc(size > 0 ? size : 1); }
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept { return __wrap_malloc(size > 0 ? size : 1); }
void* operator new(std::size_t size, std::align_val_t align) {
  const auto alignment = static_cast<std::size_t>(align);
  return checked(__wrap_aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment));
}
void* operator new[](std::size_t size, std::align_val_t align) { return operator new(size, align); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
