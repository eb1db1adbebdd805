#include "recollect/matching/match.h"

#include <algorithm>
#include <cmath>

#include "recollect/matching/features.h"

// The compiler makes one variant an instruction set, and the loader chooses: before sanitizers are
// ready, which therefore watch the plain one.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__)
#define RECOLLECT_VARIANTS __attribute__((target_clones("arch=icelake-server", "avx2", "default")))
#else
#define RECOLLECT_VARIANTS
#endif

namespace recollect::matching {
namespace {

// products[j] = inner product of `one` with the j-th of `many`.
RECOLLECT_VARIANTS
void Products(const std::int8_t* one, const std::int8_t* many, int count, int* products) {
  for (int j = 0; j < count; ++j) {
    const std::int8_t* other = many + j * kDescriptorBytes;
    int sum = 0;
    for (int k = 0; k < kDescriptorBytes; ++k) sum += one[k] * other[k];
    products[j] = sum;
  }
}

std::vector<int> SquaredNorms(const std::int8_t* descriptors, int count) {
  std::vector<int> norms(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const std::int8_t* d = descriptors + i * kDescriptorBytes;
    norms[static_cast<std::size_t>(i)] = Likeness(d, d);
  }
  return norms;
}

}  // namespace

int Likeness(const std::int8_t* a, const std::int8_t* b) {
  int product = 0;
  Products(a, b, 1, &product);
  return product;
}

double Distance(int likeness, int norm2_a, int norm2_b) {
  return std::sqrt(std::max(0, norm2_a + norm2_b - 2 * likeness));
}

std::vector<Match> MatchDescriptors(const std::int8_t* live, int live_count,
                                    const std::int8_t* mapped, int mapped_count,
                                    const MatchOptions& options) {
  const auto mapped_size = static_cast<std::size_t>(mapped_count);
  const std::vector<int> live_norms = SquaredNorms(live, live_count);
  const std::vector<int> mapped_norms = SquaredNorms(mapped, mapped_count);
  // Squared distances: least over all live features, by mapped one, and whose it was.
  std::vector<int> products(mapped_size), nearest(mapped_size, 1 << 30), whose(mapped_size, -1);
  std::vector<Match> matches;
  for (int i = 0; i < live_count; ++i) {
    Products(live + i * kDescriptorBytes, mapped, mapped_count, products.data());
    int best = 1 << 30, second = 1 << 30, best_j = -1;
    for (int j = 0; j < mapped_count; ++j) {
      const auto at = static_cast<std::size_t>(j);
      const int d = live_norms[static_cast<std::size_t>(i)] + mapped_norms[at] - 2 * products[at];
      if (d < best) {
        second = best;
        best = d;
        best_j = j;
      } else if (d < second) {
        second = d;
      }
      if (d < nearest[at]) {
        nearest[at] = d;
        whose[at] = i;
      }
    }
    if (best_j < 0 || best >= options.ratio * options.ratio * second) continue;
    matches.push_back({i, best_j, products[static_cast<std::size_t>(best_j)]});
  }
  std::erase_if(
      matches, [&](const Match& m) { return whose[static_cast<std::size_t>(m.mapped)] != m.live; });
  return matches;
}

}  // namespace recollect::matching
