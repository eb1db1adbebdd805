#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

namespace recollect::stereo {

// What two pixels are compared by, a plane of bytes each: the capped horizontal gradient, the least
// and the greatest value it takes half a pixel to either side, and three bytes of census.
enum Plane { kGradient, kLeast, kGreatest, kCensus0, kCensus1, kCensus2, kPlanes };
inline constexpr int kGradientCap = 15;
// Costs of single pixels are in sixths, so that the census' weight of 1/6 is one: at most
// 6 * 2 * kGradientCap + 24 = 204, a byte.
inline constexpr int kSixths = 6;
// Costs are summed over windows of 5 x 5 pixels and come out as wholes: at most 850.
inline constexpr int kWindowRadius = 2;

// One row of each plane.
using PlaneRows = std::array<const std::uint8_t*, kPlanes>;

// Path costs of a pixel lie `disparities + kSlotPad` apart, behind a gap of kSlotPad values of
// 0xffff: no path comes from a disparity that is not there.
inline constexpr int kSlotPad = 16;

// Three of the four paths of a sweep come from the row before: from the pixel before, from the same
// and from the pixel after.
inline constexpr int kRowPaths = 3;

// A row of a sweep. Pixel x's slots and minima are at index x + 1; those at 0 and width + 1 stand
// for pixels outside and are all zero, so that paths begin at the border.
struct SweepRow {
  int width = 0, disparities = 0;
  int step = 1;  // 1: from left to right, after the row above; -1: the other way round
  std::uint16_t small_penalty = 0, large_penalty = 0;
  const std::uint16_t* costs = nullptr;  // [pixel][disparity]
  std::uint16_t* sums = nullptr;         // [pixel][disparity], the sum over the four paths
  std::array<const std::uint16_t*, kRowPaths> before{}, before_least{};
  std::array<std::uint16_t*, kRowPaths> here{}, here_least{};
  std::array<std::uint16_t*, 2> along{};  // slots of the fourth path; the first is all zero
};

// The inner loops for one instruction set. All of them give the same results. Disparities are a
// multiple of 16.
struct Kernel {
  std::string_view name;
  // costs[x][d] of left pixels x with right pixels x - d. The right rows are mirrored and go on
  // with their last value: right[i] is pixel max(0, width - 1 - i), width + disparities long.
  void (*match)(const PlaneRows& left, const PlaneRows& right, int width, int disparities,
                std::uint8_t* costs);
  // sums += enters - leaves
  void (*slide)(const std::uint8_t* enters, const std::uint8_t* leaves, int count,
                std::uint16_t* sums);
  // out[x][d] = the sum over pixels x - 2 ... x + 2 of sums, in wholes, rounded. Pixels outside are
  // those of the border.
  void (*window)(const std::uint16_t* sums, int width, int disparities, std::uint16_t* out);
  void (*sweep)(const SweepRow& row);
  // Adds the second sweep to `sums`; best[x]: the cheapest disparity of left pixel x, the least of
  // equals. right_best, right_cost: the same for right pixels, mirrored, width + disparities long.
  void (*winners)(std::uint16_t* sums, const std::uint16_t* second, int width, int disparities,
                  std::uint16_t* best, std::uint16_t* right_cost, std::uint16_t* right_best);
};

// Each is null where the compiler's target lacks the instruction set.
extern const Kernel kPlainKernel;
const Kernel* Avx2Kernel();
const Kernel* Avx512Kernel();

// Those that this machine runs, the fastest first; the plain one is always among them.
std::span<const Kernel* const> Kernels();

}  // namespace recollect::stereo
