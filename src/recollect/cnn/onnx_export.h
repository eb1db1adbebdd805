#pragma once

#include <filesystem>

#include "recollect/cnn/pose_network.h"

namespace recollect::cnn {

// The network as an ONNX file (operator set 11), checked by ONNX's own checker. Inputs `live` and
// `key` [1, 3, H, W], R, G, B in [0, 1], of the crop's size; output `delta` [1, 6], the rotation
// vector and the translation of the live camera in the key frame's (MotionFromDelta). Written
// beside its target and renamed into place.
//
// Throws Error for the compact network: the window around a correlation's peak and the least
// squares behind it are no layers that OpenCV's dnn could run.
void ExportOnnx(const PoseNetwork& network, const std::filesystem::path& file);

}  // namespace recollect::cnn
