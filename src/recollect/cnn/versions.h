#pragma once

#include <string>

namespace recollect::cnn {

// Of the libtorch that this was built with, as in "1.13.1".
std::string TorchVersion();

}  // namespace recollect::cnn
