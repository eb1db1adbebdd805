#include "recollect/cnn/threads.h"

#include <malloc.h>
#include <torch/torch.h>

#include <algorithm>
#include <thread>

// Of OpenBLAS, where that is the BLAS in use.
extern "C" void openblas_set_num_threads(int threads) __attribute__((weak));

namespace recollect::cnn {

void SetThreads(int threads) {
  mallopt(M_MMAP_THRESHOLD, 1 << 30);
  mallopt(M_TRIM_THRESHOLD, 0x7fffffff);
  mallopt(M_TOP_PAD, 1 << 26);
  // Torch's threads call it side by side; threads of its own would only fight with those.
  if (openblas_set_num_threads != nullptr) openblas_set_num_threads(1);
  const int cores = static_cast<int>(std::thread::hardware_concurrency());
  at::set_num_threads(threads > 0 ? threads : std::max(1, cores));
}

}  // namespace recollect::cnn
