#include "recollect/core/huge_pages.h"

#include <sys/mman.h>

#include <cstdint>
#include <new>

namespace recollect {
namespace {

constexpr std::size_t kPage = 4096, kHugePage = 2 << 20;

std::size_t PageFor(std::size_t bytes) { return bytes >= 2 * kHugePage ? kHugePage : kPage; }

std::size_t RoundedUp(std::size_t bytes, std::size_t page) {
  return (bytes + page - 1) / page * page;
}

}  // namespace

// Straight from the system: what the heap hands out again lies in small pages already.
void* AllocatePages(std::size_t bytes) {
  const std::size_t page = PageFor(bytes), size = RoundedUp(bytes, page), mapped = size + page;
  void* start = mmap(nullptr, mapped, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (start == MAP_FAILED) throw std::bad_alloc();
  auto* first = static_cast<char*>(start);
  auto* memory = reinterpret_cast<char*>(RoundedUp(reinterpret_cast<std::uintptr_t>(start), page));
  if (memory > first) munmap(first, static_cast<std::size_t>(memory - first));
  const auto behind = static_cast<std::size_t>(first + mapped - (memory + size));
  if (behind > 0) munmap(memory + size, behind);
#ifdef MADV_HUGEPAGE
  if (page == kHugePage) madvise(memory, size, MADV_HUGEPAGE);  // a wish, which may not be heard
#endif
  return memory;
}

void FreePages(void* memory, std::size_t bytes) noexcept {
  if (memory != nullptr) munmap(memory, RoundedUp(bytes, PageFor(bytes)));
}

}  // namespace recollect
