#define RECOLLECT_LANES 4
#define RECOLLECT_KERNEL PlainPackets
#define RECOLLECT_KERNEL_NAME "plain"
#include "recollect/simulation/packet_kernel.h"
