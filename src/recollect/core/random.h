#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

namespace recollect {

// Scrambles a 64-bit number (the finaliser of splitmix64). A counter run through it is a
// stateless random stream: the same on every thread, whatever the order of evaluation.
inline std::uint64_t Scramble(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

// Seed of the sub-stream `key` of `seed`; nest calls for streams of streams.
inline std::uint64_t SubSeed(std::uint64_t seed, std::uint64_t key) {
  return Scramble(Scramble(seed) ^ (key * 0xd1342543de82ef95ULL + 1));
}

// Seeded random numbers with the same values on every platform: the distributions of <random>
// may differ between standard libraries, so they are spelt out here.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(Scramble(seed)) {}

  std::uint64_t Bits() { return engine_(); }
  // Uniform in [0, 1).
  double Uniform() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }
  double Uniform(double low, double high) { return low + (high - low) * Uniform(); }
  // Uniform integer in [0, count); count > 0.
  std::int64_t Index(std::int64_t count) {
    return static_cast<std::int64_t>(Uniform() * static_cast<double>(count));
  }
  // Normal with mean 0 and standard deviation 1 (Box-Muller; the twin is thrown away so that the
  // stream holds no hidden state).
  double Normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - Uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * Uniform());
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace recollect
