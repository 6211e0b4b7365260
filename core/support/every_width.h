// core/support/every_width.h — loops that are compiled for each width of SIMD registers; the processor chooses.
#pragma once

// Where the linker resolves a function by the machine (GNU indirect functions), which sanitizers do not survive.
#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define ORTHANT_EVERY_WIDTH __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define ORTHANT_EVERY_WIDTH
#endif
