// A program of its own: it counts what is asked of the heap.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <vector>

#include "recollect/core/parallel.h"
#include "recollect/wnn/encoder.h"

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__)
namespace {
std::atomic<int> allocations = 0;
}

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
int posix_memalign(void** to, std::size_t alignment, std::size_t size) {
  ++allocations;
  *to = __libc_memalign(alignment, size);
  return *to ? 0 : 12;  // ENOMEM
}
}

namespace recollect::wnn {
namespace {

TEST(EncoderMemory, NothingIsAllocatedAfterTheFirstImage) {
  const std::vector<std::uint8_t> pixels(640 * 364 * 3, 100);
  ThreadPool pool(2);
  Encoder encoder({}, 640, 364, pool);
  std::vector<std::uint64_t> pattern(encoder.pattern_words());
  const ImageView image{pixels.data(), 640, 364, 3, 640 * 3};
  const int at_first = allocations;
  encoder.Encode(image, pattern);
  const int before = allocations;
  EXPECT_GT(before, at_first);  // of the first image: the counter counts
  for (int i = 0; i < 5; ++i) encoder.Encode(image, pattern);
  EXPECT_EQ(allocations, before);
}

}  // namespace
}  // namespace recollect::wnn
#endif
