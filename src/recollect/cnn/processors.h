#pragma once

// One body, compiled for several instruction sets; the loader takes the best the processor has.
#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__)
#define RECOLLECT_FOR_EACH_PROCESSOR \
  __attribute__((target_clones("avx512f", "arch=haswell", "default")))
#else
#define RECOLLECT_FOR_EACH_PROCESSOR
#endif
