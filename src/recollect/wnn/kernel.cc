#include "recollect/wnn/kernel.h"

#include <vector>

#include "recollect/core/instructions.h"

namespace recollect::wnn {

std::span<const Kernel* const> Kernels() {
  static const std::vector<const Kernel*> kernels =
      Runnable<Kernel>({{Instructions::kAvx512Popcount, Avx512Kernel()},
                        {Instructions::kAvx2, Avx2Kernel()},
                        {Instructions::kNeon, NeonKernel()},
                        {Instructions::kPlain, &kPlainKernel}});
  return kernels;
}

}  // namespace recollect::wnn
