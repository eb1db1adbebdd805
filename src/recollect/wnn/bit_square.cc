#include "recollect/wnn/bit_square.h"

#include <algorithm>
#include <cstring>

namespace recollect::wnn {
namespace {

// Compiled for machines with long and with short vectors.
#define RECOLLECT_VECTORS __attribute__((target_clones("avx512f", "avx2", "default")))

// Swaps the upper right and the lower left quarters of all squares of 2 kHalf bits.
template <std::size_t kHalf>
inline __attribute__((always_inline)) void SwapQuarters(std::uint64_t* words, std::uint64_t mask) {
  for (std::size_t begin = 0; begin < 64; begin += 2 * kHalf) {
    for (std::size_t i = begin; i < begin + kHalf; ++i) {
      const std::uint64_t swapped = (words[i] >> kHalf ^ words[i + kHalf]) & mask;
      words[i + kHalf] ^= swapped;
      words[i] ^= swapped << kHalf;
    }
  }
}

// Rows of 64 x 64 bits become columns.
RECOLLECT_VECTORS void Transpose(std::uint64_t* words) {
  SwapQuarters<32>(words, 0x00000000ffffffffULL);
  SwapQuarters<16>(words, 0x0000ffff0000ffffULL);
  SwapQuarters<8>(words, 0x00ff00ff00ff00ffULL);
  SwapQuarters<4>(words, 0x0f0f0f0f0f0f0f0fULL);
  SwapQuarters<2>(words, 0x3333333333333333ULL);
  SwapQuarters<1>(words, 0x5555555555555555ULL);
}

}  // namespace

void PackBits(std::span<const std::uint8_t> bytes, std::vector<std::uint8_t>& packed) {
  packed.assign(bytes.size() / 8 + 1 + sizeof(std::uint64_t), 0);
  std::size_t i = 0;
  for (; i + 8 <= bytes.size(); i += 8) {
    std::uint64_t eight;
    std::memcpy(&eight, &bytes[i], sizeof(eight));
    // Byte k carries its bit to bit 56 + k.
    packed[i / 8] = static_cast<std::uint8_t>(eight * 0x0102040810204080ULL >> 56);
  }
  for (; i < bytes.size(); ++i) {
    packed[i / 8] = static_cast<std::uint8_t>(packed[i / 8] | bytes[i] << i % 8);
  }
}

void PlainTurn(const std::uint8_t* packed, const std::int32_t* at, std::ptrdiff_t moved, int count,
               std::uint64_t* words) {
  std::uint64_t square[64];
  for (std::size_t r = 0; r < 64; ++r) {
    const auto bit = static_cast<std::size_t>(at[r] + moved);
    std::memcpy(&square[r], packed + bit / 8, sizeof(std::uint64_t));
    square[r] >>= bit % 8;
  }
  Transpose(square);
  std::copy_n(square, count, words);
}

}  // namespace recollect::wnn
