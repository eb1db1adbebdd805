#include "recollect/core/instructions.h"

namespace recollect {

bool Runs(Instructions set) {
#if defined(__x86_64__)
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("popcnt") &&
                    __builtin_cpu_supports("bmi");
  const bool avx512 = avx2 && __builtin_cpu_supports("avx512f") &&
                      __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
  switch (set) {
    case Instructions::kPlain:
      return true;
    case Instructions::kAvx2:
      return avx2;
    case Instructions::kAvx512:
      return avx512;
    case Instructions::kAvx512Popcount:
      return avx512 && __builtin_cpu_supports("avx512vpopcntdq") &&
             __builtin_cpu_supports("avx512vbmi") && __builtin_cpu_supports("gfni");
    case Instructions::kAvx512Vnni:
      return avx512 && __builtin_cpu_supports("avx512vnni");
    case Instructions::kNeon:
      return false;
  }
  return false;
#elif defined(__aarch64__)
  return set == Instructions::kPlain || set == Instructions::kNeon;
#else
  return set == Instructions::kPlain;
#endif
}

}  // namespace recollect
