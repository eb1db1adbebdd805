#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace recollect::wnn {

// 64 x 64 bits: bit c of word r is row r, column c.
using BitSquare = std::array<std::uint64_t, 64>;

// Rows become columns.
void Transpose(BitSquare& square);

// Bytes of 0 or 1 as bits, the first the lowest, with room behind for reads past the end.
void PackBits(std::span<const std::uint8_t> bytes, std::vector<std::uint8_t>& packed);

// How many neighbouring bits from any one on a single read takes in.
inline constexpr std::ptrdiff_t kReach = 57;

// Row r: at least kReach of the packed bits from number at[r] + moved on.
void ReadSquare(const std::uint8_t* packed, const std::int32_t* at, std::ptrdiff_t moved,
                BitSquare& square);

}  // namespace recollect::wnn
