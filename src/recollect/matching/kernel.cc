#include "recollect/matching/kernel.h"

#include <algorithm>
#include <cstddef>

#include "recollect/core/instructions.h"

namespace recollect::matching {
namespace {

void PlainProducts(const std::int8_t* descriptors, int rows, const std::int8_t* packed, int groups,
                   int* out) {
  constexpr int kSide = PackedDescriptors::kSide;
  for (int r = 0; r < rows; ++r, descriptors += kDescriptorBytes) {
    const std::int8_t* at = packed;
    for (int g = 0; g < groups; ++g, out += kSide) {
      std::fill_n(out, kSide, 0);
      for (int quad = 0; quad < kDescriptorBytes; quad += 4) {
        for (int j = 0; j < kSide; ++j, at += 4) {
          for (int b = 0; b < 4; ++b) out[j] += descriptors[quad + b] * at[b];
        }
      }
    }
  }
}

}  // namespace

PackedDescriptors::PackedDescriptors(const std::int8_t* descriptors, int count)
    : groups_((count + kSide - 1) / kSide),
      bytes_(static_cast<std::size_t>(groups_ * kSide * kDescriptorBytes), 0) {
  for (int i = 0; i < count; ++i) {
    const std::int8_t* from = descriptors + static_cast<std::ptrdiff_t>(i) * kDescriptorBytes;
    std::int8_t* to = bytes_.data() +
                      static_cast<std::ptrdiff_t>(i / kSide) * kSide * kDescriptorBytes +
                      i % kSide * 4;
    for (int quad = 0; quad < kDescriptorBytes; quad += 4) {
      std::copy_n(from + quad, 4, to + quad * kSide);
    }
  }
}

const Kernel kPlainKernel = {"plain", 1, PlainProducts};

std::span<const Kernel* const> Kernels() {
  static const std::vector<const Kernel*> kernels =
      Runnable<Kernel>({{Instructions::kAvx512Vnni, Avx512VnniKernel()},
                        {Instructions::kAvx2, Avx2Kernel()},
                        {Instructions::kPlain, &kPlainKernel}});
  return kernels;
}

}  // namespace recollect::matching
