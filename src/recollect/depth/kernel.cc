#include "recollect/depth/kernel.h"

#include <vector>

namespace recollect::stereo {
namespace {

std::vector<const Kernel*> Supported() {
  std::vector<const Kernel*> kernels;
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl")) {
    kernels.push_back(Avx512Kernel());
  }
  if (__builtin_cpu_supports("avx2")) kernels.push_back(Avx2Kernel());
#endif
  kernels.push_back(&kPlainKernel);
  return kernels;
}

}  // namespace

std::span<const Kernel* const> Kernels() {
  static const std::vector<const Kernel*> kernels = Supported();
  return kernels;
}

}  // namespace recollect::stereo
