#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "recollect/matching/features.h"

namespace recollect::matching {

// Descriptors in the order that the inner loops read them: sixteen side by side, four bytes of each
// at a time. The last sixteen are filled up with zeros.
class PackedDescriptors {
 public:
  static constexpr int kSide = 16;
  PackedDescriptors(const std::int8_t* descriptors, int count);
  const std::int8_t* data() const { return bytes_.data(); }
  int groups() const { return groups_; }
  int padded() const { return groups_ * kSide; }

 private:
  int groups_;
  std::vector<std::int8_t> bytes_;
};

// The inner loop for one instruction set. All give the same results. Bytes are 0 to 127.
struct Kernel {
  std::string_view name;
  int rows;  // descriptors that it takes at once, at most
  // out[r][j] = inner product of the r-th of `rows` descriptors, one after the other, with the j-th
  // of `groups` times 16 packed ones.
  void (*products)(const std::int8_t* descriptors, int rows, const std::int8_t* packed, int groups,
                   int* out);
};

// Each is null where the compiler's target lacks the instruction set.
extern const Kernel kPlainKernel;
const Kernel* Avx2Kernel();
const Kernel* Avx512VnniKernel();

// Those that this machine runs, the fastest first; the plain one is always among them.
std::span<const Kernel* const> Kernels();

}  // namespace recollect::matching
