#include "recollect/depth/kernel.h"

#include <vector>

#include "recollect/core/instructions.h"

namespace recollect::stereo {

std::span<const Kernel* const> Kernels() {
  static const std::vector<const Kernel*> kernels =
      Runnable<Kernel>({{Instructions::kAvx512, Avx512Kernel()},
                        {Instructions::kAvx2, Avx2Kernel()},
                        {Instructions::kPlain, &kPlainKernel}});
  return kernels;
}

}  // namespace recollect::stereo
