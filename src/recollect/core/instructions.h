#pragma once

#include <initializer_list>
#include <vector>

namespace recollect {

// Instruction sets that inner loops are written for. All that such a loop needs of the machine:
//   kAvx2           AVX2, POPCNT, BMI
//   kAvx512         AVX-512 F, BW, VL
//   kAvx512Popcount AVX-512 F, BW, VL, VPOPCNTDQ, VBMI, GFNI
//   kAvx512Vnni     AVX-512 F, BW, VL, VNNI
enum class Instructions { kPlain, kAvx2, kAvx512, kAvx512Popcount, kAvx512Vnni, kNeon };

// Whether this machine, and its operating system, runs them.
bool Runs(Instructions set);

// A table of inner loops for one instruction set; null where the compiler's target lacks that.
template <typename Kernel>
struct KernelFor {
  Instructions set;
  const Kernel* kernel;
};

// Those of the tables that this machine runs, in the order given: the fastest first.
template <typename Kernel>
std::vector<const Kernel*> Runnable(std::initializer_list<KernelFor<Kernel>> tables) {
  std::vector<const Kernel*> kernels;
  for (const KernelFor<Kernel>& table : tables) {
    if (table.kernel && Runs(table.set)) kernels.push_back(table.kernel);
  }
  return kernels;
}

}  // namespace recollect
