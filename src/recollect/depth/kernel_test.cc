// Every kernel against the plain one: the same numbers on random input and on all tails.
#include "recollect/depth/kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "recollect/core/random.h"

namespace recollect::stereo {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Words = std::vector<std::uint16_t>;

template <typename T>
std::vector<T> Numbers(std::size_t count, int below, Random& random) {
  std::vector<T> numbers(count);
  for (T& n : numbers) n = static_cast<T>(random.Index(below));
  return numbers;
}

struct Size {
  int width, disparities;
  std::size_t cells() const { return static_cast<std::size_t>(width * disparities); }
};
constexpr Size kSizes[] = {{5, 16},   {7, 32},  {33, 48}, {20, 64}, {64, 80},
                           {31, 128}, {9, 144}, {1, 16},  {40, 256}};

void ForAll(const std::function<void(const Kernel&, const Size&)>& check) {
  ASSERT_EQ(Kernels().back(), &kPlainKernel);
  for (const Kernel* kernel : Kernels()) {
    for (const Size& size : kSizes) {
      SCOPED_TRACE(std::string(kernel->name) + " " + std::to_string(size.width) + " x " +
                   std::to_string(size.disparities));
      check(*kernel, size);
    }
  }
}

TEST(StereoKernel, CostsOfPixelsAreThePlainOnes) {
  ForAll([](const Kernel& kernel, const Size& size) {
    Random random(1);
    std::array<Bytes, kPlanes> left, right;
    PlaneRows l{}, r{};
    for (std::size_t p = 0; p < kPlanes; ++p) {
      const int below = p < kCensus0 ? 2 * kGradientCap + 1 : 256;
      left[p] = Numbers<std::uint8_t>(static_cast<std::size_t>(size.width), below, random);
      right[p] = Numbers<std::uint8_t>(static_cast<std::size_t>(size.width + size.disparities),
                                       below, random);
      l[p] = left[p].data();
      r[p] = right[p].data();
    }
    Bytes expected(size.cells() + 1, 77), got(size.cells() + 1, 77);
    kPlainKernel.match(l, r, size.width, size.disparities, expected.data());
    kernel.match(l, r, size.width, size.disparities, got.data());
    EXPECT_EQ(got, expected);
  });
}

TEST(StereoKernel, SumsOfWindowsAreThePlainOnes) {
  ForAll([](const Kernel& kernel, const Size& size) {
    Random random(2);
    const Bytes enters = Numbers<std::uint8_t>(size.cells(), 205, random);
    const Bytes leaves = Numbers<std::uint8_t>(size.cells(), 205, random);
    Words expected = Numbers<std::uint16_t>(size.cells(), 800, random);
    for (std::uint16_t& sum : expected) sum = static_cast<std::uint16_t>(sum + 205);
    Words got = expected;
    const int count = static_cast<int>(size.cells());
    kPlainKernel.slide(enters.data(), leaves.data(), count, expected.data());
    kernel.slide(enters.data(), leaves.data(), count, got.data());
    EXPECT_EQ(got, expected);
    Words plain(size.cells() + 1, 7), fast(size.cells() + 1, 7);
    kPlainKernel.window(expected.data(), size.width, size.disparities, plain.data());
    kernel.window(expected.data(), size.width, size.disparities, fast.data());
    EXPECT_EQ(fast, plain);
  });
}

// All that a sweep of one row writes.
std::vector<Words> SweepOnce(const Kernel& kernel, const Size& size, int step, int greatest) {
  Random random(3);
  const auto stride = static_cast<std::size_t>(size.disparities + kSlotPad);
  const auto slots = static_cast<std::size_t>(size.width + 2) * stride + kSlotPad;
  const Words costs = Numbers<std::uint16_t>(size.cells(), greatest, random);
  std::vector<Words> out = {Words(size.cells() + 1, 9)};
  std::array<Words, kRowPaths> before, least;
  SweepRow row{
      size.width, size.disparities, step, 100, 1600, costs.data(), out[0].data(), {}, {}, {}, {},
      {}};
  for (int i = 0; i < 2 + 2 * kRowPaths; ++i) {
    Words words(i < 2        ? stride + kSlotPad
                : i % 2 == 0 ? slots
                             : static_cast<std::size_t>(size.width) + 2,
                0);
    if (i < 2 || i % 2 == 0) {
      for (std::size_t gap = 0; gap < words.size(); gap += stride) {
        std::fill_n(words.begin() + static_cast<std::ptrdiff_t>(gap), kSlotPad, 0xffff);
      }
    }
    out.push_back(words);
  }
  row.along = {out[1].data() + kSlotPad, out[2].data() + kSlotPad};
  for (std::size_t k = 0; k < kRowPaths; ++k) {
    before[k] = out[3];
    least[k].assign(static_cast<std::size_t>(size.width) + 2, 0);
    for (int x = 1; x <= size.width; ++x) {
      std::uint16_t lowest = 0xffff;
      for (int d = 0; d < size.disparities; ++d) {
        const auto value = static_cast<std::uint16_t>(random.Index(850 + 1600));
        before[k][static_cast<std::size_t>(x) * stride + kSlotPad + static_cast<std::size_t>(d)] =
            value;
        lowest = std::min(lowest, value);
      }
      least[k][static_cast<std::size_t>(x)] = lowest;
    }
    row.before[k] = before[k].data() + kSlotPad;
    row.before_least[k] = least[k].data();
    row.here[k] = out[3 + 2 * k].data() + kSlotPad;
    row.here_least[k] = out[4 + 2 * k].data();
  }
  kernel.sweep(row);
  return out;
}

TEST(StereoKernel, SweepsAreThePlainOnes) {
  ForAll([](const Kernel& kernel, const Size& size) {
    for (const int step : {1, -1}) {
      for (const int greatest : {2, 851}) {
        EXPECT_EQ(SweepOnce(kernel, size, step, greatest),
                  SweepOnce(kPlainKernel, size, step, greatest));
      }
    }
  });
}

TEST(StereoKernel, WinnersAreThePlainOnes) {
  ForAll([](const Kernel& kernel, const Size& size) {
    for (const int greatest : {3, 30000}) {  // with ties, without
      Random random(4);
      const Words first = Numbers<std::uint16_t>(size.cells(), greatest, random);
      const Words second = Numbers<std::uint16_t>(size.cells(), greatest, random);
      const auto run = [&](const Kernel& k) {
        std::vector<Words> out = {first, Words(static_cast<std::size_t>(size.width)),
                                  Words(static_cast<std::size_t>(size.width + size.disparities)),
                                  Words(static_cast<std::size_t>(size.width + size.disparities))};
        k.winners(out[0].data(), second.data(), size.width, size.disparities, out[1].data(),
                  out[2].data(), out[3].data());
        return out;
      };
      EXPECT_EQ(run(kernel), run(kPlainKernel));
    }
  });
}

}  // namespace
}  // namespace recollect::stereo
