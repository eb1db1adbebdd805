#pragma once

#include <torch/torch.h>

namespace recollect::cnn {

// A device that stands in for a graphics card where there is none. Its memory is the processor's,
// but at addresses that no processor can read, so whatever reaches for a tensor's values without
// asking where they are crashes; operations on it are the processor's, and throw where a tensor
// that is not a single number lies elsewhere.
torch::Device StandInDevice();

}  // namespace recollect::cnn
