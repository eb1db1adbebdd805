#include "recollect/cnn/versions.h"

#include <torch/version.h>

namespace recollect::cnn {

std::string TorchVersion() { return TORCH_VERSION; }

}  // namespace recollect::cnn
