#if defined(__x86_64__)
#pragma GCC target("avx2")
#include <immintrin.h>
#define RECOLLECT_LANES 8
#define RECOLLECT_KERNEL Avx2Packets
#define RECOLLECT_KERNEL_NAME "avx2"
#include "recollect/simulation/packet_kernel.h"
#else
#include "recollect/simulation/packet.h"

namespace recollect::simulation {
const PacketKernel* Avx2Packets() { return nullptr; }
}  // namespace recollect::simulation
#endif
