#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace recollect::wnn {

// Bytes of 0 or 1 as bits, the first the lowest, with room behind for reads past the end.
void PackBits(std::span<const std::uint8_t> bytes, std::vector<std::uint8_t>& packed);

// How many neighbouring bits from any one on a single read takes in.
inline constexpr int kReach = 57;

// Kernel::turn in plain C++.
void PlainTurn(const std::uint8_t* packed, const std::int32_t* at, std::ptrdiff_t moved, int count,
               std::uint64_t* words);

}  // namespace recollect::wnn
