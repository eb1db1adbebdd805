#pragma once

namespace recollect::cnn {

// How activations are kept and multiplied, and weights where a network only answers. kBfloat16
// takes half of the memory and of the time; sums are 32-bit floats in both.
enum class Precision { kFloat32, kBfloat16 };

}  // namespace recollect::cnn
