#pragma once

#include <torch/torch.h>

#include <string>

namespace recollect::cnn {

// The device that `name` means to libtorch ("cpu", "cuda", "cuda:1"). Empty: the graphics card
// whose turn it is among those of this machine, rank by rank; the processor where there is none.
// Throws Error where libtorch knows no such device or cannot use it.
torch::Device DeviceNamed(const std::string& name, int rank = 0);

}  // namespace recollect::cnn
