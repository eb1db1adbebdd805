#include "recollect/simulation/packet.h"

#include <vector>

#include "recollect/core/instructions.h"

namespace recollect::simulation {

std::span<const PacketKernel* const> PacketKernels() {
  static const std::vector<const PacketKernel*> kernels =
      Runnable<PacketKernel>({{Instructions::kAvx512, Avx512Packets()},
                              {Instructions::kAvx2, Avx2Packets()},
                              {Instructions::kPlain, PlainPackets()}});
  return kernels;
}

}  // namespace recollect::simulation
