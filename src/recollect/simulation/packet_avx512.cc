#if defined(__x86_64__)
#pragma GCC target("avx512f,avx512bw,avx512vl,prefer-vector-width=512")
#include <immintrin.h>
#define RECOLLECT_LANES 16
#define RECOLLECT_KERNEL Avx512Packets
#define RECOLLECT_KERNEL_NAME "avx512"
#include "recollect/simulation/packet_kernel.h"
#else
#include "recollect/simulation/packet.h"

namespace recollect::simulation {
const PacketKernel* Avx512Packets() { return nullptr; }
}  // namespace recollect::simulation
#endif
