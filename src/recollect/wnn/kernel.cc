#include "recollect/wnn/kernel.h"

#include <vector>

namespace recollect::wnn {
namespace {

std::vector<const Kernel*> Supported() {
  std::vector<const Kernel*> kernels;
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vpopcntdq")) {
    kernels.push_back(Avx512Kernel());
  }
  if (__builtin_cpu_supports("avx2")) kernels.push_back(Avx2Kernel());
#elif defined(__aarch64__)
  kernels.push_back(NeonKernel());
#endif
  kernels.push_back(&kPlainKernel);
  return kernels;
}

}  // namespace

std::span<const Kernel* const> Kernels() {
  static const std::vector<const Kernel*> kernels = Supported();
  return kernels;
}

}  // namespace recollect::wnn
