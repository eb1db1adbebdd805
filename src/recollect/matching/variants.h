#pragma once

// Before a function: the compiler makes one variant of it an instruction set, and the loader
// chooses: before sanitizers are ready, which therefore watch the plain one.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__)
#define RECOLLECT_VARIANTS __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define RECOLLECT_VARIANTS
#endif
