#pragma once

#include <string>

#include "recollect/cnn/crop.h"

namespace recollect::cnn {

// kPaperA, kPaperB: the two released variants of the paper's network (78.7 M and 61.8 M
// parameters). kCompact: this project's own, 1 M parameters (compact_network.h).
enum class NetworkKind { kPaperA, kPaperB, kCompact };

// "a", "b", "compact", and back; throws Error on any other name.
std::string Name(NetworkKind kind);
NetworkKind NetworkKindFromName(const std::string& name);

// The crop that suits the network for images of this size.
Crop DefaultCrop(NetworkKind kind, int image_width, int image_height);

}  // namespace recollect::cnn
