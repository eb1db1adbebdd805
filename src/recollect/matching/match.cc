#include "recollect/matching/match.h"

#include <algorithm>
#include <cmath>

#include "recollect/matching/features.h"
#include "recollect/matching/kernel.h"
#include "recollect/matching/variants.h"

namespace recollect::matching {
namespace {

constexpr int kFar = 1 << 29;  // beyond all squared distances; twice that is still a number

// Of squared distances of one live descriptor from mapped ones: the two least. `nearest` keeps each
// mapped one's least. `count` is a multiple of the sixteen lanes that the loop is cut into.
RECOLLECT_VARIANTS
void Scan(const int* products, const int* norms, int own, int count, int* distances, int* nearest,
          int& best, int& second) {
  constexpr int kLanes = PackedDescriptors::kSide;
  int bests[kLanes], seconds[kLanes];
  std::fill_n(bests, kLanes, kFar);
  std::fill_n(seconds, kLanes, kFar);
  for (int j = 0; j < count; j += kLanes) {
    for (int lane = 0; lane < kLanes; ++lane) {
      const int d = own + norms[j + lane] - 2 * products[j + lane];
      distances[j + lane] = d;
      nearest[j + lane] = std::min(nearest[j + lane], d);
      seconds[lane] = std::min(seconds[lane], std::max(bests[lane], d));
      bests[lane] = std::min(bests[lane], d);
    }
  }
  best = second = kFar;
  for (int lane = 0; lane < kLanes; ++lane) {
    second = std::min({second, std::max(best, bests[lane]), seconds[lane]});
    best = std::min(best, bests[lane]);
  }
}

// Padded to `size` with what is far from everything.
std::vector<int> SquaredNorms(const std::int8_t* descriptors, int count, int size) {
  std::vector<int> norms(static_cast<std::size_t>(size), kFar);
  for (int i = 0; i < count; ++i) {
    const std::int8_t* d = descriptors + i * kDescriptorBytes;
    norms[static_cast<std::size_t>(i)] = Likeness(d, d);
  }
  return norms;
}

}  // namespace

RECOLLECT_VARIANTS
void Likenesses(const std::int8_t* one, const std::int8_t* descriptors, std::span<const int> others,
                int* out) {
  for (const int other : others) {
    const std::int8_t* its = descriptors + static_cast<std::ptrdiff_t>(other) * kDescriptorBytes;
    int sum = 0;
    for (int k = 0; k < kDescriptorBytes; ++k) sum += one[k] * its[k];
    *out++ = sum;
  }
}

int Likeness(const std::int8_t* a, const std::int8_t* b) {
  int sum = 0;
  constexpr int kFirst[] = {0};
  Likenesses(a, b, kFirst, &sum);
  return sum;
}

double Distance(int likeness, int norm2_a, int norm2_b) {
  return std::sqrt(std::max(0, norm2_a + norm2_b - 2 * likeness));
}

std::vector<Match> MatchDescriptors(const std::int8_t* live, int live_count,
                                    const std::int8_t* mapped, int mapped_count,
                                    const MatchOptions& options) {
  if (mapped_count == 0) return {};
  const Kernel& kernel = *Kernels().front();
  const PackedDescriptors packed(mapped, mapped_count);
  const int padded = packed.padded();
  const auto size = static_cast<std::size_t>(padded);
  const std::vector<int> norms = SquaredNorms(mapped, mapped_count, padded);
  std::vector<int> products(size * static_cast<std::size_t>(kernel.rows)), distances(size),
      nearest(size, kFar);
  std::vector<Match> matches;
  std::vector<int> squared;  // distance of each match
  for (int first = 0; first < live_count; first += kernel.rows) {
    const int rows = std::min(kernel.rows, live_count - first);
    kernel.products(live + first * kDescriptorBytes, rows, packed.data(), packed.groups(),
                    products.data());
    for (int r = 0; r < rows; ++r) {
      const int* own_products = products.data() + r * padded;
      const std::int8_t* own = live + (first + r) * kDescriptorBytes;
      int best, second;
      Scan(own_products, norms.data(), Likeness(own, own), padded, distances.data(), nearest.data(),
           best, second);
      if (best >= options.ratio * options.ratio * second) continue;
      const auto at = std::find(distances.begin(), distances.end(), best) - distances.begin();
      matches.push_back({first + r, static_cast<int>(at), own_products[at]});
      squared.push_back(best);
    }
  }
  // Each other's most alike; of equals, the first.
  std::size_t kept = 0;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    int& least = nearest[static_cast<std::size_t>(matches[i].mapped)];
    if (squared[i] != least) continue;
    least = -1;
    matches[kept++] = matches[i];
  }
  matches.resize(kept);
  return matches;
}

}  // namespace recollect::matching
